#!/bin/bash
# Builds a newer PETSc and SLEPc than Debian's from the source packages of the Python registry (PyPI), into one folder:
#   scripts/newer_petsc.sh FOLDER [PETSC_VERSION [SLEPC_VERSION]]
# The version is the newest of which the registry has both, unless it is given: 3.25 is the newest 3.25.x. SLEPc's is
# the newest that belongs to it. Left are FOLDER/petsc-VERSION and FOLDER/slepc-VERSION and a file to be sourced,
# FOLDER/env. What is already built stays. INDICES=64 in the environment: 64-bit indices, beside the others, with
# FOLDER/env-64. With PETSc 3.23 and later come Fortran's modules, and petsc4py where indices have 32 bits.
# MUMPS, ScaLAPACK, PT-Scotch and SuiteSparse are Debian's, as in Debian's PETSc; PT-Scotch is left out with 64-bit
# indices, which Debian's has not, and MUMPS takes them as long as they fit into 32. Debian's hypre is too old for PETSc
# 3.22, and HPDDM is no package of Debian's.
set -euo pipefail

folder=$(mkdir -p "$1" && cd "$1" && pwd)
bits=${INDICES:-32}
index=${PIP_INDEX_URL:-https://pypi.org/simple}
jobs=${JOBS:-$(nproc)}
# Taken where the registry is not reached and nothing is built yet.
fallback=3.26.1

# newest PETSC SLEPC: the versions to build, from the registry's pages.
newest() {
    python3 - "$index" "$1" "$2" <<'PYTHON'
import re, sys, urllib.request
index, petsc, slepc = sys.argv[1:]
def versions(name, wanted):
    text = urllib.request.urlopen(f"{index.rstrip('/')}/{name}/", timeout=60).read().decode()
    found = {tuple(map(int, v)) for v in re.findall(rf"{name}-(\d+)\.(\d+)\.(\d+)\.tar\.gz", text)}
    start = tuple(map(int, wanted.split("."))) if wanted else ()
    return sorted(v for v in found if v[:len(start)] == start)
try:
    ours, theirs = versions("petsc", petsc), versions("slepc", slepc)
except OSError as error:
    sys.exit(f"The registry is not reached: {error}.")
both = [v for v in ours if any(s[:2] == v[:2] for s in theirs)]
if not both:
    sys.exit(f"The registry has no PETSc {petsc} with a SLEPc {slepc} of the same minor version.")
print(".".join(map(str, both[-1])), ".".join(map(str, max(s for s in theirs if s[:2] == both[-1][:2]))))
PYTHON
}

if [ -n "${3:-}" ] && [[ ${2:-} == *.*.* ]]; then
    petsc=$2 slepc=$3
elif found=$(newest "${2:-}" "${3:-}"); then
    read -r petsc slepc <<<"$found"
elif [ -z "${2:-}" ] && petsc=$(sed -n 's/.*PETSC_DIR=.*petsc-\([0-9.]*\) .*/\1/p' "$folder/env" 2>/dev/null) &&
    [ -n "$petsc" ]; then
    slepc=$(sed -n 's/.*SLEPC_DIR=.*slepc-\([0-9.]*\) .*/\1/p' "$folder/env")
    echo "Taken is what $folder has: PETSc $petsc and SLEPc $slepc."
elif [ -z "${2:-}" ]; then
    petsc=$fallback slepc=$fallback
    echo "Taken is PETSc $petsc, the newest when this script was written."
else
    exit 1
fi
arch=arch-fetifeti env=$folder/env options=()
if [ "$bits" = 64 ]; then
    arch=arch-fetifeti-64 env=$folder/env-64
    options=(--with-64-bit-indices=1)
else
    options=(--with-ptscotch-include=/usr/include/scotch
        "--with-ptscotch-lib=[-lptesmumps,-lptscotch,-lptscotcherr,-lscotch,-lscotcherr]")
fi
# CHOLMOD is the fastest solver of subdomains that PCBDDC has here.
if [ -e /usr/include/suitesparse/cholmod.h ]; then
    options+=(--with-suitesparse-include=/usr/include/suitesparse
        "--with-suitesparse-lib=[-lspqr,-lumfpack,-lklu,-lcholmod,-lamd]")
else
    echo "SuiteSparse is left out: /usr/include/suitesparse/cholmod.h is missing (Debian: libsuitesparse-dev)."
fi
# The bindings of Fortran are made by PETSc's own script from 3.23 on; before that by a program that is not here.
minor=${petsc#*.} minor=${minor%%.*}
fortran=0
[ "$minor" -lt 23 ] || fortran=1
echo "PETSc $petsc and SLEPc $slepc, indices of $bits bits"

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
    step "Configuring PETSc $petsc" "$folder/petsc-configure-$bits.log" ./configure PETSC_ARCH=$arch \
        --with-debugging=0 COPTFLAGS=-O2 CXXOPTFLAGS=-O2 FOPTFLAGS=-O2 --with-shared-libraries=1 \
        "--with-blaslapack-lib=[-llapack,-lblas]" --with-x=0 --with-fortran-bindings=$fortran \
        --with-scalapack-lib=-lscalapack-openmpi \
        --with-mumps-include=/usr/include \
        "--with-mumps-lib=[-ldmumps,-lzmumps,-lsmumps,-lcmumps,-lmumps_common,-lpord]" "${options[@]}"
    step "Building PETSc $petsc" "$folder/petsc-make-$bits.log" make -j"$jobs" all
fi
if [ ! -e "$SLEPC_DIR/$arch/lib/libslepc.so" ]; then
    cd "$SLEPC_DIR"
    step "Configuring SLEPc $slepc" "$folder/slepc-configure-$bits.log" ./configure
    step "Building SLEPc $slepc" "$folder/slepc-make-$bits.log" make -j"$jobs" all
fi

python=$PETSC_DIR/$arch/python
cat >"$env" <<ENV
export PETSC_DIR=$PETSC_DIR SLEPC_DIR=$SLEPC_DIR PETSC_ARCH=$arch
export PKG_CONFIG_PATH=$PETSC_DIR/$arch/lib/pkgconfig:$SLEPC_DIR/$arch/lib/pkgconfig
export LD_LIBRARY_PATH=$PETSC_DIR/$arch/lib:$SLEPC_DIR/$arch/lib
export PYTHONPATH=$python
ENV

# petsc4py for Debian's Python, with a Cython of its own: Debian 12's is too old for it.
python3=/usr/bin/python3
[ -x $python3 ] || python3=$(command -v python3)
headers=$($python3 -c 'import sysconfig; print(sysconfig.get_paths()["include"])')
if [ "$bits" = 64 ] || [ $fortran = 0 ] || [ -d "$python/petsc4py" ]; then
    :
elif [ ! -e "$headers/Python.h" ]; then
    echo "petsc4py is left out: $headers/Python.h is missing (Debian: python3-dev)."
else
    tools=$folder/python-tools
    [ -e "$tools/bin/python" ] ||
        step "Installing Cython" "$folder/cython.log" bash -c "
            $python3 -m venv --system-site-packages '$tools' && '$tools/bin/pip' install 'cython>=3' setuptools wheel"
    step "Building petsc4py $petsc" "$folder/petsc4py.log" "$tools/bin/pip" install --no-deps --no-build-isolation \
        --no-binary petsc4py --target "$python" "petsc4py==$petsc"
fi

echo "PETSc $petsc and SLEPc $slepc are ready: source $env"
