/*
   A block on a rigid plane, or on another block, with friction by the functions of fetifeti.h, in the plane and in
   space. What is printed is compared with other computations.
     -dim, -cells 16,8 -edge 0.125 -poisson 0.3   the block, with a modulus of 1
     -top 0.02,-0.1                               traction on its upper side
     -friction, -limit, -tresca, -stiffness, -stick   the law, per area
     -loads 1,0.5                                 factors of load steps
     -turn 0.3                                    everything turned in the plane of the first two axes
     -belt 0.5                                    the plane moves by so much in each load step, the upper side is held
     -manual                                      slips are added up here
     -view                                        the solver is shown after each load step
     -second pairs, mortar                        the block is the upper one of two, joined in this way
     -wrong                                       does one thing wrong
*/
static const char help[] = "Friction by the functions of fetifeti.h.\n";

#include <math.h>
#include "block.h"

static char wrong[20] = "", second[20] = "";

static PetscBool Is(const char option[], const char what[])
{
  PetscBool same;

  PetscCallAbort(PETSC_COMM_SELF, PetscStrcmp(option, what, &same));
  return same;
}

/* Sums over ranks: normal forces, friction, states, lengths of slips; and u at two corners. */
static PetscErrorCode Print(const Block *block, PetscInt step, Vec u, const PetscReal sums[9])
{
  const PetscInt dim = block->dim;
  PetscReal      all[9], probe[2][3] = {{0}}, there[2][3];
  PetscInt       k, c, first, last, dof;
  PetscScalar    v;
  AO             ao;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Allreduce(sums, all, 9, MPIU_REAL, MPIU_SUM, PETSC_COMM_WORLD));
  PetscCall(DMDAGetAO(block->da, &ao));
  PetscCall(VecGetOwnershipRange(u, &first, &last));
  for (k = 0; k < 2; k++)
    for (c = 0; c < dim; c++) {
      dof = dim * (k ? 0 : Node(block, block->cells[0], block->cells[1], dim == 3 ? block->cells[2] : 0)) + c;
      PetscCall(AOApplicationToPetsc(ao, 1, &dof));
      if (first <= dof && dof < last) {
        PetscCall(VecGetValues(u, 1, &dof, &v));
        probe[k][c] = v;
      }
    }
  PetscCallMPI(MPI_Allreduce(probe, there, 6, MPIU_REAL, MPIU_SUM, PETSC_COMM_WORLD));
  Turn(-block->turn, all + 1);
  Turn(-block->turn, there[0]);
  Turn(-block->turn, there[1]);
  PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                        "step %d normal %.12f friction %.12f %.12f %.12f open %g holds %g stick %g slip %g slid "
                        "%.12f\n",
                        (int)step, all[0], all[1], all[2], all[3], all[4], all[5], all[6], all[7], all[8]));
  for (k = 0; k < 2; k++)
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  %s %.12f %.12f %.12f\n", k ? "B" : "A", there[k][0], there[k][1],
                          there[k][2]));
  PetscFunctionReturn(0);
}

/* The rows of the lower side beside the plane, or beside the upper side of the block under it: each rank gives some. */
static PetscErrorCode Rows(FetiFeti ff, const Block *block, const Block *under, PetscInt *rows, PetscReal **area)
{
  const PetscInt dim = block->dim;
  PetscInt       n, c, k, *numbers[3], *other, at, *ja, *begin, *kinds;
  PetscScalar    down[3] = {0, -1, 0}, *b;
  PetscReal     *gap;
  PetscMPIInt    rank, size;
  IS             is[2];

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  Turn(block->turn, down);
  for (c = 0; c < dim; c++) PetscCall(Side(block, 0, c, &numbers[c], &n));
  PetscCall(PetscCalloc5(n + 1, &begin, dim * n, &ja, dim * n, &b, n, &gap, n, &kinds));
  PetscCall(PetscMalloc1(n, area));
  for (k = rank, *rows = 0; k < n; k += size, ++*rows) {
    (*area)[*rows] = Area(block, k % (block->cells[0] + 1), k / (block->cells[0] + 1));
    begin[*rows + 1] = begin[*rows];
    for (c = 0; c < dim; c++) {
      if (PetscAbsReal(down[c]) < 1e-15) continue;
      ja[begin[*rows + 1]]  = numbers[c][k];
      b[begin[*rows + 1]++] = down[c];
    }
    kinds[*rows] = Is(wrong, "tie") || Is(wrong, "soft_tie") ? FETIFETI_EQUALITY : FETIFETI_INEQUALITY;
  }
  if (Is(wrong, "directions") && !rank) ja[1] = numbers[1][size]; /* along x here, along y at the next node */
  if (!under) PetscCall(FetiFetiSetContactRows(ff, *rows, begin, ja, b, gap, kinds));
  else {
    PetscCall(Side(under, 1, 1, &other, &at));
    for (k = rank, at = 0; k < n; k += size, at++) {
      ja[at]    = other[4 + k % (block->cells[0] + 1) + (under->cells[0] + 1) * (k / (block->cells[0] + 1))];
      begin[at] = numbers[1][k];
    }
    PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, at, ja, PETSC_COPY_VALUES, &is[0]));
    PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, at, begin, PETSC_COPY_VALUES, &is[1]));
    PetscCall(FetiFetiSetContactPairs(ff, 0, is[0], 1, is[1], NULL, FETIFETI_INEQUALITY));
    for (k = 0; k < 2; k++) PetscCall(ISDestroy(&is[k]));
    PetscCall(PetscFree(other));
  }
  for (c = 0; c < dim; c++) PetscCall(PetscFree(numbers[c]));
  PetscCall(PetscFree5(begin, ja, b, gap, kinds));
  PetscFunctionReturn(0);
}

