#!/usr/bin/env bash
# Solves random scenes and compares each with the direct solution (docs/reliability.md), from seed FIRST on.
#
#   scripts/soak.sh SECONDS [FIRST [COUNT [RANKS]]]
#
#   SECONDS    for all scenes together; 0: no limit
#   COUNT      scenes; 0: no limit
#   RANKS      1 without it
#
# The report is printed and stands in target/fuzz/soak.txt: a line for every scene that went wrong or whose solve did
# not converge and said so, and counts. A scene that crashes the program or takes two minutes went wrong; the run goes
# on behind it. `scripts/soak.sh --print SEED DIR` writes the scene of a seed into a directory. Exit code 1: a scene
# went wrong; 3: something is missing.
set -euo pipefail
cd "$(dirname "$0")/.."

stop() {
    echo "soak: $*" >&2
    exit 3
}

here=$PWD/target/fuzz
program=$here/soak/release/soak
mkdir -p "$here"
(cd tests/fuzz && CARGO_PROFILE_RELEASE_DEBUG=0 RUSTFLAGS="--cfg fuzzing -C target-cpu=x86-64-v3" \
    cargo build --release --features soak --bin soak --target-dir "$here/soak") || stop "the program does not build"
[ "${1:-}" != --print ] || exec "$program" "$@"
[ $# -ge 1 ] || stop "expected seconds"
seconds=$1 first=${2:-0} count=${3:-0} ranks=${4:-1}

files=$(mktemp -d -p "$([ -w /dev/shm ] && echo /dev/shm || echo "${TMPDIR:-/tmp}")" fetifeti-soak-XXXXXX)
trap 'rm -rf "$files"' EXIT
export SOAK_DIR=$files SOAK_SEED=$files/seed
report=$here/soak.txt parts=$files/parts
: >"$parts"
run=("$program")
[ "$ranks" -eq 1 ] || run=(mpirun -n "$ranks" "$program")
SECONDS=0 at=$first
while :; do
    left=$((seconds > 0 ? seconds - SECONDS : 0))
    rest=$((count > 0 ? count - (at - first) : 0))
    { [ "$seconds" -gt 0 ] && [ "$left" -le 0 ]; } || { [ "$count" -gt 0 ] && [ "$rest" -le 0 ]; } && break
    status=0
    "${run[@]}" "$at" "$left" "$rest" >>"$parts" 2>"$files/said" || status=$?
    [ "$status" -ne 0 ] || break
    seed=$(cat "$SOAK_SEED")
    what="ended with exit code $status"
    [ "$status" -ne 4 ] || what="took more than two minutes"
    echo "crashed $seed 0 $what: $(grep -v '^\[\|^-\|^$' "$files/said" | head -1)" >>"$parts"
    at=$((seed + 1))
done
{
    sed -n 's/^\(wrong\|crashed\) \([0-9]*\) [^ ]* /seed \2: /p' "$parts"
    sed -n 's/^not_converged \([0-9]*\) [^ ]* /not converged, seed \1: /p' "$parts"
    awk '{ all++; n[$1]++ }
        $1 == "right" && $4 + 0 > error { error = $4 + 0; at = $2 }
        $3 + 0 > slow { slow = $3 + 0; by = $2 }
        END {
            print "scenes", all + 0
            split("right refused no_solution undecided not_converged wrong crashed", kinds)
            for (k = 1; k <= 7; k++) print kinds[k], n[kinds[k]] + 0
            print "largest error", error + 0, "at seed", at
            print "slowest", slow + 0, "s at seed", by
        }' "$parts"
} | tee "$report"
! grep -q '^seed ' "$report"
