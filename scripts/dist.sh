#!/usr/bin/env bash
# Writes a source archive that builds without a registry: what the last commit has, and in vendor/ the crates of
# Cargo.lock. The same commit gives the same archive.
#
#   scripts/dist.sh [DIR]           DIR/fetifeti-VERSION.tar.xz; DIR is target/dist if it is left out
#   scripts/dist.sh DIR --unpacked  the directory DIR/fetifeti-VERSION instead
#
# Exit code 3: it could not be made.
set -euo pipefail
cd "$(dirname "$0")/.."

stop() {
    echo "dist: $*" >&2
    exit 3
}

dir=${1:-target/dist} unpacked=${2:-}
[ -z "$unpacked" ] || [ "$unpacked" = --unpacked ] || stop "expected --unpacked, found '$unpacked'"
commit=$(git rev-parse HEAD 2>/dev/null) || stop "this is no clone of the repository: the archive has what git has"
[ -z "$(git status --porcelain --untracked-files=no)" ] || echo "dist: changes that are not committed are left out" >&2
name=fetifeti-$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
mkdir -p "$dir" || stop "$dir cannot be made"
dir=$(cd "$dir" && pwd)
stage=$(mktemp -d "$dir/stage.XXXXXX") || stop "$dir cannot be written"
trap 'rm -rf "$stage"' EXIT

git archive --prefix="$name/" "$commit" | tar -C "$stage" -xf -
(cd "$stage/$name" && cargo vendor --quiet --locked vendor >/dev/null) ||
    stop "cargo could not bring the crates of Cargo.lock together; see its messages above"
cat >>"$stage/$name/.cargo/config.toml" <<END

# The crates are in this archive.
[source.crates-io]
replace-with = "vendored-sources"

[source.vendored-sources]
directory = "vendor"
END

if [ -n "$unpacked" ]; then
    rm -rf "${dir:?}/$name"
    mv "$stage/$name" "$dir/$name"
    echo "dist: $dir/$name"
else
    tar -C "$stage" --sort=name --owner=0 --group=0 --numeric-owner --mode=go=rX,u+rw \
        --mtime="@$(git log -1 --format=%ct "$commit")" -cf - "$name" | xz -T0 >"$stage/archive"
    mv "$stage/archive" "$dir/$name.tar.xz"
    echo "dist: $dir/$name.tar.xz ($(stat -c %s "$dir/$name.tar.xz" | numfmt --to=si)B)"
fi
