#!/usr/bin/env bash
# Solves examples twice on 1, 2 and 4 ranks with 1 and 2 threads, and says whether all results have the same bits:
# fields, multipliers, and the report but for its seconds, memory and command. Takes ten minutes; as root set what the
# Makefile exports for Open MPI.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-target/release/fetifeti}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The results in a directory, without what differs from run to run.
digest() {
    # Scenes without contact have no table of it.
    find "$1" -maxdepth 1 \( -name '*.vtu' -o -name '*.csv' \) -print0 | sort -z | xargs -0 sha256sum | cut -d ' ' -f 1
    python3 - "$1/report.json" <<'PYTHON'
import json, sys

def kept(x):
    if isinstance(x, dict):
        return {k: kept(v) for k, v in x.items() if "seconds" not in k and k not in ("memory_mb", "command")}
    return [kept(v) for v in x] if isinstance(x, list) else x

report = kept(json.load(open(sys.argv[1])))
# Asked for, and compared across numbers of them.
for key in ("threads", "options"):
    report.pop(key)
print(json.dumps(report))
PYTHON
}

status=0
for scene in scenes/{poisson_2x2,model_contact,mortar_2d,jump_1e6,coefficients_channels,blocks_3d,cube_3d,wall} \
    scenes/{spheres,sliding_punch} gallery/{pin_lug,bolted_flange,roller_bearing}; do
    for ranks in 1 2 4; do
        for run in "1 a" "1 b" "2 c" "2 d"; do
            read -r threads name <<< "$run"
            mpirun -n "$ranks" "$program" solve "examples/$scene.toml" --quiet --out "$scratch/$name" \
                -fetifeti_threads "$threads" > "$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }
            digest "$scratch/$name" > "$scratch/$name.digest"
        done
        said=same
        for name in b c d; do
            cmp -s "$scratch/a.digest" "$scratch/$name.digest" || { said=different; status=1; }
        done
        rm -rf "$scratch"/?
        echo "$scene, $ranks ranks: $said"
    done
done
exit "$status"
