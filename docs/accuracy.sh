#!/bin/sh
# The figures of docs/accuracy.md: `bounded` on all scenes and slopes, and what breaks first beyond.
# Usage: docs/accuracy.sh [DIRECTORY]; MENISCUS names the program, by default `meniscus`.
# Needs python3. Some ten minutes on two cores; errors do not depend on load.
set -eu
out=${1:-target/accuracy}
mkdir -p "$out"

sweep() { # NAME PIPELINES TRUTH SCENES SLOPES SIZE
    ${MENISCUS:-meniscus} ablate $2 --truth "$3" --size "$6" --rounds 1 \
        --sweep "scene=$4" --sweep "water.rms_slope=$5" --json "$out/$1.json" >"$out/$1.log"
    echo
    echo "### $1: $6, $3 truth"
    echo
    python3 "$(dirname "$0")/accuracy.py" "$out/$1.json"
}

scenes=pool,pool-128k,straddle,underwater,deep,clutter,grazing
sweep displaced refraction/bounded displaced "$scenes" 0,0.05,0.1,0.19 640x360
sweep flat refraction/bounded flat "${scenes%,grazing}" 0,0.05,0.1,0.19 640x360
sweep displaced-720 refraction/bounded displaced "$scenes" 0,0.05,0.1,0.19 1280x720
sweep flat-720 refraction/bounded flat pool,straddle,underwater,deep 0.1,0.19 1280x720
sweep steep refraction/bounded displaced pool,straddle,underwater 0.19,0.3,0.4,0.6 640x360
sweep all-traced steps/all-listed displaced clutter,grazing 0,0.05,0.1,0.19 640x360
sweep refined "refraction/paper refraction/refined" displaced pool 0.05,0.1,0.19 640x360

# What each step brings: errors, and times as multiples of combined's (these do depend on load).
${MENISCUS:-meniscus} ablate 'steps/*' refraction/combined refraction/refined refraction/bounded refraction/ray-traced \
    --scene pool --set water.rms_slope=0.1 --truth displaced --baseline refraction/combined \
    --json "$out/steps.json" >"$out/steps.log"
echo
echo "### steps: pool, slope 0.1, 640x360, displaced truth"
echo
python3 "$(dirname "$0")/accuracy.py" "$out/steps.json"
