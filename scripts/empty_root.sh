#!/usr/bin/env bash
# From the sources to a program, `import fetifeti` and find_package(FetiFeti) where nothing but Debian is installed:
# debootstrap makes a Debian 12 below DIR, which gets a clone of the last commit, and runs there the commands that
# README.md has under "Installation". Then the archive of `make dist` builds the library without a network.
#
#   scripts/empty_root.sh DIR [MIRROR]
#
# As root; needs debootstrap, and 6 GB below DIR. Certificates and the mirror are this machine's. DIR stays.
# Exit code 3: something is missing; otherwise that of the command that failed.
set -euo pipefail
cd "$(dirname "$0")/.."

stop() {
    echo "empty root: $*" >&2
    exit 3
}

[ $# -ge 1 ] || stop "expected a directory"
root=$1 mirror=${2:-http://deb.debian.org/debian}
[ "$(id -u)" -eq 0 ] || stop "debootstrap and chroot need root"
command -v debootstrap >/dev/null || stop "debootstrap is missing: apt-get install debootstrap"
[ ! -e "$root" ] || stop "$root is there already, expected a new directory"

mkdir -p "$root"
root=$(cd "$root" && pwd)
took() { echo "empty root: $1 took $(($(date +%s) - begin)) s, $(du -shx "$root" 2>/dev/null | cut -f1) in all"; }
# Runs a script with nothing of this environment; a login of root under Open MPI needs its word.
inside() {
    local run=(chroot "$root" env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
        LANG=C.UTF-8 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1)
    "$@" "${run[@]}" bash -euo pipefail -c "cd /root; [ ! -d sources ] || cd sources; $(cat)"
}

begin=$(date +%s)
debootstrap --variant=minbase bookworm "$root" "$mirror" >/dev/null || stop "debootstrap failed"
took "debootstrap"
mount -t proc proc "$root/proc"
mount --bind /sys "$root/sys"
mount --bind /dev "$root/dev"
trap 'umount "$root/dev" "$root/sys" "$root/proc"' EXIT
[ ! -e /etc/resolv.conf ] || cp /etc/resolv.conf "$root/etc/"
mkdir -p "$root/usr/local/share/ca-certificates"
cp -r /usr/local/share/ca-certificates/. "$root/usr/local/share/ca-certificates/"
git clone --quiet --no-hardlinks . "$root/root/sources"
inside env <<<'apt-get -q update; apt-get -q -y --no-install-recommends install make git' >/dev/null

# The first block of commands below the heading.
commands=$(sed -n '/^## Installation/,/^## Q/p' README.md | sed -n '/^```sh/,/^```/p' | sed '/^```/d')
[ -n "$commands" ] || stop "README.md has no commands under 'Installation'"
inside env <<<'make setup'
took "everything up to the Debian packages"
inside env <<<"set -x; $commands"
inside env <<<'du -sh /root/fetifeti; git status --short'
took "everything up to the README's last command"

inside env <<<'make dist; tar -C /root -xf target/dist/fetifeti-*.tar.xz'
inside unshare -n <<'END'
cd /root/fetifeti-[0-9]*
CARGO_HOME=$(mktemp -d) cargo build --release --offline --locked
du -sh target/release/fetifeti target/release/libfetifeti.so
END
took "everything"
