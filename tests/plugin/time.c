/*
   A block that creeps, by a TS with any implicit method: m du/dt + (1 + t) K u + m u^3 = f, K of elasticity on a DMDA
   (elastic.h), m a lumped mass. The Jacobian has other entries on the same pattern in each step. The solver of the
   options is held against PETSc's LU in all steps.
*/
static char help[] = "Time steps with a KSP of any type.\n";

#include <petscts.h>
#include "elastic.h"

typedef struct {
  Mat      K; /* nothing is held */
  Vec      f, mass; /* no mass where the block is held */
  IS       held;
  PetscInt m, jacobians;
} Problem;

/* Lumped masses of the nodes; the lower side is held. */
static PetscErrorCode Masses(DM da, Problem *p)
{
  const PetscReal area = 1 / PetscSqr(p->m - 1.0);
  PetscInt        x, y, nx, ny, i, j, c, at, *held, n = 0;

  PetscFunctionBeginUser;
  PetscCall(VecDuplicate(p->f, &p->mass));
  PetscCall(VecGetOwnershipRange(p->f, &at, NULL));
  PetscCall(DMDAGetCorners(da, &x, &y, NULL, &nx, &ny, NULL));
  PetscCall(PetscMalloc1(2 * nx, &held));
  for (j = y; j < y + ny; j++)
    for (i = x; i < x + nx; i++)
      for (c = 0; c < 2; c++, at++) {
        PetscReal mass = area * (i % (p->m - 1) ? 1 : 0.5) * (j % (p->m - 1) ? 1 : 0.5);

        if (j == 0) held[n++] = at;
        PetscCall(VecSetValue(p->mass, at, j ? mass : 0, INSERT_VALUES));
      }
  PetscCall(VecAssemblyBegin(p->mass));
  PetscCall(VecAssemblyEnd(p->mass));
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, n, held, PETSC_OWN_POINTER, &p->held));
  PetscFunctionReturn(0);
}

/* F = m du/dt + (1 + t) K u + m u^3 - f, and u where it is held */
static PetscErrorCode Function(TS ts, PetscReal t, Vec u, Vec du, Vec F, void *ctx)
{
  Problem            *p = (Problem *)ctx;
  const PetscScalar *x, *dx, *f, *mass;
  PetscScalar       *y;
  PetscInt           n, i;

  PetscFunctionBeginUser;
  PetscCall(MatMult(p->K, u, F));
  PetscCall(VecGetLocalSize(u, &n));
  PetscCall(VecGetArrayRead(u, &x));
  PetscCall(VecGetArrayRead(du, &dx));
  PetscCall(VecGetArrayRead(p->f, &f));
  PetscCall(VecGetArrayRead(p->mass, &mass));
  PetscCall(VecGetArray(F, &y));
  for (i = 0; i < n; i++)
    y[i] = mass[i] > 0 ? mass[i] * (dx[i] + x[i] * x[i] * x[i]) + (1 + t) * y[i] - f[i] : x[i];
  PetscCall(VecRestoreArray(F, &y));
  PetscCall(VecRestoreArrayRead(p->mass, &mass));
  PetscCall(VecRestoreArrayRead(p->f, &f));
  PetscCall(VecRestoreArrayRead(du, &dx));
  PetscCall(VecRestoreArrayRead(u, &x));
  PetscFunctionReturn(0);
}

