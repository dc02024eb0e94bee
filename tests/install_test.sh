#!/bin/sh
# What is installed works without the tree it came from: the program, its gallery's scenes, and the
# library for a project that finds it. Usage: install_test.sh CMAKE BUILD EXAMPLES
set -eu
cmake=$1
build=$2
examples=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

"$cmake" --install "$build" --prefix "$folder/prefix" --strip > install.log
# Moved, as a package is between where it is made and where it is used.
mv prefix moved
moved/bin/inktrace render moved/share/inktrace/scenes/figure1.json -o figure.png --size 64x64 --quiet
[ -s figure.png ]
moved/bin/inktrace bench --size 16x16 --json bench.json > /dev/null
grep -q "$folder/moved/share/inktrace/scenes" bench.json

cp -r "$examples" examples
"$cmake" -S examples -B built -DCMAKE_PREFIX_PATH="$folder/moved" > configure.log
"$cmake" --build built > build.log
built/draw_molecule moved/share/inktrace/samples/acetaminophen.xyz drawn.png
[ -s drawn.png ]

# What packages want: no path of the machine that built them, a manual and a licence.
for file in moved/bin/inktrace $(find moved -name libinktrace.so); do
    if grep -q "$(dirname "$examples")" "$file"; then
        echo "$file knows where it was built"
        exit 1
    fi
done
[ -s moved/share/man/man1/inktrace.1 ]
[ -s moved/share/doc/inktrace/LICENSE ]

file=$(find "$folder/moved" -name inktrace.pc)
asked=$(PKG_CONFIG_PATH=$(dirname "$file") pkg-config --cflags --libs inktrace)
# Flags are words: unquoted on purpose.
c++ -std=c++20 examples/draw_molecule.cpp -o asked $asked -Wl,-rpath,"$(dirname "$file")/.."
./asked moved/share/inktrace/samples/acetaminophen.xyz asked.png
cmp drawn.png asked.png
echo "passed"
