#!/usr/bin/env bash
# Makes the table of docs/petsc_programs.md: PETSc's own programs, unmodified, with KSPFETIFETI, PCBDDC, GAMG and MUMPS.
#
#   scripts/petsc_programs.sh LIBRARY [SOURCES]
#
# LIBRARY is the full path of libfetifeti.so, SOURCES the folder with ksp/ksp, snes and ts; without it those of the
# PETSc that pkg-config finds. A row has for each solver its iterations, summed up over the steps of Newton's method and
# of time, or why there is no answer in the words of the program, and the largest relative difference (2-norm) between
# the final solution of a solver and that of the last one that has one. Where the solver is that of a block, the
# iterations around it come first, those of the block in brackets. Below are the commands by number.
# In the environment, ONLY=ex4: the programs with that in their name; LOGS=FOLDER: what they print is kept there.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/petsc_examples.sh

library=${1:?"expected the full path of libfetifeti.so"}
sources=$(example_sources "${2:-}")
version=$(pkg-config --modversion PETSc)
minor=${version#*.} minor=${minor%%.*}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Runs that never end are ended after so many seconds.
LONGEST=${LONGEST:-120}

# program PATH: the program of a source, built when it is first asked for.
program() {
    local program=$work/${1//\//_}
    [ -e "$program" ] || build_example "$sources/$1.c" "$program" >&2
    echo "$program"
}

# outcome BLOCK CODE <LOG: iterations, or the reason why there is no answer.
outcome() {
    awk -v block="$1" -v code="$2" -v longest="$LONGEST" '
        function sentence(text) {
            sub(/^FETI-FETI: /, "", text)
            sub(/^KSP_DIVERGED_[A-Z_]*: /, "", text)
            sub(/(, |: |; |\. ).*/, "", text)
            return text
        }
        block != "" && $0 ~ "Linear .*" block " solve" {
            inner += $NF
            next
        }
        /[Ll]inear .*solve converged due to/ { if (!/Nonlinear/) { outer += $NF; solved = 1 } }
        /[Ll]inear .*solve did not converge due to/ && ended == "" {
            ended = $0
            sub(/.*due to /, "", ended)
            sub(/ .*/, "", ended)
        }
        /FETI-FETI: / && ours == "" { ours = $0; sub(/.*FETI-FETI: /, "", ours) }
        /Caught signal/ && crash == "" { crash = $0; sub(/.*number [0-9]* /, "", crash); sub(/[:,].*/, "", crash) }
        /PETSC ERROR: / && theirs == "" {
            text = $0
            gsub(/\[[0-9]*\]PETSC ERROR: /, "", text)
            if (text ~ /--- Error Message ---/) seen = NR
            else if (seen && text !~ /^ *$/ && ++lines == 1) class = text
            else if (seen && lines == 2) theirs = text ~ /^(WARNING|See |Option left)/ ? class : text
        }
        END {
            if (code == 0 && ended == "" && solved) print outer + 0 (block == "" ? "" : " (" inner + 0 ")")
            else if (code == 124) print "no end in " longest " s"
            else if (ours != "") print sentence(ours)
            else if (crash != "") print crash
            else if (theirs != "") print sentence(theirs)
            else if (ended != "") print ended
            else print "fails"
        }'
}

# difference FILE...: of the vectors in PETSc's binary format, the largest relative difference to the last of them.
difference() {
    python3 - "$@" <<'PYTHON'
import array, math, sys
def vector(path):
    with open(path, "rb") as file:
        data = file.read()
    header = 8 if len(data) == 8 + 8 * int.from_bytes(data[4:8], "big") else 16  # two numbers of 32 or 64 bits
    entries = array.array("d", data[header:])
    entries.byteswap()
    return entries
vectors = [vector(path) for path in sys.argv[1:]]
if len(vectors) < 2:
    print("–")
else:
    last = vectors[-1]
    print("%.0e" % (max(math.dist(x, last) for x in vectors) / math.hypot(*last)))
PYTHON
}

# row WHAT PATH RANKS OPTIONS...: one row. The variables before it hold for all that follow:
prefix=  # of the KSP
block=   # of the KSP of the block that is solved, after the prefix
torn=    # the options that make a MATIS
whole=   # those that make an AIJ
krylov=  # around PCBDDC and GAMG
row() {
    local what=$1 path=$2 ranks=$3
    shift 3
    [[ $path == *${ONLY:-}* ]] || return 0
    local run name=${path##*/} kind=${path%%/*} of=$prefix$block view cells=() files=() code
    run=$(program "$path")
    case $kind in
    ksp) view=${prefix}ksp_view_solution ;;
    snes) view=snes_view_solution ;;
    ts) view=ts_view_solution ;;
    esac
    for solver in fetifeti bddc gamg mumps; do
        local options=("$@") file=$work/$solver.vec
        rm -f "$file"
        case $solver in
        fetifeti) options+=($torn -dll_append "$library" "-${of}ksp_type" fetifeti) ;;
        bddc) options+=($torn "-${of}ksp_type" "$krylov" "-${of}pc_type" bddc) ;;
        gamg) options+=($whole "-${of}ksp_type" "$krylov" "-${of}pc_type" gamg) ;;
        mumps) options+=($whole "-${of}ksp_type" preonly "-${of}pc_type" lu "-${of}pc_factor_mat_solver_type" mumps) ;;
        esac
        options+=("-${of}ksp_converged_reason" "-${prefix}ksp_converged_reason" -snes_converged_reason)
        code=0
        timeout "$LONGEST" mpirun -n "$ranks" "$run" "${options[@]}" "-$view" "binary:$file" \
            >"$work/log" 2>&1 </dev/null || code=$?
        [ -z "${LOGS:-}" ] || cp "$work/log" "$LOGS/$name-$solver.log"
        cells+=("$(outcome "$block" "$code" <"$work/log")")
        [[ ${cells[-1]} != [0-9]* || ! -e $file ]] || files+=("$file")
    done
    rows=$((rows + 1))
    printf '| %d | `%s` | %s | %d |' "$rows" "$kind $name" "$what" "$ranks"
    printf ' %s |' "${cells[@]}" "$(difference "${files[@]}")"
    echo
    echo "$rows: $kind/$name ${*//$work\//} ${torn//$work\//}" >>"$work/commands"
}

