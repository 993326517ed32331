#!/usr/bin/env bash
# Installs what cargo has built: program, libraries, headers, Fortran module, files for pkg-config and CMake, manual
# pages, completions, documents and examples. Everything is put together first and copied at the end.
#
#   scripts/install.sh BUILT PREFIX [DESTDIR]
#
#   BUILT      the directory with the program, libfetifeti.so and libfetifeti_step.so (target/release)
#   PREFIX     where the files will be used (/usr/local); LIBDIR in the environment replaces PREFIX/lib
#   DESTDIR    put in front of all paths, for packagers
#
# share/fetifeti/installed lists the files for `make uninstall`. Exit code 3: something is missing or cannot be written.
set -euo pipefail
cd "$(dirname "$0")/.."

stop() {
    echo "install: $*" >&2
    exit 3
}

[ $# -ge 2 ] || stop "expected the directory of the built files and a prefix"
built=$1 prefix=${2%/} destdir=${3:-}
case $prefix in
    /*) ;;
    *) stop "PREFIX is '$prefix', expected an absolute path" ;;
esac
libdir=${LIBDIR:-$prefix/lib}
case $libdir in
    "$prefix"/*) lib=${libdir#"$prefix"/} ;;
    *) stop "LIBDIR is '$libdir', expected a directory below the prefix '$prefix'" ;;
esac
for file in fetifeti libfetifeti.so libfetifeti_step.so; do
    [ -f "$built/$file" ] || stop "$built/$file is missing: run 'make build' first"
done

version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
# The libraries' names for the loader end with the version of its interface (build.rs).
abi=$(sed -n 's/^pub const ABI: u32 = \([0-9]*\);/\1/p' packaging/abi.rs)
petsc=""
for name in PETSc petsc; do
    pkg-config --exists "$name" 2>/dev/null && petsc=$name && break
done
[ -n "$petsc" ] || stop "pkg-config does not know PETSc"

stage=$(mktemp -d) || stop "no temporary directory"
trap 'rm -rf "$stage"' EXIT
root=$stage$prefix
put() { install -D -m "$1" "$2" "$root/$3"; }
# A file of packaging/ with its names filled in.
fill() {
    mkdir -p "$(dirname "$root/$2")"
    sed -e "s|@PREFIX@|$prefix|g" -e "s|@LIB@|$lib|g" -e "s|@VERSION@|$version|g" -e "s|@ABI@|$abi|g" \
        -e "s|@PETSC@|$petsc|g" "packaging/$1" >"$root/$2"
    chmod 644 "$root/$2"
}

put 755 "$built/fetifeti" bin/fetifeti
strip "$root/bin/fetifeti"
libraries=()
for name in libfetifeti.so libfetifeti_step.so; do
    libraries+=("$root/$lib/$name.$version")
    put 755 "$built/$name" "$lib/$name.$version"
    strip --strip-unneeded "$root/$lib/$name.$version"
    ln -s "$name.$version" "$root/$lib/$name.$abi"
    ln -s "$name.$abi" "$root/$lib/$name"
done
# Panics in crates name their files. The directory becomes "./////" of the same length: nothing moves.
for dir in "$PWD/vendor" "${CARGO_HOME:-$HOME/.cargo}/registry"; do
    (
        export LC_ALL=C
        pattern=$(sed 's/[].[*^$|\\]/\\&/g' <<<"$dir")
        slashes=$(printf '%*s' $((${#dir} - 1)) "" | tr ' ' /)
        sed -i "s|$pattern/|.$slashes/|g" "$root/bin/fetifeti" "${libraries[@]}"
    )
done
fill fetifeti.pc.in "$lib/pkgconfig/fetifeti.pc"
fill fetifeti_step.pc.in "$lib/pkgconfig/fetifeti_step.pc"
fill FetiFetiConfig.cmake.in "$lib/cmake/FetiFeti/FetiFetiConfig.cmake"
fill FetiFetiConfigVersion.cmake.in "$lib/cmake/FetiFeti/FetiFetiConfigVersion.cmake"

put 644 wrappers/fetifeti.h include/fetifeti.h
put 644 wrappers/step/fetifeti_step.h include/fetifeti_step.h
put 644 wrappers/fetifeti.f90 share/fetifeti/fetifeti.f90
# Compilers do not read each other's modules; without one here the source is enough.
if command -v mpif90 >/dev/null; then
    mkdir -p "$root/include" "$stage/f90"
    (here=$PWD && cd "$stage/f90" && mpif90 -ffree-line-length-0 -fsyntax-only "$here/wrappers/fetifeti.f90") ||
        stop "mpif90 did not compile wrappers/fetifeti.f90"
    put 644 "$stage/f90/fetifeti.mod" include/fetifeti.mod
fi

mkdir -p "$stage/man"
"$built/fetifeti" man --out "$stage/man" >/dev/null || stop "$built/fetifeti did not write its manual pages"
for page in "$stage"/man/*.1; do put 644 "$page" "share/man/man1/$(basename "$page")"; done
for shell in bash zsh fish; do "$built/fetifeti" completions $shell >"$stage/$shell"; done
put 644 "$stage/bash" share/bash-completion/completions/fetifeti
put 644 "$stage/zsh" share/zsh/site-functions/_fetifeti
put 644 "$stage/fish" share/fish/vendor_completions.d/fetifeti.fish

for file in README.md CHANGELOG.md LICENSE docs/*.md; do put 644 "$file" "share/doc/fetifeti/$file"; done
for file in docs/images/*; do put 644 "$file" "share/doc/fetifeti/$file"; done
for file in examples/embedding/* examples/clients/*; do [ -f "$file" ] && put 644 "$file" "share/fetifeti/$file"; done
(cd examples/scenes && find . -type f) | while read -r file; do
    put 644 "examples/scenes/$file" "share/fetifeti/examples/scenes/$file"
done
for file in Makefile CMakeLists.txt; do
    put 644 "packaging/examples/$file" "share/fetifeti/examples/embedding/$file"
done

mkdir -p "$root/share/fetifeti"
(cd "$stage$prefix" && find . \( -type f -o -type l \) | sed 's|^\./||' | sort; echo share/fetifeti/installed) \
    >"$stage/installed"
put 644 "$stage/installed" share/fetifeti/installed

mkdir -p "$destdir$prefix" 2>/dev/null && [ -w "$destdir$prefix" ] ||
    stop "$destdir$prefix cannot be written: choose another PREFIX, or run as its owner"
# Files only: directories that are there keep their modes.
tar -C "$root" -cf - -T "$stage/installed" | tar -C "$destdir$prefix" --no-same-owner -xf - ||
    stop "the files could not be copied to $destdir$prefix"
echo "install: fetifeti $version is in $destdir$prefix ($(wc -l <"$stage/installed") files)"
case ":${LD_LIBRARY_PATH:-}:/usr/local/lib:/usr/lib:" in
    *":$libdir:"*) [ -n "$destdir" ] || ldconfig 2>/dev/null || true ;;
esac
