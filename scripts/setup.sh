#!/usr/bin/env bash
# Makes a Debian 12 machine ready to build and test fetifeti: finds what is missing, says so, installs it.
#
#   scripts/setup.sh          install what is missing for the program (as root, or through sudo without a password)
#   scripts/setup.sh --check  only say what is missing
#   scripts/setup.sh --tests  also what the tests need: compilers, other builds of PETSc, and for examples/clients
#                             dolfinx (350 MB) and SciPy
#
# Exit code 0: everything is there; 3: something is missing and could not be installed.
set -euo pipefail

MIN_RUST=85 # minor version of Rust 1.x, as in Cargo.toml's rust-version
CHECK_ONLY=false TESTS=false
for argument; do
    case $argument in
        --check) CHECK_ONLY=true ;;
        --tests) TESTS=true ;;
        *)
            echo "setup: unknown argument '$argument', expected --check, --tests or nothing." >&2
            exit 2
            ;;
    esac
done

say() { echo "setup: $*"; }
stop() {
    echo "setup: $*" >&2
    exit 3
}

# The packages that the build needs. A PETSc or SLEPc named by the user replaces Debian's.
packages=(build-essential ca-certificates pkg-config libopenmpi-dev openmpi-bin libclang-dev libopenblas0-serial)
[ -n "${PETSC_DIR:-}" ] || packages+=(petsc-dev)
[ -n "${SLEPC_DIR:-}${PETSC_DIR:-}" ] || packages+=(slepc-dev)
if $TESTS; then
    # PETSc's own examples, a Fortran compiler, petsc4py and CMake are for the tests of the plug-in.
    packages+=(gfortran cmake)
    [ -n "${PETSC_DIR:-}" ] || packages+=(libpetsc3.18-dev-examples python3-petsc4py-real)
    # pip, venv and pytest are for the Python package.
    packages+=(python3-pip python3-venv python3-setuptools python3-wheel python3-numpy python3-pytest)
    # A processor without AVX2, for a test.
    packages+=(qemu-user)
    # Builds of PETSc that the plug-in must refuse.
    packages+=(libpetsc-complex3.18-dev libpetsc64-real3.18-dev)
    # Clients.
    packages+=(python3-dolfinx python3-scipy)
fi

# Rust: rustup's is taken where there is one; a machine without any gets Debian's current toolchain. Debian 12's package
# "cargo" is Rust 1.63 and too old, its package "cargo-web" follows the current releases.
[ -d "$HOME/.cargo/bin" ] && PATH="$HOME/.cargo/bin:$PATH"
components=()
if command -v cargo >/dev/null && command -v rustc >/dev/null; then
    version=$(rustc --version 2>/dev/null | sed -n 's/^rustc \([0-9.]*\).*/\1/p' || true)
    IFS=. read -r major minor _ <<<"${version:-0.0.0}"
    if [ "$major" -lt 1 ] || { [ "$major" -eq 1 ] && [ "$minor" -lt $MIN_RUST ]; }; then
        stop "$(command -v rustc) is Rust ${version:-of an unknown version}, but 1.$MIN_RUST or newer is needed:" \
            "update it with 'rustup update stable', or remove Debian's packages cargo and rustc and run this again."
    fi
    command -v rustfmt >/dev/null || components+=(rustfmt)
    command -v cargo-clippy >/dev/null || components+=(clippy)
    if [ ${#components[@]} -gt 0 ] && ! command -v rustup >/dev/null; then
        [[ " ${components[*]} " != *" rustfmt "* ]] || packages+=(rustfmt-web)
        [[ " ${components[*]} " != *" clippy "* ]] || packages+=(rust-web-clippy)
        components=()
    fi
else
    packages+=(cargo-web rustc-web rustfmt-web rust-web-clippy)
fi

# Which of them are missing.
missing=()
if command -v dpkg-query >/dev/null; then
    installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null |
        sed -n 's/^installed //p' || true)
    for package in "${packages[@]}"; do
        grep -qxF -- "$package" <<<"$installed" || missing+=("$package")
    done
else
    # Not a Debian system: look for the tools and libraries themselves.
    for tool in cc make pkg-config mpicc mpirun cargo rustc; do
        command -v "$tool" >/dev/null || missing+=("$tool")
    done
    if command -v pkg-config >/dev/null; then
        pkg-config --exists PETSc || pkg-config --exists petsc || [ -n "${PETSC_DIR:-}" ] || missing+=(petsc-dev)
        pkg-config --exists SLEPc || pkg-config --exists slepc || [ -n "${SLEPC_DIR:-}${PETSC_DIR:-}" ] ||
            missing+=(slepc-dev)
    fi
fi

# How to become root, if at all.
as_root=none
if [ "$(id -u)" -eq 0 ]; then
    as_root=""
elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
    as_root="sudo -n"
fi

if [ ${#missing[@]} -gt 0 ]; then
    say "missing packages: ${missing[*]}"
    if $CHECK_ONLY; then
        exit 3
    elif ! command -v apt-get >/dev/null; then
        stop "there is no apt-get here; install these packages (named as in Debian 12) and run this again."
    elif [ "$as_root" = none ]; then
        stop "installing them needs root; run:" \
            "sudo apt-get update && sudo apt-get install --no-install-recommends ${missing[*]}"
    fi
    say "installing them with ${as_root:+$as_root }apt-get; this takes a few minutes on a fresh machine."
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q update ||
        stop "'apt-get update' failed; see its messages above."
    # --no-remove: never trade a package that somebody else uses for one of ours.
    $as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get -q -y --no-remove --no-install-recommends install "${missing[@]}" ||
        stop "apt-get could not install ${missing[*]}; see its messages above."
    say "installed: ${missing[*]}"
fi

if [ ${#components[@]} -gt 0 ]; then
    say "missing components of the Rust toolchain: ${components[*]}"
    $CHECK_ONLY && exit 3
    rustup component add "${components[@]}" || stop "rustup could not add ${components[*]}; see its messages above."
fi

# OpenBLAS is three times faster than the reference BLAS in MUMPS. Debian's alternatives prefer it by themselves; a
# choice that somebody made by hand is left alone.
if command -v update-alternatives >/dev/null; then
    for blas in /usr/lib/*-linux-gnu/libblas.so.3 /usr/lib/*-linux-gnu/liblapack.so.3; do
        [ -e "$blas" ] || continue
        case "$(readlink -f "$blas")" in
            */openblas*) ;;
            *) say "note: $blas is $(readlink -f "$blas"), not OpenBLAS; for full speed choose OpenBLAS with:" \
                "update-alternatives --config $(basename "$blas")-$(basename "$(dirname "$blas")")" ;;
        esac
    done
fi
