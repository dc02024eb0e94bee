#!/bin/sh
# What befalls the viewer: files dropped on it, trajectories, dense screens, and an end in the middle
# of work. Usage: viewer_trouble_test.sh INKTRACE READ_CLIPBOARD X_CLIENT. Exit status 77: what it
# needs is not installed.
. "$(dirname "$0")/viewer_driver.sh"

opened() {  # NAME: its window is there, and shows something
    until_ "no window of $1" has_window "$1"
    xdotool windowfocus "$(head -1 window)" 2> /dev/null || true
    until_ "the window shows nothing of $1" shows_colors 900x900+0+0 50
    until_ "the window does not come to rest" rests
}
takes() {  # a key: the picture changes
    shot before_key.png
    xdotool key "$1"
    changed before_key.png after_key.png "$1 changes nothing"
}
commands() { copied && grep -q -e "$1" command; }
commands_no() { copied && ! grep -q -e "$1" command; }

# Files dropped on the window take the place of what is there; nonsense is refused in words.
cat > run.xyz <<'XYZ'
3
one
C 0 0 0
O 0 1.2 0
N 1.1 0 0
3
two
C 0 0 0
O 0 1.7 0
N 1.6 0 0
3
three
C 0 0 0
O 0 2.2 0
N 2.1 0 0
XYZ
echo nonsense > broken.pdb
start
until_ "no window" has_window Inktrace
id=$(head -1 window)
"$x_client" drop "$id" molecule.pdb || fail "the window takes no files"
opened molecule.pdb
"$x_client" drop "$id" molecule.pdb run.xyz || fail "the window takes no two files"
opened "molecule.pdb and others"
"$x_client" drop "$id" broken.pdb || fail "the window takes no broken file"
until_ "no word about a broken file" complains 960
"$x_client" drop "$id" run.xyz || fail "the window takes no more files"
opened run.xyz

# Standard views, and frames: stepped, scrubbed, played.
for key in 1 2 3 4 5 6 7 0; do
    takes $key
done
takes period
until_ "a step goes nowhere" commands '--frame=1'
takes comma
until_ "a step back goes nowhere" commands_no '--frame'
shot before.png
# As a hand does it: not all within one picture of a busy program.
xdotool mousemove 150 918 sleep 0.2 mousedown 1 sleep 0.2 mousemove 400 918 sleep 0.2 \
    mousemove 640 918 sleep 0.2 mouseup 1
changed before.png after.png "the slider does not scrub"
until_ "the slider goes elsewhere" commands '--frame=2'
xdotool key space
until_ "it does not play" differs after.png
xdotool key space
until_ "it does not stop" rests

# Another file by the dialog, and all of it in view again.
choose() {
    shot before_dialog.png
    xdotool key ctrl+o
    changed before_dialog.png dialog.png "Ctrl+O shows no dialog"
    xdotool type --delay 30 "$1"
    xdotool key Return
    opened "$1"
}
choose molecule.pdb
xdotool mousemove 300 450 click 4 click 4
takes f
choose run.xyz

# A file that is replaced, and one that goes, while it is drawn.
cp molecule.pdb other && mv other run.xyz
until_ "no word about another kind of file" complains 960
rm run.xyz
xdotool mousemove 300 300 mousedown 1 mousemove 350 330 mousemove 400 350 mouseup 1
until_ "the window does not come to rest" rests
quit "after all that"

# Closing, shrinking and hiding the window in the middle of work.
slow="--method stencil --aa multisample:64 --quality 5"
for end in key button; do
    start molecule.pdb $slow
    until_ "no window" has_window molecule.pdb
    id=$(head -1 window)
    until_ "the window shows nothing" shows_colors 900x900+0+0 20
    xdotool windowsize "$id" 3 3
    xdotool windowunmap "$id"
    xdotool windowmap "$id"
    xdotool windowsize "$id" 800 600
    xdotool mousemove 300 300 mousedown 1 mousemove 350 330 mouseup 1
    if [ $end = button ]; then
        "$x_client" close "$id"
    else
        xdotool windowfocus "$id" 2> /dev/null || true
        until_ "the window stays small" has_size 800 600
        xdotool key ctrl+q
    fi
    status=0
    wait "$viewer" || status=$?
    viewer=
    [ "$status" = 0 ] || fail "closed in the middle of work, it ended with status $status"
    [ ! -s log ] || fail "closed in the middle of work, it complained"
done

# On a dense screen texts and buttons grow, and the picture has the pixels that they leave.
"$x_client" dpi 192
start molecule.pdb
opened molecule.pdb
until_ "the clipboard cannot be read" copied
id=$(head -1 window)
eval "$(xdotool getwindowgeometry --shell "$id")"
width=$(sed 's/.*--size=\([0-9]*\)x.*/\1/' command)
[ $((WIDTH - width)) -gt 600 ] || fail "the panel has $((WIDTH - width)) pixels on a dense screen"
quit "a dense screen"
"$x_client" dpi 96

# A display that dies in the middle of work.
start molecule.pdb $slow
until_ "no window" has_window molecule.pdb
until_ "the window shows nothing" shows_colors 900x900+0+0 20
lose_display
echo "passed"
