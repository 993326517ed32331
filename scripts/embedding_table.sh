#!/usr/bin/env bash
# Makes the table of docs/embedding.md: iterations and condition numbers of PCBDDC, KSPFETIDP and KSPFETIFETI in PETSc's
# own examples.
#
#   scripts/embedding_table.sh LIBRARY      LIBRARY is the full path of libfetifeti.so
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/petsc_examples.sh

library=${1:?"expected the full path of libfetifeti.so"}
sources=$(example_sources)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for example in ex71 ex49 ex59; do
    build_example "$sources/ksp/ksp/tutorials/$example.c" "$work/$example"
done

# iterations / condition number of a run: run RANKS PREFIX PROGRAM ARGUMENTS...
run() {
    local ranks=$1 prefix=$2 program=$3
    shift 3
    mpirun -n "$ranks" "$work/$program" "$@" "-${prefix}ksp_rtol" 1e-8 "-${prefix}ksp_converged_reason" \
        "-${prefix}ksp_view_singularvalues" 2>/dev/null |
        awk '/extreme singular values/ { kappa = $NF }
             /converged due|not converge/ { its = $NF; sub(/^.*due to /, ""); reason = $1 }
             END {
                 if (its == "") print "fails"
                 else if (reason ~ /^DIVERGED/) print reason
                 else if (its == 0 || kappa == "") print its " / –"
                 else printf "%d / %.2f\n", its, kappa
             }'
}

row() {
    local what=$1 ranks=$2 prefix=$3
    shift 3
    local fetifeti=(-dll_append "$library" "-${prefix}ksp_type" fetifeti "-${prefix}fetifeti_true_residual" 0)
    local cells=()
    local bddc=("-${prefix}ksp_type" cg "-${prefix}pc_type" bddc "-${prefix}ksp_norm_type" natural)
    cells+=("$(run "$ranks" "$prefix" "$@" "${bddc[@]}")")
    cells+=("$(run "$ranks" "$prefix" "$@" "-${prefix}ksp_type" fetidp)")
    for bodies in 1 2 4 "$ranks"; do
        cells+=("$(run "$ranks" "$prefix" "$@" "${fetifeti[@]}" "-${prefix}fetifeti_bodies" "$bodies")")
    done
    printf '| %s | %d |' "$what" "$ranks"
    printf ' %s |' "${cells[@]}"
    echo
}

echo '| problem | ranks | PCBDDC | KSPFETIDP | 1 body | 2 bodies | 4 bodies | as many as ranks |'
echo '|---|---|---|---|---|---|---|---|'
for ranks in 4 9 16; do
    row '`ex71 -dim 2 -cells 48,48`' $ranks "" ex71 -dim 2 -cells 48,48
done
row '`ex71 -dim 2 -cells 48,48 -dirichlet 0`' 16 "" ex71 -dim 2 -cells 48,48 -dirichlet 0
row '`ex71 -dim 2 -cells 48,48 -periodicity 1,1`' 16 "" ex71 -dim 2 -cells 48,48 -periodicity 1,1
row '`ex71 -dim 2 -cells 48,48 -pde_type Elasticity`' 16 "" ex71 -dim 2 -cells 48,48 -pde_type Elasticity
row '`ex71 -dim 3 -cells 12,12,12`' 8 "" ex71 -dim 3 -cells 12,12,12
row '`ex71 -dim 3 -cells 8,8,8 -pde_type Elasticity`' 8 "" ex71 -dim 3 -cells 8,8,8 -pde_type Elasticity
row '`ex71 -dim 3 -cells 8,8,8 -pde_type Elasticity -dirichlet 0`' 8 "" \
    ex71 -dim 3 -cells 8,8,8 -pde_type Elasticity -dirichlet 0
row '`ex49 -mx 48 -my 48 -dm_mat_type is`' 16 elas_ ex49 -mx 48 -my 48 -dm_mat_type is -no_view
bricks=(-mx 40 -my 40 -dm_mat_type is -no_view -c_str 2 -brick_E 1,1000 -brick_nu 0.4,0.2 -brick_span 20)
row '`ex49`, bricks with E of 1 and 1000' 9 elas_ ex49 "${bricks[@]}"
row '`ex59 -npx 4 -npy 2 -nex 24 -ney 24`' 8 physical_ ex59 -testfetidp 0 -npx 4 -npy 2 -nex 24 -ney 24
row '`ex59 -npx 2 -npy 2 -npz 2 -nex 8 -ney 8 -nez 8`' 8 physical_ \
    ex59 -testfetidp 0 -npx 2 -npy 2 -npz 2 -nex 8 -ney 8 -nez 8
