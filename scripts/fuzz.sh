#!/usr/bin/env bash
# Feeds the readers with bytes that libFuzzer makes up, one target of tests/fuzz after the other.
#
#   scripts/fuzz.sh SECONDS RUNS [TARGET...]
#
#   SECONDS    for each target; 0: no limit
#   RUNS       executions of each target; 0: no limit
#   TARGET     all of tests/fuzz/targets without one
#
# Seeds are tests/fuzz/corpus, the examples and the files of the tests; what a run adds goes to target/fuzz/corpus. The
# last lines are a table of executions. Exit code 1: an input was found, and its file is named; 3: something is missing.
set -euo pipefail
cd "$(dirname "$0")/.."

stop() {
    echo "fuzz: $*" >&2
    exit 3
}

[ $# -ge 2 ] || stop "expected seconds and runs for each target"
seconds=$1 runs=$2
shift 2
command -v rustup >/dev/null || stop "rustup is missing, which brings the nightly compiler: https://rustup.rs"
rustup run nightly rustc --version >/dev/null 2>&1 ||
    stop "the nightly compiler is missing: rustup toolchain install nightly --profile minimal"
command -v cargo-fuzz >/dev/null || cargo install cargo-fuzz --locked || stop "cargo install cargo-fuzz failed"

targets=("$@")
if [ $# -eq 0 ]; then
    for file in tests/fuzz/targets/*.rs; do targets+=("$(basename "$file" .rs)"); done
fi
here=$PWD/target/fuzz
mkdir -p "$here"
(cd tests/fuzz && cargo +nightly fuzz build --fuzz-dir . --sanitizer none --target-dir "$here/build") ||
    stop "the targets do not build"
program() { find "$here/build" -path "*/release/$1" -type f -perm -u+x | head -1; }

status=0 table=""
for target in "${targets[@]}"; do
    [ -f "tests/fuzz/targets/$target.rs" ] || stop "'$target' is no target, expected one of tests/fuzz/targets"
    own=$here/corpus/$target found=$here/found/$target
    mkdir -p "$own" "$found" "tests/fuzz/corpus/$target"
    seeds=("$own" "tests/fuzz/corpus/$target")
    case $target in
        scene) seeds+=(examples/scenes) ;;
        mesh) seeds+=(tests/fixtures/meshes) ;;
        deck) seeds+=(crates/deck/tests) ;;
    esac
    options=(-timeout=20 -rss_limit_mb=4096 -print_final_stats=1 -verbosity=0 "-artifact_prefix=$found/")
    [ "$seconds" -eq 0 ] || options+=("-max_total_time=$seconds")
    [ "$runs" -eq 0 ] || options+=("-runs=$runs")
    [ ! -f "tests/fuzz/$target.dict" ] || options+=("-dict=tests/fuzz/$target.dict")
    log=$here/$target.log
    said=clean
    "$(program "$target")" "${options[@]}" "${seeds[@]}" >"$log" 2>&1 || { said="see $log" status=1; }
    done=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    table+=$(printf '%-14s %12s executions   %s' "$target" "${done:-?}" "$said")$'\n'
done
printf '%s' "$table"
exit $status