/* The law of rows: what is per area becomes a force. */
static PetscErrorCode Law(FetiFeti ff, PetscInt rows, const PetscReal area[], const PetscReal per_area[5])
{
  PetscReal *law[5];
  PetscInt   k, r;

  PetscFunctionBeginUser;
  for (k = 0; k < 5; k++) {
    PetscCall(PetscMalloc1(rows, &law[k]));
    for (r = 0; r < rows; r++) law[k][r] = per_area[k] < PETSC_INFINITY && k ? per_area[k] * area[r] : per_area[k];
  }
  if (Is(wrong, "laws")) rows++;
  if (Is(wrong, "limit") || Is(wrong, "stick"))
    PetscCall(FetiFetiSetContactLaw(ff, rows, NULL, law[1], NULL, law[3], law[4]));
  PetscCall(FetiFetiSetContactLaw(ff, rows, law[0], law[1], law[2], law[3], law[4]));
  for (k = 0; k < 5; k++) PetscCall(PetscFree(law[k]));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Block       block = {2, {16, 8, 0}, 0.125, {0, 0}, 1, 0.3, {0}, 0, NULL, NULL, NULL};
  Block       under = {2, {16, 8, 0}, 0.125, {0, 0}, 1, 0.3, {0}, 0, NULL, NULL, NULL};
  PetscReal   law[5] = {0, PETSC_INFINITY, 0, PETSC_INFINITY, PETSC_INFINITY}, loads[10] = {1}, belt = 0;
  PetscReal  *area, *lambda, *force, *slip, *from, sums[9];
  const char *keys[5] = {"-friction", "-limit", "-tresca", "-stiffness", "-stick"};
  PetscInt    rows = 0, nodes, dim, step, k, c, n, steps = 10, three = 3, *state;
  PetscBool   set, manual, view, *own = NULL;
  FetiFeti    ff;
  Vec         load, scaled, u, both[2];

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-wrong", wrong, sizeof(wrong), NULL));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-second", second, sizeof(second), NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-dim", &block.dim, NULL));
  PetscCall(PetscOptionsGetIntArray(NULL, NULL, "-cells", block.cells, &three, NULL));
  three = 3;
  PetscCall(PetscOptionsGetRealArray(NULL, NULL, "-top", block.top, &three, NULL));
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-edge", &block.edge, NULL));
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-turn", &block.turn, NULL));
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-belt", &belt, NULL));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-manual", &manual));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-view", &view));
  for (k = 0; k < 5; k++) PetscCall(PetscOptionsGetReal(NULL, NULL, keys[k], &law[k], NULL));
  PetscCall(PetscOptionsGetRealArray(NULL, NULL, "-loads", loads, &steps, &set));
  if (!set) steps = 1;
  dim = block.dim;
  PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
  PetscCall(FetiFetiSetFromOptions(ff));
  if (second[0]) {
    block.low[0] = 0.5, block.low[1] = 1, block.young = 2, block.poisson = 0.2;
    if (dim == 3) under.dim = 3, under.cells[2] = 8;
    under.turn = block.turn;
    PetscCall(Make(&under));
    for (c = 0; c < dim; c++) PetscCall(Hold(&under, 0, c));
    PetscCall(FetiFetiAddMatIS(ff, under.A, NULL, 0));
  }
  PetscCall(Make(&block));
  if (belt) PetscCall(Hold(&block, 1, 0));
  if (Is(wrong, "blocks")) PetscCall(FetiFetiSetBlockSize(ff, 1));
  if (second[0]) PetscCall(FetiFetiAddMatIS(ff, block.A, NULL, 1));
  else PetscCall(FetiFetiSetMatIS(ff, block.A, 0));
  both[0] = under.load, both[1] = block.load;
  if (second[0]) PetscCall(VecCreateNest(PETSC_COMM_WORLD, 2, NULL, both, &load));
  else PetscCall(PetscObjectReference((PetscObject)(load = block.load)));
  if (Is(second, "mortar")) {
    PetscCall(Surface(ff, &under, 0, &n, &own));
    PetscCall(PetscFree(own));
    PetscCall(Surface(ff, &block, 1, &nodes, &own));
    PetscCall(FetiFetiAddMortar(ff, 1, 0, Is(wrong, "mortar_tie") ? FETIFETI_EQUALITY : FETIFETI_INEQUALITY, 0, 0, 0,
                                NULL, NULL, NULL));
    if (Is(wrong, "ranks")) {
      PetscMPIInt rank;

      PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
      law[0] += rank;
    }
    PetscCall(FetiFetiSetMortarLaw(ff, Is(wrong, "number") ? 3 : 0, law[0], law[1], law[2], law[3], law[4]));
    n = nodes;
  } else {
    PetscCall(Rows(ff, &block, second[0] ? &under : NULL, &rows, &area));
    PetscCall(Law(ff, rows, area, law));
    PetscCall(PetscFree(area));
    n = rows;
  }
  PetscCall(PetscCalloc5(n, &lambda, dim * n, &force, dim * n, &slip, dim * n, &from, n, &state));
  PetscCall(VecDuplicate(load, &u));
  PetscCall(VecDuplicate(load, &scaled));
  if (Is(wrong, "order")) PetscCall(FetiFetiNextContactStep(ff));
  if (Is(wrong, "mortar_slip")) PetscCall(FetiFetiSetMortarSlip(ff, 0, n + 1, from));
  if (Is(wrong, "dim")) PetscCall(FetiFetiSetContactSlip(ff, rows, 3, NULL));
  if (Is(wrong, "slip")) {
    from[1] = NAN;
    PetscCall(FetiFetiSetContactSlip(ff, rows, dim, from));
  }
  for (step = 0; step < steps; step++) {
    PetscReal drag[3] = {belt, 0, 0};

    Turn(block.turn, drag);
    for (k = 0; k < dim * n; k++) from[k] += slip[k] + drag[k % dim];
    if (own && (belt || manual)) PetscCall(FetiFetiSetMortarSlip(ff, 0, n, from));
    else if (belt || manual) PetscCall(FetiFetiSetContactSlip(ff, rows, dim, from));
    else if (step) PetscCall(FetiFetiNextContactStep(ff));
    PetscCall(VecCopy(load, scaled));
    PetscCall(VecScale(scaled, loads[step]));
    PetscCall(FetiFetiSolve(ff, scaled, u));
    for (k = 0; k < 9; k++) sums[k] = 0;
    if (Is(second, "mortar")) {
      PetscCall(FetiFetiGetMortar(ff, 0, n, lambda, NULL, NULL, state));
      PetscCall(FetiFetiGetMortarFriction(ff, 0, n, force, NULL, slip));
    } else {
      PetscCall(FetiFetiGetMultipliers(ff, n, lambda));
      PetscCall(FetiFetiGetContactFriction(ff, n, dim, force, slip, state));
    }
    for (k = 0; k < n; k++) {
      PetscReal way = 0;

      if (own && (!own[k] || state[k] < 0)) continue;
      sums[0] += lambda[k];
      for (c = 0; c < dim; c++) {
        sums[1 + c] += force[dim * k + c];
        way += PetscSqr(slip[dim * k + c]);
      }
      sums[4 + state[k]]++;
      sums[8] += PetscSqrtReal(way);
    }
    if (view) PetscCall(FetiFetiView(ff, NULL));
    if (second[0]) PetscCall(VecNestGetSubVec(u, 1, &both[1]));
    PetscCall(Print(&block, step, second[0] ? both[1] : u, sums));
  }
  PetscCall(PetscFree(own));
  PetscCall(PetscFree5(lambda, force, slip, from, state));
  PetscCall(VecDestroy(&u));
  PetscCall(VecDestroy(&scaled));
  PetscCall(VecDestroy(&load));
  for (k = second[0] ? 0 : 1; k < 2; k++) {
    Block *one = k ? &block : &under;

    PetscCall(VecDestroy(&one->load));
    PetscCall(MatDestroy(&one->A));
    PetscCall(DMDestroy(&one->da));
  }
  PetscCall(FetiFetiDestroy(&ff));
  PetscCall(PetscFinalize());
  return 0;
}
