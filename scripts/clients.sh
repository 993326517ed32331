#!/usr/bin/env bash
# Installs a package of the Python registry that a program of examples/clients needs, in a fixed version, and prints
# where it is.
#
#   scripts/clients.sh skfem    scikit-fem and pymetis, 2 MB; prints a directory for PYTHONPATH
#   scripts/clients.sh mfem     MFEM for C++ out of PyMFEM's wheel: 100 MB to load, 380 MB unpacked, 100 of which
#                               stay; prints the directory with include and lib
#
# They lie in target/clients, or below CLIENTS_DIR. Exit code 3: they could not be installed.
set -euo pipefail
cd "$(dirname "$0")/.."

dir=${CLIENTS_DIR:-$PWD/target/clients}
case "${1:-}" in
    skfem) packages=(scikit-fem==12.0.2 pymetis==2025.2.2 typing_extensions==4.15.0) ;;
    mfem) packages=(mfem==4.10.0.1) ;;
    *)
        echo "clients: expected skfem or mfem, found '${1:-}'" >&2
        exit 3
        ;;
esac
place="$dir/$1-$(echo "${packages[*]}" | cksum | cut -d' ' -f1)"
if [ ! -d "$place" ]; then
    mkdir -p "$dir"
    new=$(mktemp -d "$dir/new.XXXXXX")
    trap 'rm -rf "$new"' EXIT
    # Wheels for Debian's Python, whatever python3 comes first in PATH.
    /usr/bin/python3 -m pip install --quiet --root-user-action=ignore --no-deps --only-binary=:all: \
        --target "$new/all" "${packages[@]}" >&2 || {
        echo "clients: pip could not install ${packages[*]}; see its messages above" >&2
        exit 3
    }
    case $1 in
        skfem) kept=$new/all ;;
        mfem) kept=$new/all/mfem/external/ser ;;
    esac
    mv -T "$kept" "$place" 2>/dev/null || [ -d "$place" ] # another run may have been faster
fi
[ "$1" != mfem ] || ls "$place/lib/libmfem.so" >/dev/null
echo "$place"