rows=0
echo "PETSc $version:"
echo
echo '| | program | what | ranks | `-ksp_type fetifeti` | PCBDDC | GAMG | MUMPS | difference |'
echo '|---|---|---|---|---|---|---|---|---|'

# Programs of KSP.
krylov=cg
prefix=physical_
row "a cube of spectral elements" ksp/ksp/tutorials/ex59 8 -npx 2 -npy 2 -npz 2 -nex 8 -ney 8 -nez 8 \
    -testfetidp 0 -physical_ksp_rtol 1e-8
prefix= whole="-dm_mat_type aij"
row "Poisson, square" ksp/ksp/tutorials/ex71 9 -dim 2 -cells 48,48 -ksp_rtol 1e-8
row "elastic cube" ksp/ksp/tutorials/ex71 8 -dim 3 -cells 8,8,8 -pde_type Elasticity -ksp_rtol 1e-8
# A matrix in a file: that of ex71, torn and whole.
if [[ ksp/ksp/tutorials/ex72 == *${ONLY:-}* ]]; then
    for type in is aij; do # PETSc 3.18 has no file of a MATIS
        mpirun -n 4 "$(program ksp/ksp/tutorials/ex71)" -dim 2 -cells 24,24 -dm_mat_type $type -pc_type jacobi \
            -ksp_view_mat "binary:$work/$type" -ksp_view_rhs "binary:$work/load" >/dev/null 2>&1 || true
    done
fi
torn="-f $work/is -mat_type is" whole="-f $work/aij -mat_type aij"
row "the matrix of \`ex71\` from a file" ksp/ksp/tutorials/ex72 4 -rhs "$work/load" -ksp_rtol 1e-8
torn= whole=
data=${sources%/examples/src}/datafiles/matrices
[ -d "$data" ] || data=${sources%/src}/share/petsc/datafiles/matrices
cp "$data/spd-real-int32-float64" "$work/spd-real"
row "an AIJ from a file" ksp/ksp/tutorials/ex72 2 -f0 "$work/spd-real" -ksp_rtol 1e-8

# Newton's method on a DMPlex and on a DMDA.
torn="-dm_mat_type is"
square=(-dm_plex_simplex 0 -petscpartitioner_type simple)
poisson=(-run_type full "${square[@]}" -bc_type dirichlet -petscspace_degree 2)
row "Poisson, square" snes/tutorials/ex12 4 "${poisson[@]}" -dm_plex_box_faces 4,4 -dm_refine 2 -ksp_rtol 1e-9
row "the coefficient depends on the solution" snes/tutorials/ex12 4 "${poisson[@]}" -dm_plex_box_faces 4,4 \
    -dm_refine 2 -nonzero_initial_guess 1 -variable_coefficient nonlinear
row "Poisson, cube" snes/tutorials/ex12 4 "${poisson[@]}" -dm_plex_dim 3 -dm_plex_box_faces 4,4,4 -ksp_rtol 1e-9
elastic=("${square[@]}" -sol_type elas_trig -displacement_petscspace_degree 2 -ksp_rtol 1e-9)
row "elastic square" snes/tutorials/ex17 4 "${elastic[@]}" -dm_plex_box_faces 4,4 -dm_refine 2
row "elastic cube" snes/tutorials/ex17 4 "${elastic[@]}" -dm_plex_dim 3 -dm_plex_box_faces 4,4,4
krylov=gmres
row "driven cavity on a DMDA" snes/tutorials/ex19 4 -da_refine 2
krylov=cg
torn="-dm_mat_type is -thi_mat_type is"
row "ice sheet on a DMDA" snes/tutorials/ex48 4 -M 12 -P 5 -ksp_rtol 1e-5
beam=(-max_conv_its 2 -petscspace_degree 2 -petscpartitioner_type simple -attach_mat_nearnullspace -ksp_rtol 1e-8)
if [ "$minor" -lt 19 ]; then
    torn="-ex56_dm_mat_type is"
    row "elastic beam" snes/tutorials/ex56 4 -cells 4,4,2 "${beam[@]}"
