/* Two squares of one subdomain each, joined by FetiFetiAddMortar(); -wrong does one thing wrong. Every rank gives all
   faces and nodes, the first one all matrices. */
static const char help[] = "Mistakes with mortars.\n";

#include <math.h>
#include <petscksp.h>
#include "fetifeti.h"

static char wrong[20] = "";

static PetscBool Is(const char what[])
{
  PetscBool same;

  PetscCallAbort(PETSC_COMM_SELF, PetscStrcmp(wrong, what, &same));
  return same;
}

int main(int argc, char **argv)
{
  /* -u'' on a square of one element; nodes from left to right, the lower ones first */
  const PetscInt    ia[5] = {0, 4, 8, 12, 16}, ja[16] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
  const PetscScalar a[16] = {4, -1, -1, -2, -1, 4, -2, -1, -1, -2, 4, -1, -2, -1, -1, 4};
  PetscInt          dofs[2][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}}, first[2] = {3, 2}, second[2] = {0, 1};
  PetscReal         at[2][8] = {{0, 0, 1, 0, 0, 1, 1, 1}, {0, 1, 1, 1, 0, 2, 1, 2}}, gaps[4] = {0, 0, 0, 0};
  PetscInt          start[2] = {0, 2}, held[6] = {0, 1, 2, 3, 6, 7}, without[4] = {0, 0, 0, 0}, k, n[2] = {-1, -1};
  PetscInt          m = -1;
  PetscReal         lambda[4], pressure[4], gap[4], flat[12] = {0};
  PetscInt          state[4];
  PetscMPIInt       rank;
  FetiFeti          ff;
  IS                is;
  Vec               values, b, x;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-wrong", wrong, sizeof(wrong), NULL));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
  PetscCall(FetiFetiSetFromOptions(ff));
  PetscCall(FetiFetiSetSizes(ff, PETSC_DECIDE, 8));
  for (k = 0; k < 2 && !rank; k++) PetscCall(FetiFetiAddSubdomain(ff, k, 4, ia, ja, a, dofs[k]));
  if (Is("node")) first[rank] = 4;
  if (Is("twice")) first[0] = 2;
  if (Is("dof")) dofs[0][2] = 77;
  if (Is("place")) at[0][4] += 0.5 * rank;
  if (Is("finite")) at[0][4] = NAN;
  if (Is("turned")) { second[0] = 1; second[1] = 0; }
  if (Is("both")) { second[0] = 1; second[1] = 0; first[0] = 2; first[1] = 3; at[1][1] = at[1][3] = 2.5; }
  if (Is("away")) at[1][1] = at[1][3] = 30;
  if (Is("half")) at[1][1] = at[1][3] = -4;
  if (Is("beside")) at[1][0] = at[1][4] = 3, at[1][2] = at[1][6] = 4;
  if (Is("flat")) PetscCall(FetiFetiAddSurface(ff, PETSC_DECIDE, 3, 1, 4, dofs[1], flat, 1, start, second, NULL));
  if (Is("components")) PetscCall(FetiFetiAddSurface(ff, PETSC_DECIDE, 2, 3, 1, dofs[0], at[0], 0, NULL, NULL, NULL));
  if (Is("dimension")) PetscCall(FetiFetiAddSurface(ff, PETSC_DECIDE, 4, 1, 1, dofs[0], at[0], 0, NULL, NULL, NULL));
  if (Is("falls")) start[1] = -1;
  if (Is("ways")) {
    const PetscInt starts[3] = {0, 2, 4}, list[4] = {3, 2, 0, 2};

    PetscCall(FetiFetiAddSurface(ff, PETSC_DECIDE, 2, 1, 4, dofs[0], at[0], 2, starts, list, NULL));
  }
  PetscCall(FetiFetiAddSurface(ff, Is("matrix") ? 3 : PETSC_DECIDE, 2, 1, 4, dofs[0], at[0], Is("none") ? 0 : 1, start,
                               first, &n[0]));
  PetscCall(FetiFetiAddSurface(ff, PETSC_DECIDE, 2, 1, 4, dofs[1], at[1], 1, start, second, &n[1]));
  PetscCheck(n[0] == 0 && n[1] == 1, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "the surfaces are %d and %d", (int)n[0],
             (int)n[1]);
  if (Is("surface")) n[1] = 7;
  if (Is("same")) n[1] = 0;
  if (Is("gap")) gaps[2] = NAN;
  if (Is("differ")) gaps[2] = rank;
  if (Is("ranks")) m = rank;
  if (Is("without")) without[2] = without[3] = 1;
  PetscCall(FetiFetiAddMortar(ff, n[0], n[1], Is("kind") ? 5 : FETIFETI_INEQUALITY, 0, 0, Is("ranks") ? m : 0, gaps,
                              without, &m));
  PetscCheck(m == 0, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "the mortar is %d", (int)m);
  PetscCall(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, 8, &b));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(VecDuplicate(b, &values));
  for (k = 6; k < 8 && !rank; k++) PetscCall(VecSetValue(values, k, -1, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(values));
  PetscCall(VecAssemblyEnd(values));
  if (!Is("held")) held[2] = held[3] = 0;
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, rank ? 0 : 6, held, PETSC_COPY_VALUES, &is));
  PetscCall(FetiFetiSetDirichletBoundaries(ff, is, values));
  if (Is("order")) PetscCall(FetiFetiGetMortar(ff, 0, 4, lambda, pressure, gap, state));
  PetscCall(FetiFetiSolve(ff, b, x));
  PetscCall(FetiFetiGetMortar(ff, Is("number") ? 1 : 0, Is("room") ? 3 : 4, lambda, pressure, gap, state));
  for (k = 0; k < 2; k++) { /* u falls from 0 to -1 through both: the flux between them is 1/2 */
    PetscCheck(state[k] == -1 && lambda[k] == 0 && gap[k] == PETSC_INFINITY, PETSC_COMM_SELF, PETSC_ERR_PLIB,
               "node %d carries a multiplier", (int)k);
    PetscCheck(state[k + 2] == 1 && PetscAbsReal(lambda[k + 2] - 0.25 * 6) < 1e-7 &&
                 PetscAbsReal(pressure[k + 2] - 0.5 * 6) < 1e-7,
               PETSC_COMM_SELF, PETSC_ERR_PLIB, "a multiplier of %g and a pressure of %g", (double)lambda[k + 2],
               (double)pressure[k + 2]);
  }
  PetscCall(FetiFetiGetMultipliers(ff, 0, NULL));
  PetscCall(FetiFetiView(ff, NULL));
  PetscCall(FetiFetiResetMortar(ff));
  if (Is("reset")) PetscCall(FetiFetiGetMortar(ff, 0, 4, lambda, pressure, gap, state));
  PetscCall(FetiFetiSolve(ff, b, x)); /* apart now */
  PetscCall(VecNorm(x, NORM_1, pressure));
  PetscCheck(PetscAbsReal(pressure[0] - 4) < 1e-7, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "without a mortar %g",
             (double)pressure[0]);
  PetscCall(ISDestroy(&is));
  PetscCall(VecDestroy(&values));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(FetiFetiDestroy(&ff));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "ok\n"));
  return PetscFinalize();
}
