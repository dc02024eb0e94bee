#!/bin/sh
# Drives the viewer as a user does, with real mouse and key events, on a display of its own.
# Usage: viewer_test.sh INKTRACE READ_CLIPBOARD X_CLIENT. Exit status 77: what it needs is not
# installed.
. "$(dirname "$0")/viewer_driver.sh"

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
echo nonsense > molecule.pdb
until_ "no word about a file that makes no sense" complains 700
rm molecule.pdb
until_ "the window does not come to rest" rests
shows_colors 500x600+0+0 50 || fail "the picture is gone with its file"
quit "closing"

start missing.pdb
until_ "no window" has_window missing.pdb
until_ "no word about a missing file" complains 960
quit "a missing file"

if DISPLAY= WAYLAND_DISPLAY= "$inktrace" view > out 2> log; then fail "a window without a display"; fi
grep -q 'no display' log || fail "no word about the missing display"
if "$inktrace" view --line-width thick > out 2> log; then fail "a wrong flag passes"; fi
grep -q 'line-width' log || fail "no word about the wrong flag"

# A display that dies takes the viewer along, with a message and no more.
start
until_ "no window" has_window Inktrace
lose_display
echo "passed"
