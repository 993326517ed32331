#!/usr/bin/env bash
# Tests the plug-in with the PETSc that scripts/newer_petsc.sh has built in a folder:
#   scripts/test_newer.sh FOLDER [32|64 [all]]
# The library is built with that PETSc, in FOLDER/build or FOLDER/build-64, and stays there; the tests are those that
# cargo has built with the usual one, as they start programs of their own. With `all` everything is built with that
# PETSc, and the tests of the solver run, too.
set -euo pipefail
cd "$(dirname "$0")/.."

bits=${2:-32}
folder=$(cd "$1" && pwd)
env=$folder/env build=$folder/build
[ "$bits" = 32 ] || env=$folder/env-$bits build=$folder/build-$bits
[ -e "$env" ] || { echo "$env is missing: scripts/newer_petsc.sh makes it."; exit 3; }

# Debian's dolfinx has PETSc 3.18; Fortran's module, petsc4py and MFEM are for 32-bit indices.
skip=(--skip dolfinx --skip random)
[ "$bits" = 32 ] || for name in fortran petsc4py python py_ a_load_loop scikit_fem mfem \
    mortar::constant mortar::examples mortar::mortars_are mortar::rows_with; do
    skip+=(--skip "$name")
done

if [ "${3:-}" = all ]; then
    # shellcheck source=/dev/null
    source "$env"
    export CARGO_TARGET_DIR=$build
    cargo build --package fetifeti # the tests of the plug-in load the library, which cargo does not make for them
    exec cargo test --workspace --no-fail-fast --lib --test operators --test embedding --test linear --test ranks \
        --test contact -- "${skip[@]}"
fi

tests=$(cargo test --test embedding --no-run --message-format json 2>/dev/null |
    sed -n 's/.*"name":"embedding".*"executable":"\([^"]*\)".*/\1/p' | tail -n 1)
[ -n "$tests" ] || { echo "cargo did not build the tests of the plug-in."; exit 1; }
# shellcheck source=/dev/null
source "$env"
echo "Building the library with ${PETSC_DIR##*/}, indices of $bits bits ..."
CARGO_TARGET_DIR=$build cargo build --package fetifeti
FETIFETI_TEST_LIBRARY=$build/debug/libfetifeti.so "$tests" "${skip[@]}" bodies:: capi_c:: ksp:: languages:: outer:: \
    partitions:: petsc_examples::
