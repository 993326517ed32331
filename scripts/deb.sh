#!/usr/bin/env bash
# Makes a Debian source package and its binary packages, from the archive of scripts/dist.sh and packaging/debian.
#
#   scripts/deb.sh [DIR]      everything lands in DIR, target/deb if it is left out
#
# Exit code 3: something is missing, or dpkg-buildpackage failed.
set -euo pipefail
cd "$(dirname "$0")/.."

stop() {
    echo "deb: $*" >&2
    exit 3
}

dir=${1:-target/deb}
for tool in dpkg-buildpackage dh; do
    command -v $tool >/dev/null || stop "$tool is missing: apt-get install --no-install-recommends dpkg-dev debhelper"
done
scripts/dist.sh "$dir"
dir=$(cd "$dir" && pwd)
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
mv "$dir/fetifeti-$version.tar.xz" "$dir/fetifeti_$version.orig.tar.xz"
rm -rf "${dir:?}/fetifeti-$version"
tar -C "$dir" -xf "$dir/fetifeti_$version.orig.tar.xz"
cp -r packaging/debian "$dir/fetifeti-$version/debian"
cd "$dir/fetifeti-$version"

# A toolchain of rustup's is no package: dpkg would miss Rust although it is there.
flags=(-us -uc)
if ! dpkg-checkbuilddeps 2>"$dir/missing"; then
    missing=$(sed 's/.*build dependencies: //; s/([^)]*)//g; s/|//g' "$dir/missing" | tr -s ' ' '\n' |
        grep -vE '^(cargo|rustc)(-web)?$' | tr '\n' ' ' || true)
    rm "$dir/missing"
    [ -z "${missing// /}" ] || stop "build dependencies are missing: $missing"
    command -v cargo >/dev/null || stop "cargo is missing"
    # debhelper gives the build another home.
    [ -d "$HOME/.rustup" ] && export RUSTUP_HOME="${RUSTUP_HOME:-$HOME/.rustup}"
    flags+=(-d)
fi
dpkg-buildpackage "${flags[@]}" || stop "dpkg-buildpackage failed; see its messages above"
cd ..
rm -rf "fetifeti-$version"
ls -l "$dir"