else
    torn="-dm_mat_type is"
    row "elastic beam" snes/tutorials/ex56 4 -run_type 1 -dm_plex_dim 3 -dm_plex_simplex 0 -dm_plex_box_lower 0,0,0 \
        -dm_plex_box_upper 1,1,1 -dm_plex_box_faces 4,4,2 "${beam[@]}"
fi
# Saddle points: the operator itself, and one of its blocks.
torn="-dm_mat_type is"
stokes=("${square[@]}" -sol quadratic -dm_plex_box_faces 4,4 -dm_refine 1
    -vel_petscspace_degree 2 -pres_petscspace_degree 1)
krylov=gmres
row "Stokes as a whole" snes/tutorials/ex62 4 "${stokes[@]}" -ksp_rtol 1e-8
schur=(-ksp_type fgmres -pc_type fieldsplit -pc_fieldsplit_type schur -pc_fieldsplit_schur_fact_type upper
    -fieldsplit_pressure_pc_type jacobi)
krylov=cg block=fieldsplit_velocity_
row "its velocities" snes/tutorials/ex62 4 "${stokes[@]}" -petscds_jac_pre 0 -ksp_rtol 1e-10 \
    -ksp_gmres_restart 100 "${schur[@]}" -pc_fieldsplit_schur_precondition a11 -fieldsplit_velocity_ksp_rtol 1e-3 \
    -fieldsplit_pressure_ksp_type preonly
block=fieldsplit_deformation_
row "incompressible Neo-Hooke, its deformation" snes/tutorials/ex77 4 -run_type full "${square[@]}" -dm_plex_dim 3 \
    -dm_plex_box_faces 2,2,2 -def_petscspace_degree 2 -pres_petscspace_degree 1 \
    -elastMat_petscspace_degree 0 -wall_pres_petscspace_degree 0 \
    -bc_fixed 3,4,5,6 -bc_pressure 2 -wall_pressure 1.0 -snes_rtol 1e-5 -ksp_rtol 1e-8 "${schur[@]}" \
    -fieldsplit_deformation_ksp_rtol 1e-6
block=

# Time steps.
step=-ts_time_step
grep -q -e "$step" "$sources/ts/tutorials/ex45.c" || step=-ts_dt
times=("${square[@]}" -ts_type beuler -ts_max_steps 3 "$step" 0.1)
heat=("${times[@]}" -sol_type trig_trig -temp_petscspace_degree 2 -ksp_rtol 1e-9)
row "heat, square" ts/tutorials/ex45 4 "${heat[@]}" -dm_plex_box_faces 4,4 -dm_refine 2
row "heat, cube" ts/tutorials/ex45 4 "${heat[@]}" -dm_plex_dim 3 -dm_plex_box_faces 4,4,4
krylov=gmres block=fieldsplit_velocity_
row "Navier-Stokes, its velocities" ts/tutorials/ex46 4 "${times[@]}" -dm_plex_box_faces 2,2 -vel_petscspace_degree 2 \
    -ts_max_steps 1 -pres_petscspace_degree 1 -ksp_rtol 1e-4 "${schur[@]}" -fieldsplit_pressure_ksp_rtol 1e-3 \
    -fieldsplit_velocity_ksp_rtol 1e-6
block=
row "advection" ts/tutorials/ex47 4 "${times[@]}" -dm_plex_box_faces 4,4 -dm_refine 2 -phi_petscspace_degree 1 \
    -vel_petscspace_degree 1
triangles=(-dm_plex_transform_type refine_tosimplex) # which 3.18 has not, and does not insist on
[ "$minor" -ge 19 ] || triangles=()
row "magnetohydrodynamics" ts/tutorials/ex48 4 "${square[@]}" -dm_plex_box_lower -2,-2 -dm_plex_box_upper 2,2 \
    -dm_plex_box_faces 4,4 -dm_refine 1 "${triangles[@]}" -petscspace_degree 2 -ts_type beuler -ts_max_steps 1 \
    "$step" 0.001

# Every element is a subdomain, several of them on a rank: PETSc 3.21 and later.
torn= whole="-dm_mat_type aij" krylov=cg
if grep -q multi_element "$sources/ksp/ksp/tutorials/ex71.c"; then
    row "elastic cube of 216 subdomains" ksp/ksp/tutorials/ex71 4 -dim 3 -cells 6,6,6 \
        -multi_element -pde_type Elasticity -ksp_rtol 1e-8
fi

# The commands, in lines that fit.
echo
echo '```text'
python3 - "$work/commands" <<'PYTHON'
import sys, textwrap
for line in open(sys.argv[1]):
    print(*textwrap.wrap(line, 117, subsequent_indent="    ", break_on_hyphens=False, break_long_words=False), sep="\n")
PYTHON
echo '```'
