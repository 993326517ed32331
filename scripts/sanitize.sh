#!/usr/bin/env bash
# Runs the program, the plug-in and the C API under tools that watch memory and threads.
#
#   scripts/sanitize.sh DIR [PART ...]     logs and builds go to DIR; without parts: all
#
#   malloc    PETSc's own bookkeeping, -malloc_debug -malloc_dump, in every example and in C programs
#   valgrind  C programs with the plug-in and the C API, on one rank and on several
#   address   AddressSanitizer and LeakSanitizer: the program on every example
#   thread    ThreadSanitizer: the program with several threads
#   miri      Miri: the unit tests that tests/sanitize/miri.txt names, which call no foreign function
#
# Suppressions are in tests/sanitize, of MPI's own alone. Exit code 0: nothing was found; 1: something was, the names of
# the logs are printed; 3: something is missing that could not be installed. It takes an hour.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 3
[ $# -ge 1 ] || { echo "sanitize: a directory was expected, as in scripts/sanitize.sh target/sanitize." >&2; exit 2; }
root=$PWD
mkdir -p "$1" || exit 3
out=$(cd "$1" && pwd)
shift
parts=("$@")
[ $# -gt 0 ] || parts=(malloc valgrind address thread miri)
logs=$out/logs
mkdir -p "$logs"
supp=$root/tests/sanitize
target=x86_64-unknown-linux-gnu
failed=0 ran=0

stop() { echo "sanitize: $*" >&2; exit 3; }

# Rust's nightly toolchain with the components that are named, for what the stable one does not have.
nightly() {
    command -v rustup > /dev/null \
        || stop "rustup is missing: the parts address, thread and miri need its nightly toolchain."
    if ! rustup run nightly rustc --version > /dev/null 2>&1; then
        rustup toolchain install nightly --profile minimal || stop "no nightly toolchain can be installed."
    fi
    for component; do
        rustup +nightly component list | grep -q "^$component.*(installed)" \
            || rustup +nightly component add "$component" \
            || stop "the component $component of nightly cannot be installed."
    done
}

# run NAME BAD COMMAND...: runs a command, and calls it bad if it fails or its output has the text BAD.
run() {
    local name=$1 bad=$2 log=$logs/${1//[ \/]/_}.log
    shift 2
    ran=$((ran + 1))
    if "$@" > "$log" 2>&1 < /dev/null && ! grep -Eq "$bad" "$log"; then
        echo "clean    $name"
        rm -f "$log"
    else
        echo "NOT CLEAN $name: $log"
        failed=$((failed + 1))
    fi
}

# The examples that have a solution, but the two largest.
scenes() {
    ls examples/scenes/*.toml examples/gallery/*.toml | grep -Ev 'arch_falls|speed_1024|contact_grid_100'
}

# Programs in C: source, options, ranks; a star before the source stands for the plug-in, which is loaded.
hosts() {
    cat << 'HOSTS'
tests/plugin/capi.c|-bar_fetifeti_ksp_rtol 1e-10|1 2
tests/plugin/capi.c|-bar_fetifeti_ksp_rtol 1e-10 -tied|3
tests/plugin/capi_matis.c|-fetifeti_ksp_rtol 1e-10|1 2
tests/plugin/capi_matis.c|-cycles 5 -m 3|2
examples/embedding/contact.c|-contact -m 9 -fetifeti_ksp_rtol 1e-10|1 2
examples/embedding/mortar.c|-fetifeti_ksp_rtol 1e-10|1 2
*tests/plugin/host.c|-ksp_type fetifeti|1 2
*tests/plugin/host.c|-do cycles -cycles 5 -n 6 -ksp_type fetifeti|1
*tests/plugin/ways.c|-do local -ksp_type fetifeti|1 2
*tests/plugin/again.c|-dim 3 -m 3 -times 2 -ksp_type fetifeti -fetifeti_bodies 2|1 2
HOSTS
}

# for_hosts NAME BAD WRAPPER...: runs each of them with the library, under a wrapper.
for_hosts() {
    local name=$1 bad=$2 library=${CARGO_TARGET_DIR:-target}/debug
    shift 2
    library=$(cd "$library" && pwd)
    local programs=$out/programs flags
    mkdir -p "$programs"
    flags=$(pkg-config --cflags --libs PETSc 2> /dev/null || pkg-config --cflags --libs petsc) \
        || stop "PETSc is missing."
    while IFS='|' read -r source options ranks; do
        local plugin=() file=${source#\*}
        local program
        program=$programs/$(basename "$file" .c)
        # shellcheck disable=SC2086
        mpicc -g -O1 -o "$program" "$file" -Iwrappers "$library/libfetifeti.so" -Wl,-rpath,"$library" $flags \
            -llapack -lblas -lm || stop "$file does not compile."
        [ "$file" = "$source" ] || plugin=(-dll_append "$library/libfetifeti.so")
        for n in $ranks; do
            # shellcheck disable=SC2086
            run "$name $(basename "$file") $options on $n" "$bad" \
                mpirun -n "$n" "$@" "$program" $options "${plugin[@]}" $more
        done
    done < <(hosts)
}

malloc() {
    local dump='^\[ *[0-9]+\] *[0-9]+ bytes|corrupt|ERROR'
    cargo build || exit 3
    local program=${CARGO_TARGET_DIR:-target}/debug/fetifeti
    for scene in $(scenes); do
        run "malloc $scene" "$dump" "$program" solve "$scene" --quiet -malloc_debug -malloc_dump
    done
    for scene in model_contact mortar_2d wall blocks_3d; do
        run "malloc $scene on 2" "$dump" \
            mpirun -n 2 "$program" solve "examples/scenes/$scene.toml" --quiet -malloc_debug -malloc_dump
    done
    more="-malloc_debug -malloc_dump" for_hosts malloc "$dump"
}

valgrind_() {
    command -v valgrind > /dev/null || stop "valgrind is missing: apt-get install valgrind."
    cargo build || exit 3
    local openmpi=/usr/share/openmpi/openmpi-valgrind.supp
    local watched=(valgrind -q --error-exitcode=9 --leak-check=full --show-leak-kinds=definite
        --errors-for-leak-kinds=definite --suppressions="$supp/valgrind.supp" --num-callers=30 --gen-suppressions=all)
    [ ! -f $openmpi ] || watched+=(--suppressions=$openmpi)
    # Of the processors that valgrind knows.
    export OPENBLAS_CORETYPE=Haswell
    local bad='^==[0-9]+== +(Invalid|Conditional|Use of|Syscall|Mismatched|[0-9,]+ bytes)'
    more="" for_hosts valgrind "$bad" "${watched[@]}"
    unset OPENBLAS_CORETYPE
}

address() {
    nightly
    local build=$out/address
    CARGO_TARGET_DIR=$build CARGO_PROFILE_DEV_DEBUG=line-tables-only RUSTFLAGS="-Zsanitizer=address" \
        CFLAGS="-fsanitize=address -fno-omit-frame-pointer -g1" cargo +nightly build --target $target || exit 3
    local program=$build/$target/debug/fetifeti
    export ASAN_OPTIONS=detect_leaks=1:detect_stack_use_after_return=1
    export LSAN_OPTIONS=suppressions=$supp/lsan.supp:print_suppressions=0
    for scene in $(scenes); do
        run "address $scene" 'Sanitizer' "$program" solve "$scene" --quiet -fetifeti_threads 2 -fetifeti_certify
    done
    for scene in model_contact mortar_2d wall blocks_3d; do
        run "address $scene on 2" 'Sanitizer' mpirun -n 2 "$program" solve "examples/scenes/$scene.toml" --quiet
    done
    unset ASAN_OPTIONS LSAN_OPTIONS
}

thread() {
    nightly rust-src
    local build=$out/thread
    CARGO_TARGET_DIR=$build CARGO_PROFILE_DEV_DEBUG=line-tables-only RUSTFLAGS="-Zsanitizer=thread" \
        cargo +nightly build -Zbuild-std --target $target || exit 3
    local program=$build/$target/debug/fetifeti
    export TSAN_OPTIONS=suppressions=$supp/tsan.supp:ignore_noninstrumented_modules=1
    for scene in poisson_2x2 model_contact mortar_2d wall blocks_3d cube_3d coefficients_channels spheres rings; do
        run "thread $scene" 'Sanitizer' \
            "$program" solve "examples/scenes/$scene.toml" --quiet -fetifeti_threads 4 -fetifeti_certify
    done
    unset TSAN_OPTIONS
}

# Runs of tests/sanitize/miri.txt. Miri knows no inline assembly. That of faer is for processors with AVX2: without them
# in the target it takes its loops in Rust.
miri() {
    nightly rust-src miri
    local name="" filters=() skipped=()
    while read -r word; do skipped+=(--skip "${word#-}"); done < <(grep '^-' "$supp/miri.txt")
    while read -r word _; do
        case $word in
            "" | \#* | -*) ;;
            \[*) miri_run "$name" "${filters[@]}" "${skipped[@]}"; name=${word//[\[\]]/} filters=() ;;
            *) filters+=("$word") ;;
        esac
    done < <(cat "$supp/miri.txt"; echo "[]")
}

# miri_run CRATE FILTER...: unit tests whose names have one of the filters.
miri_run() {
    [ -n "$1" ] || return 0
    # Miri would put noise on powi, exp and the like, where tests ask for their last bits.
    local flags="-Zmiri-disable-isolation -Zmiri-deterministic-floats"
    run "miri $1" 'Undefined Behavior|FAILED| 0 passed' \
        env CARGO_TARGET_DIR="$out/miri" MIRIFLAGS="$flags" RUSTFLAGS="-Ctarget-cpu=x86-64" \
        cargo +nightly miri test --package "$1" --lib -- "${@:2}"
}

for part in "${parts[@]}"; do
    case $part in
        malloc | address | thread | miri) "$part" ;;
        valgrind) valgrind_ ;;
        *) echo "sanitize: unknown part '$part', expected malloc, valgrind, address, thread or miri." >&2; exit 2 ;;
    esac
done
echo "sanitize: $ran runs, $failed not clean"
[ "$failed" -eq 0 ]
