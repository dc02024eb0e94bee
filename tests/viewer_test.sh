#!/bin/sh
# Drives the viewer as a user does, with real mouse and key events, on a display of its own.
# Usage: viewer_test.sh INKTRACE READ_CLIPBOARD. Exit status 77: what it needs is not installed.
set -eu
inktrace=$1
read_clipboard=$2
for program in Xvfb xdotool convert compare import; do
    if ! command -v $program > /dev/null; then
        echo "skipped: $program is not installed (packages.txt)"
        exit 77
    fi
done
folder=$(mktemp -d)
server=
viewer=
finish() {
    [ -z "$viewer" ] || kill "$viewer" 2> /dev/null || true
    [ -z "$server" ] || kill "$server" 2> /dev/null || true
    rm -rf "$folder"
}
trap finish EXIT
fail() {
    echo "FAILED: $*"
    cat "$folder/log" 2> /dev/null || true
    [ -z "${INKTRACE_KEEP_SHOTS:-}" ] || cp "$folder"/*.png "$INKTRACE_KEEP_SHOTS"
    exit 1
}

# Xvfb picks a free display and tells its number.
Xvfb -displayfd 3 -screen 0 1280x1000x24 +extension GLX -nolisten tcp \
    3> "$folder/display" 2> /dev/null &
server=$!
tries=0
until [ -s "$folder/display" ]; do
    tries=$((tries + 1))
    [ $tries -lt 100 ] || fail "Xvfb does not start"
    sleep 0.1
done
export DISPLAY=":$(cat "$folder/display")"
export LIBGL_ALWAYS_SOFTWARE=1
cd "$folder"

cat > molecule.pdb <<'PDB'
ATOM      1  N   ALA A   7      -2.000   0.000   0.000  1.00 10.50           N
ATOM      2  CA  ALA A   7      -0.700   0.300   0.200  1.00 20.25           C
ATOM      3  C   ALA A   7       0.400  -0.500   0.400  1.00 12.00           C
ATOM      4  O   ALA A   7       1.600  -0.100   0.900  1.00 14.00           O
END
PDB

shot() { import -window root "$1"; }
# compare says 1.2e+06 where there are many.
pixels_apart() { printf '%.0f' "$(compare -metric AE "$1" "$2" null: 2>&1 || true)"; }
# Waits until the window shows one picture for some time.
settle() {
    shot before.png
    tries=0
    while :; do
        sleep 0.4
        shot after.png
        [ "$(pixels_apart before.png after.png)" != 0 ] || break
        mv after.png before.png
        tries=$((tries + 1))
        [ $tries -lt 100 ] || fail "the window does not come to rest"
    done
    mv after.png "$1"
}
wait_for_window() {
    tries=0
    until xdotool search --name "$1" > window 2> /dev/null && [ -s window ]; do
        tries=$((tries + 1))
        [ $tries -lt 300 ] || fail "no window '$1'"
        kill -0 "$viewer" 2> /dev/null || fail "the viewer has ended"
        sleep 0.1
    done
}
start() {
    "$inktrace" view "$@" > out 2> log &
    viewer=$!
}
# Asks the window to close; the viewer must end well.
quit() {
    xdotool key ctrl+q
    wait "$viewer" || fail "$1: ended with status $?"
    viewer=
    [ ! -s log ] || fail "$1: it complained"
}

start molecule.pdb
wait_for_window molecule.pdb
xdotool windowfocus "$(head -1 window)" 2> /dev/null || true
settle opened.png
[ "$(convert opened.png -crop 900x900+0+0 -unique-colors -format %w info:)" -gt 50 ] ||
    fail "the window shows no molecule"

xdotool mousemove 450 450 mousedown 1 mousemove 500 460 mousemove 560 480 mouseup 1
settle turned.png
[ "$(pixels_apart opened.png turned.png)" -gt 5000 ] || fail "a drag does not turn the molecule"
xdotool mousemove 300 450 click 4 click 4
settle zoomed.png
[ "$(pixels_apart turned.png zoomed.png)" -gt 5000 ] || fail "the wheel does not zoom"
xdotool key o key bracketright key shift+Left
settle keys.png
[ "$(pixels_apart zoomed.png keys.png)" -gt 5000 ] || fail "keys do not move the camera"
xdotool key question
settle help.png
[ "$(pixels_apart keys.png help.png)" -gt 5000 ] || fail "? does not show the keys"
xdotool key Escape
settle keys.png

# The command line in the clipboard draws what the window shows.
xdotool key ctrl+c
tries=0
until "$read_clipboard" > command && [ -s command ]; do
    tries=$((tries + 1))
    [ $tries -lt 50 ] || fail "the clipboard cannot be read"
    sleep 0.2
done
grep -q '^inktrace render molecule.pdb -o picture.png ' command || fail "copied: $(cat command)"
sh -c "$(sed "s|^inktrace|'$inktrace'|" command) --quiet" || fail "the command: $(cat command)"
size=$(convert picture.png -format %wx%h info:)
convert keys.png -crop "$size+0+0" +repage shown.png
[ "$(pixels_apart picture.png shown.png)" = 0 ] || fail "the command draws another picture"

# So does what the export dialog writes, whose name is there already.
xdotool key ctrl+e
settle dialog.png
mv picture.png commanded.png
xdotool key Return
tries=0
until [ -s picture.png ]; do
    tries=$((tries + 1))
    [ $tries -lt 100 ] || fail "the dialog writes nothing"
    sleep 0.1
done
cmp picture.png commanded.png || fail "the exported file is another one"

# Sizes that no picture has, a file that comes, goes and breaks.
xdotool windowsize "$(head -1 window)" 5 5
sleep 0.3
xdotool windowunmap "$(head -1 window)"
sleep 0.3
xdotool windowmap "$(head -1 window)"
xdotool windowsize "$(head -1 window)" 900 700
sleep 0.3
echo nonsense > molecule.pdb
sleep 0.5
rm molecule.pdb
settle gone.png
[ "$(convert gone.png -crop 500x600+0+0 -unique-colors -format %w info:)" -gt 50 ] ||
    fail "the picture is gone with its file"
quit "closing"

start missing.pdb
wait_for_window missing.pdb
sleep 0.5
quit "a missing file"

if DISPLAY= WAYLAND_DISPLAY= "$inktrace" view > out 2> log; then fail "a window without a display"; fi
grep -q 'no display' log || fail "no word about the missing display"
if "$inktrace" view --line-width thick > out 2> log; then fail "a wrong flag passes"; fi
grep -q 'line-width' log || fail "no word about the wrong flag"

# A display that dies takes the viewer along, with a message and no more.
start
wait_for_window Inktrace
kill "$server"
status=0
wait "$viewer" || status=$?
viewer=
server=
[ "$status" = 1 ] || fail "without its display it ended with status $status"
grep -q 'display is gone' log || fail "no word about the lost display"
echo "passed"
