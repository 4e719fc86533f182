#!/bin/sh
# Measures what docs/rivals.md tells: ours beside the other methods of the literature.
#
#     docs/rivals.sh [FOLDER]
#
# Writes JSON, Markdown and HTML into FOLDER (./rivals if none is given). MENISCUS names the program
# (meniscus), SIZE the pictures (1280x720), ROUNDS the frames of each pipeline (31). A sweep that was
# interrupted is gone on with. On two cores without a GPU 11 rounds take some ten minutes.
set -eu

meniscus=${MENISCUS:-meniscus}
size=${SIZE:-1280x720}
rounds=${ROUNDS:-31}
out=${1:-rivals}
mkdir -p "$out"

ours=refraction/broad,refraction/combined,refraction/refined,refraction/bounded,refraction/bounded-fine
rivals=refraction/screen-space,refraction/screen-space-hierarchical,refraction/broad-screen-space
rivals=$rivals,refraction/distance-field,refraction/ray-traced,refraction/offset,refraction/planar
names=$(printf '%s' "refraction/none,$ours,$rivals" | tr , ' ')

run() {
    name=$1
    shift
    echo "$name: meniscus $*"
    "$meniscus" "$@" --json "$out/$name.json" --markdown "$out/$name.md" --report "$out/$name.html" >"$out/$name.txt"
}

# The plane of time and error of each scene, ours against the rivals.
for scene in pool clutter underwater; do
    # shellcheck disable=SC2086 # Words are wanted.
    run "$scene" ablate $names --scene "$scene" --size "$size" --rounds "$rounds" \
        --ours "$ours" --against "$rivals" --wide
done

# The paper's experiment: triangles and waves.
run triangles ablate --preset liu2020 --size 640x360 --rounds "$rounds"

# The curve of time relative to none.
run curve ablate refraction/none refraction/combined refraction/screen-space refraction/ray-traced \
    --preset liu2020 --sweep pool.triangles=16k,64k,256k,1M --set water.rms_slope=0.05 \
    --size "$size" --rounds "$rounds"

# How the errors order on flat and on wavy water.
# shellcheck disable=SC2086
run slopes ablate $names --size 640x360 --rounds 3 --sweep scene=pool,clutter \
    --sweep water.rms_slope=0,0.05,0.1

# What a distance field shows with fewer voxels.
run voxels ablate refraction/combined refraction/distance-field --size 640x360 --rounds 3 --wide \
    --sweep trace.intersect.inside.field_voxels=32768,262144,2097152,16777216

# Marches with other strides, jitter and refinements.
run strides ablate refraction/screen-space --size "$size" --rounds 11 \
    --try narrow.intersect.stride=1,2,4,8 --try narrow.intersect.refinements=0,2 \
    --try narrow.intersect.jitter=0,0.5
