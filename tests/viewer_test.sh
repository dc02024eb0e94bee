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

# Waits until a condition holds, as long as a slow machine may need: until_ MESSAGE COMMAND...
until_() {
    message=$1
    shift
    tries=0
    until "$@"; do
        tries=$((tries + 1))
        [ $tries -lt 600 ] || fail "$message"
        if [ -n "$viewer" ] && ! kill -0 "$viewer" 2> /dev/null; then fail "$message: it has ended"; fi
        sleep 0.1
    done
}

# Xvfb picks a free display and tells its number.
Xvfb -displayfd 3 -screen 0 1280x1000x24 +extension GLX -nolisten tcp \
    3> "$folder/display" 2> /dev/null &
server=$!
until_ "Xvfb does not start" [ -s "$folder/display" ]
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
colors() { convert "$1" -crop "$2" -unique-colors -format %w info:; }

shows_colors() {  # in a part of the window
    shot now.png
    [ "$(colors now.png "$1")" -gt "$2" ]
}
differs() {  # from an earlier shot
    shot now.png
    [ "$(pixels_apart "$1" now.png)" -gt 5000 ]
}
rests() {  # for half a second
    shot before.png
    sleep 0.5
    shot now.png
    [ "$(pixels_apart before.png now.png)" = 0 ]
}
# What comes of the last events: waits until the window differs from a shot, and rests.
changed() {  # BEFORE AFTER MESSAGE
    until_ "$3" differs "$1"
    until_ "the window does not come to rest" rests
    mv now.png "$2"
}
has_window() { xdotool search --name "$1" > window 2> /dev/null && [ -s window ]; }
has_size() { [ "$(xdotool getwindowgeometry --shell "$(head -1 window)" | grep -c -e "WIDTH=$1\$" -e "HEIGHT=$2\$")" = 2 ]; }
is_visible() { xdotool search --onlyvisible --name molecule.pdb > /dev/null 2>&1; }
is_hidden() { ! is_visible; }
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
until_ "no window" has_window molecule.pdb
xdotool windowfocus "$(head -1 window)" 2> /dev/null || true
until_ "the window shows no molecule" shows_colors 900x900+0+0 50
until_ "the window does not come to rest" rests
mv now.png opened.png

xdotool mousemove 450 450 mousedown 1 mousemove 500 460 mousemove 560 480 mouseup 1
changed opened.png turned.png "a drag does not turn the molecule"
xdotool mousemove 300 450 click 4 click 4
changed turned.png zoomed.png "the wheel does not zoom"
xdotool key o key bracketright key shift+Left
changed zoomed.png keys.png "keys do not move the camera"
xdotool key question
changed keys.png help.png "? does not show the keys"
xdotool key Escape
changed help.png keys.png "Esc does not close the help"

# The command line in the clipboard draws what the window shows.
copied() { xdotool key ctrl+c && "$read_clipboard" > command && [ -s command ]; }
until_ "the clipboard cannot be read" copied
grep -q '^inktrace render molecule.pdb -o picture.png ' command || fail "copied: $(cat command)"
sh -c "$(sed "s|^inktrace|'$inktrace'|" command) --quiet" || fail "the command: $(cat command)"
size=$(convert picture.png -format %wx%h info:)
shows_picture() {
    shot now.png
    convert now.png -crop "$size+0+0" +repage shown.png
    [ "$(pixels_apart picture.png shown.png)" = 0 ]
}
until_ "the command draws another picture" shows_picture
cp picture.png "$folder/commanded.png"

# So does what the export dialog writes, whose name is there already.
shot keys.png
rm picture.png
xdotool key ctrl+e
changed keys.png dialog.png "Ctrl+E shows no dialog"
xdotool key Return
until_ "the dialog writes nothing" [ -s picture.png ]
cmp picture.png commanded.png || fail "the exported file is another one"
# It may still have been closing; the next events are for the window.
until_ "the dialog stays" shows_picture

# A click tells what is under the pointer.
shot keys.png
xdotool mousemove 450 450 click 1
changed keys.png picked.png "a click picks nothing"

# Sizes that no picture has, a file that comes, goes and breaks.
id=$(head -1 window)
xdotool windowsize "$id" 5 5
until_ "the window does not shrink" has_size 5 5
xdotool windowunmap "$id"
until_ "the window stays" is_hidden
xdotool windowmap "$id"
until_ "the window does not come back" is_visible
xdotool windowsize "$id" 900 700
until_ "the window does not grow" has_size 900 700
until_ "the picture does not come back" shows_colors 500x600+0+0 50
until_ "the window does not come to rest" rests
says() {  # in the bar below the picture, in red
    shot now.png
    [ "$(convert now.png -crop 500x28+0+672 -fuzz 20% -fill white +opaque '#b81414' \
        -fill black -opaque '#b81414' -format '%[fx:(1-mean)*w*h>20]' info:)" = 1 ]
}
echo nonsense > molecule.pdb
until_ "no word about a file that makes no sense" says
rm molecule.pdb
until_ "the window does not come to rest" rests
shows_colors 500x600+0+0 50 || fail "the picture is gone with its file"
quit "closing"

start missing.pdb
until_ "no window" has_window missing.pdb
missing() {
    shot now.png
    [ "$(convert now.png -crop 900x28+0+932 -fuzz 20% -fill white +opaque '#b81414' \
        -fill black -opaque '#b81414' -format '%[fx:(1-mean)*w*h>20]' info:)" = 1 ]
}
until_ "no word about a missing file" missing
quit "a missing file"

if DISPLAY= WAYLAND_DISPLAY= "$inktrace" view > out 2> log; then fail "a window without a display"; fi
grep -q 'no display' log || fail "no word about the missing display"
if "$inktrace" view --line-width thick > out 2> log; then fail "a wrong flag passes"; fi
grep -q 'line-width' log || fail "no word about the wrong flag"

# A display that dies takes the viewer along, with a message and no more.
start
until_ "no window" has_window Inktrace
kill "$server"
status=0
wait "$viewer" || status=$?
viewer=
server=
[ "$status" = 1 ] || fail "without its display it ended with status $status"
grep -q 'display is gone' log || fail "no word about the lost display"
echo "passed"
