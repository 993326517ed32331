#!/usr/bin/env bash
# Builds and lints everything, builds the documentation and runs every test, with both cores in use. The programs that
# start processes run in the background. Beside them run the tests with PETSc in their own process, which take turns on
# the one thread that owns it.
#
#   scripts/test.sh
#
# Exit code 0: nothing was found, and all tests passed.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 3

# In the background: `fetifeti`, mpirun, compilers of C and Fortran. Studies and comparisons start processes, too, but
# stand with the others, so that both sides take about as long.
outside=(--test cli --test embedding --test ranks)
inside=(--lib)
for path in tests/*.rs tests/*/main.rs; do
    name=${path#tests/} name=${name%.rs} name=${name%/main}
    [[ " ${outside[*]} " == *" $name "* ]] || inside+=(--test "$name")
done

scratch=$(mktemp -d) && log=$scratch/log || exit 3
trap 'kill $(jobs -p) 2>/dev/null; rm -rf "$scratch"' EXIT

# Clippy stands in for the compiler of our own crates: the build finds what a pass of clippy alone would, which would
# read all sources and all dependencies once more. Any lint ends the build. The variable with clippy's arguments is no
# documented one: a line with a lint shows that they arrive.
export RUSTC_WORKSPACE_WRAPPER=clippy-driver
export CLIPPY_ARGS=-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__
linted() { clippy-driver --crate-type lib --emit metadata --out-dir "$scratch" - <<<"pub fn one() -> i32 { $1 }"; }
if ! linted 1 || linted "return 1;" 2>"$log" || ! grep -q needless_return "$log"; then
    echo "test: clippy-driver does not stand in for rustc; expected a lint of 'return 1;' and none of '1'." >&2
    cat "$log" >&2
    exit 1
fi

# Tests with many cases take a sample of them, which begins at this number (tests/support/sample.rs).
if [ -z "${FETIFETI_TEST_OFFSET:-}" ]; then
    commit=$(git rev-parse --short=7 HEAD 2>/dev/null) || commit=0
    export FETIFETI_TEST_OFFSET=$((16#$commit))
fi
echo "test: samples of cases follow from FETIFETI_TEST_OFFSET=$FETIFETI_TEST_OFFSET"

# Half of the packages are for tests alone: they are loaded while the first crates are built, which leave a core idle.
scripts/setup.sh --tests >"$log" 2>&1 &
cargo test --workspace --no-fail-fast --no-run
built=$?
wait $!
installed=$?
cat "$log"
[ "$built" -eq 0 ] && [ "$installed" -eq 0 ] || exit 1

cargo test --workspace --no-fail-fast "${outside[@]}" >"$log" 2>&1 &
status=0
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps || status=1
cargo test --workspace --no-fail-fast "${inside[@]}" || status=1
cargo test --workspace --no-fail-fast --doc || status=1
wait $! || status=1
cat "$log"

# The plug-in with a newer PETSc, where somebody has built one: `make test-newer`, or scripts/newer_petsc.sh DIR.
newer=${FETIFETI_NEWER:-$HOME/.cache/fetifeti/newer}
for bits in 32 64; do
    env=$newer/env
    [ $bits = 32 ] || env=$newer/env-$bits
    if [ -e "$env" ]; then
        scripts/test_newer.sh "$newer" $bits || status=1
    else
        echo "test: no newer PETSc with indices of $bits bits, $env is missing"
    fi
done
exit $status