/* J = (1 + t) K + m (shift + 3 u^2), element by element */
static PetscErrorCode Jacobian(TS ts, PetscReal t, Vec u, Vec du, PetscReal shift, Mat J, Mat P, void *ctx)
{
  Problem            *p = (Problem *)ctx;
  PetscScalar        ke[64], k[64];
  const PetscScalar *x;
  const PetscInt    *e;
  PetscReal          mass = 0.25 / PetscSqr(p->m - 1.0);
  PetscInt           n, nodes, i, a;
  DM                 da;
  Vec                local;

  PetscFunctionBeginUser;
  p->jacobians++;
  PetscCall(TSGetDM(ts, &da));
  PetscCall(DMGetLocalVector(da, &local));
  PetscCall(DMGlobalToLocal(da, u, INSERT_VALUES, local));
  PetscCall(VecGetArrayRead(local, &x));
  PetscCall(MatZeroEntries(P));
  Stiffness(ke);
  PetscCall(DMDAGetElements(da, &n, &nodes, &e));
  for (i = 0; i < n; i++) {
    PetscInt dofs[8];

    for (a = 0; a < 8; a++) dofs[a] = 2 * e[4 * i + a / 2] + a % 2;
    for (a = 0; a < 64; a++) k[a] = (1 + t) * ke[a];
    for (a = 0; a < 8; a++) k[9 * a] += mass * (shift + 3 * PetscSqr(x[dofs[a]]));
    PetscCall(MatSetValuesLocal(P, 8, dofs, 8, dofs, k, ADD_VALUES));
  }
  PetscCall(DMDARestoreElements(da, &n, &nodes, &e));
  PetscCall(VecRestoreArrayRead(local, &x));
  PetscCall(DMRestoreLocalVector(da, &local));
  PetscCall(MatAssemblyBegin(P, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(P, MAT_FINAL_ASSEMBLY));
  PetscCall(MatZeroRowsColumnsIS(P, p->held, 1.0, NULL, NULL));
  PetscFunctionReturn(0);
}

/* From u = 0 at t = 0 to t = 0.5; by LU if that is wanted, else as the options say. */
static PetscErrorCode March(Problem *p, DM da, PetscBool direct, Vec u)
{
  TS           ts;
  SNES         snes;
  KSP          ksp;
  PC           pc;
  Mat          J;
  MatNullSpace motions;
  PetscInt     steps;

  PetscFunctionBeginUser;
  p->jacobians = 0;
  PetscCall(DMSetMatType(da, direct ? MATAIJ : MATIS));
  PetscCall(DMCreateMatrix(da, &J));
  PetscCall(MatGetNearNullSpace(p->K, &motions));
  PetscCall(MatSetNearNullSpace(J, motions));
  PetscCall(TSCreate(PETSC_COMM_WORLD, &ts));
  PetscCall(TSSetDM(ts, da));
  PetscCall(TSSetIFunction(ts, NULL, Function, p));
  PetscCall(TSSetIJacobian(ts, J, J, Jacobian, p));
  PetscCall(TSSetTimeStep(ts, 0.1));
  PetscCall(TSSetMaxTime(ts, 0.5));
  PetscCall(TSSetExactFinalTime(ts, TS_EXACTFINALTIME_MATCHSTEP));
  PetscCall(TSGetSNES(ts, &snes));
  PetscCall(SNESSetTolerances(snes, 1e-14, 1e-10, 0, 50, 1000));
  PetscCall(SNESGetKSP(snes, &ksp));
  PetscCall(KSPSetTolerances(ksp, 1e-10, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(TSSetFromOptions(ts));
  if (direct) {
    PetscCall(KSPSetType(ksp, KSPPREONLY));
    PetscCall(KSPGetPC(ksp, &pc));
    PetscCall(PCSetType(pc, PCREDUNDANT));
  }
  PetscCall(VecSet(u, 0));
  PetscCall(TSSolve(ts, u));
  PetscCall(TSGetStepNumber(ts, &steps));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%d steps, %d Jacobians\n", (int)steps, (int)p->jacobians));
  if (!direct) PetscCall(KSPView(ksp, PETSC_VIEWER_STDOUT_WORLD));
  PetscCall(MatDestroy(&J));
  PetscCall(TSDestroy(&ts));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Problem   p;
  DM        da;
  Vec       u, exact;
  PetscReal error, size;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  p.m = 9;
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-m", &p.m, NULL));
  PetscCall(BlockOn(PETSC_COMM_WORLD, p.m, PETSC_FALSE, PETSC_TRUE, &da, &p.K, &p.f));
  PetscCall(Masses(da, &p));
  PetscCall(VecDuplicate(p.f, &u));
  PetscCall(VecDuplicate(p.f, &exact));
  PetscCall(VecScale(p.f, 20));
  PetscCall(March(&p, da, PETSC_TRUE, exact));
  PetscCall(March(&p, da, PETSC_FALSE, u));
  PetscCall(VecNorm(exact, NORM_INFINITY, &size));
  PetscCall(VecAXPY(u, -1, exact));
  PetscCall(VecNorm(u, NORM_INFINITY, &error));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "largest %g, error %g\n", (double)size, (double)(error / size)));
  PetscCall(VecDestroy(&u));
  PetscCall(VecDestroy(&exact));
  PetscCall(VecDestroy(&p.mass));
  PetscCall(VecDestroy(&p.f));
  PetscCall(ISDestroy(&p.held));
  PetscCall(MatDestroy(&p.K));
  PetscCall(DMDestroy(&da));
  PetscCall(PetscFinalize());
  return 0;
}
