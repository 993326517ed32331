#!/bin/bash
# Builds a newer PETSc and SLEPc than Debian's from the source packages of the Python registry (PyPI), into one folder:
#   scripts/newer_petsc.sh FOLDER [PETSC_VERSION SLEPC_VERSION]
# leaves FOLDER/petsc-VERSION and FOLDER/slepc-VERSION (both with arch-fetifeti) and FOLDER/env, to be sourced. What is
# already built stays. MUMPS, ScaLAPACK and PT-Scotch are Debian's, as in Debian's PETSc; Debian's hypre is too old for
# PETSc 3.22.
set -euo pipefail

folder=$(mkdir -p "$1" && cd "$1" && pwd)
petsc=${2:-3.22.5}
slepc=${3:-3.22.2}
arch=arch-fetifeti
index=${PIP_INDEX_URL:-https://pypi.org/simple}
jobs=$(nproc)

# fetch NAME VERSION: the source package, checked against the registry's own SHA-256, unpacked.
fetch() {
    [ -d "$folder/$1-$2" ] && return
    echo "Fetching $1 $2 ..."
    python3 - "$index" "$1" "$2" "$folder" <<'PYTHON'
import hashlib, re, sys, tarfile, urllib.parse, urllib.request
index, name, version, folder = sys.argv[1:]
page = f"{index.rstrip('/')}/{name}/"
text = urllib.request.urlopen(page).read().decode()
file = f"{name}-{version}.tar.gz"
links = [link for link in re.findall(r'href="([^"]+)"', text) if urllib.parse.urlsplit(link).path.endswith("/" + file)]
if not links:
    sys.exit(f"The registry has no source package {file}.")
link, _, digest = urllib.parse.urljoin(page, links[0]).partition("#sha256=")
data = urllib.request.urlopen(link).read()
if digest and hashlib.sha256(data).hexdigest() != digest.split("&")[0]:
    sys.exit(f"{file} does not have the SHA-256 that the registry states.")
with open(f"{folder}/{file}", "wb") as out:
    out.write(data)
with tarfile.open(f"{folder}/{file}") as archive:
    archive.extractall(folder)
PYTHON
}

# step WHAT LOG COMMAND...: runs the command with its output in a log; the log's end is shown when it fails.
step() {
    local what=$1 log=$2
    shift 2
    echo "$what (log: $log) ..."
    "$@" >"$log" 2>&1 || { tail -n 40 "$log"; echo "$what failed; see $log."; exit 1; }
}

fetch petsc "$petsc"
fetch slepc "$slepc"
export PETSC_DIR=$folder/petsc-$petsc SLEPC_DIR=$folder/slepc-$slepc PETSC_ARCH=$arch

if [ ! -e "$PETSC_DIR/$arch/lib/libpetsc.so" ]; then
    cd "$PETSC_DIR"
    step "Configuring PETSc $petsc" "$folder/petsc-configure.log" ./configure PETSC_ARCH=$arch \
        --with-debugging=0 COPTFLAGS=-O2 CXXOPTFLAGS=-O2 FOPTFLAGS=-O2 --with-shared-libraries=1 \
        "--with-blaslapack-lib=[-llapack,-lblas]" --with-x=0 --with-fortran-bindings=0 \
        --with-scalapack-lib=-lscalapack-openmpi \
        --with-mumps-include=/usr/include \
        "--with-mumps-lib=[-ldmumps,-lzmumps,-lsmumps,-lcmumps,-lmumps_common,-lpord]" \
        --with-ptscotch-include=/usr/include/scotch \
        "--with-ptscotch-lib=[-lptesmumps,-lptscotch,-lptscotcherr,-lscotch,-lscotcherr]"
    step "Building PETSc $petsc" "$folder/petsc-make.log" make -j"$jobs" all
fi
if [ ! -e "$SLEPC_DIR/$arch/lib/libslepc.so" ]; then
    cd "$SLEPC_DIR"
    step "Configuring SLEPc $slepc" "$folder/slepc-configure.log" ./configure
    step "Building SLEPc $slepc" "$folder/slepc-make.log" make -j"$jobs" all
fi

cat >"$folder/env" <<ENV
export PETSC_DIR=$PETSC_DIR SLEPC_DIR=$SLEPC_DIR PETSC_ARCH=$arch
export PKG_CONFIG_PATH=$PETSC_DIR/$arch/lib/pkgconfig:$SLEPC_DIR/$arch/lib/pkgconfig
export LD_LIBRARY_PATH=$PETSC_DIR/$arch/lib:$SLEPC_DIR/$arch/lib
ENV
echo "PETSc $petsc and SLEPc $slepc are ready: source $folder/env"
