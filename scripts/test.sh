#!/usr/bin/env bash
# Runs every test, two programs at a time. Tests that need PETSc inside their process take turns on the thread that owns
# it, so such a program keeps one core busy; meanwhile the other core has the programs that start processes.
#
#   scripts/test.sh
#
# Exit code 0: all passed.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 3

# What starts processes: `fetifeti`, mpirun, compilers of C and Fortran.
starts_processes=" cli comparison embedding ranks studies "
inside=() outside=()
for path in tests/*.rs tests/*/main.rs; do
    name=${path#tests/} name=${name%.rs} name=${name%/main}
    if [[ $starts_processes == *" $name "* ]]; then outside+=(--test "$name"); else inside+=(--test "$name"); fi
done

cargo test --workspace --no-fail-fast --no-run || exit 1

log=$(mktemp) || exit 3
trap 'kill $(jobs -p) 2>/dev/null; rm -f "$log"' EXIT
cargo test --no-fail-fast "${outside[@]}" >"$log" 2>&1 &
status=0
cargo test --workspace --no-fail-fast --lib --bins "${inside[@]}" || status=1
cargo test --workspace --no-fail-fast --doc || status=1
wait $! || status=1
cat "$log"
exit $status
