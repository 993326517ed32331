# Functions to be sourced by the scripts that run PETSc's own example programs: where the sources are, and a build.

# example_sources [FOLDER]: the folder that has ksp/ksp/tutorials, snes/tutorials and ts/tutorials: FOLDER, or else that
# of the PETSc that pkg-config finds, of a source tree or of Debian's package of examples.
example_sources() {
    local prefix folder version
    prefix=$(pkg-config --variable=prefix PETSc)
    version=$(pkg-config --modversion PETSc)
    for folder in ${1:+"$1"} "${PETSC_DIR:-$prefix}/src" "$prefix/share/petsc/examples/src" \
        "/usr/share/petsc/${version%.*}/share/petsc/examples/src"; do
        [ -d "$folder/ksp/ksp/tutorials" ] && echo "$folder" && return
    done
    echo "No folder has ksp/ksp/tutorials; expected the sources of PETSc's examples." >&2
    return 1
}

# build_example SOURCE PROGRAM: compiles one source with the PETSc that pkg-config finds. HDF5 where it is: some include
# its header.
build_example() {
    local flags
    read -ra flags <<<"$(pkg-config --cflags --libs PETSc) $(pkg-config --cflags hdf5-openmpi 2>/dev/null)"
    mpicc -O1 -w -o "$2" "$1" "${flags[@]}" "-Wl,-rpath,$(pkg-config --variable=libdir PETSc)" -llapack -lblas -lm
}
