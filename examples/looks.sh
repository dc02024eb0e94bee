#!/bin/sh
# Draws every look on seven data sets, for docs/images. Needs ImageMagick (convert, montage).
# looks.sh DATA OUT [PROGRAM]: DATA has the folders molecules, meshes and particles.
set -eu
data=$1
out=$2
program=${3:-build/release/bin/inktrace}
samples=$(dirname "$0")/../samples
mkdir -p "$out"

draw() { # NAME FILE FLAGS...: in every look
    name=$1
    file=$2
    shift 2
    for look in plain soft toon goodsell technical ink blueprint; do
        "$program" render "$file" --look $look --size 840x630 --legend none --quiet \
            -o "$out/$name-$look.png" "$@"
    done
}

draw 1-molecule "$samples/acetaminophen.xyz"
draw 2-protein "$data/molecules/4hhb.pdb" --color-by chain --select 'not water'
draw 3-ribosome "$data/molecules/1ffk_ribosome50S.cif.gz" --color-by chain --line-width 1.5px
draw 4-fandisk "$data/meshes/fandisk_ascii.ply" --material color=#c9b48a \
    --eye 2.95,1.95,-1.8 --look-at 0,-0.22,0 --up 0,1,0
draw 5-engine "$data/meshes/2CylinderEngine.glb"
draw 6-bar "$data/particles/mpm_karamelo_taylorbar3d_step1200.lammpstrj.gz" --color-by seq \
    --colormap coolwarm --view iso --line-width 1.5px
draw 7-grains "$data/particles/dem_pile10192.vtu" --color-by radius --colormap coolwarm \
    --eye 4.6,3.6,1.6 --look-at 5.38,5.38,-0.03 --up 0,0,1 --line-width 1.5px

montage "$out"/[1-7]-*.png -resize 512x384 -tile 7x7 -geometry 256x192+2+2 "$out/looks.png"
convert "$out/looks.png" -dither FloydSteinberg -colors 255 "PNG8:$out/looks.png"

for look in plain soft toon goodsell technical ink blueprint; do
    convert "$out/2-protein-$look.png" "$out/5-engine-$look.png" "$out/4-fandisk-$look.png" \
        -resize 320x240 +append -dither FloydSteinberg -colors 255 "PNG8:$out/look-$look.png"
done
