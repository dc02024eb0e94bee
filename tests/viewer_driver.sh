# What tests that drive the viewer share: a display of its own, screenshots, waiting. Sourced with
# the arguments INKTRACE READ_CLIPBOARD X_CLIENT.
set -eu
inktrace=$1
read_clipboard=$2
x_client=$3
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
Xvfb -displayfd 3 -noreset -screen 0 1280x1000x24 +extension GLX -nolisten tcp \
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
# Takes the display away; the viewer must end with a message.
lose_display() {
    kill "$server"
    status=0
    wait "$viewer" || status=$?
    viewer=
    server=
    [ "$status" = 1 ] || fail "without its display it ended with status $status"
    grep -q 'display is gone' log || fail "no word about the lost display"
    [ "$(wc -l < log)" = 1 ] || fail "without its display it complains"
}
complains() {  # in red, in the bar below the picture, in a window of this height
    shot now.png
    [ "$(convert now.png -crop "500x28+0+$(($1 - 28))" -fuzz 20% -fill white +opaque '#b81414' \
        -fill black -opaque '#b81414' -format '%[fx:(1-mean)*w*h>20]' info:)" = 1 ]
}
# The command line in the clipboard, in the file "command".
copied() { xdotool key ctrl+c && "$read_clipboard" > command && [ -s command ]; }
