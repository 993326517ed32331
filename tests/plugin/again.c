/*
   A KSP whose operator gets other entries, as in Newton's method or in a loop over loads: how long each set-up takes.
   Elasticity on a DMDA in the plane or in space (-dim), -m nodes a side, a MATIS; the modulus differs from element to
   element and from time to time. -times: how many operators.
*/
static char help[] = "How long the second set-up of a solver takes beside the first.\n";

#include <petscksp.h>
#include <petscdmda.h>
#include <petsctime.h>

#define MOST 24

/* lambda = mu = 1 on a cube of bilinear or trilinear functions, by two points in each direction. The corners of a face
   follow each other around, as DMDAGetElements has them. */
static void Stiffness(PetscInt dim, PetscScalar k[MOST * MOST])
{
  const PetscReal s[3][8] = {{-1, 1, 1, -1, -1, 1, 1, -1}, {-1, -1, 1, 1, -1, -1, 1, 1}, {-1, -1, -1, -1, 1, 1, 1, 1}};
  PetscInt        corners = 1 << dim, n = dim * corners, q, a, b, c, d, e;

  for (a = 0; a < n * n; a++) k[a] = 0;
  for (q = 0; q < corners; q++) {
    PetscReal g[8][3];

    for (a = 0; a < corners; a++)
      for (c = 0; c < dim; c++) {
        g[a][c] = s[c][a];
        for (d = 0; d < dim; d++) g[a][c] *= (d == c ? 1 : 1 + s[d][a] * s[d][q] / PetscSqrtReal(3.0)) / 2;
      }
    for (a = 0; a < corners; a++)
      for (b = 0; b < corners; b++)
        for (c = 0; c < dim; c++)
          for (d = 0; d < dim; d++) {
            PetscReal v = g[a][c] * g[b][d] + g[a][d] * g[b][c];

            for (e = 0; e < dim && c == d; e++) v += g[a][e] * g[b][e];
            k[(dim * a + c) * n + dim * b + d] += v;
          }
  }
}

/* The operator at this time. */
static PetscErrorCode Assemble(DM da, PetscInt dim, PetscInt time, IS held, Mat A)
{
  PetscScalar     unit[MOST * MOST], k[MOST * MOST];
  const PetscInt *nodes;
  PetscInt        n, corners, e, a;

  PetscFunctionBeginUser;
  Stiffness(dim, unit);
  PetscCall(MatZeroEntries(A));
  PetscCall(DMDAGetElements(da, &n, &corners, &nodes));
  for (e = 0; e < n; e++) {
    const PetscReal modulus = 2 + PetscSinReal(e * (1 + 0.1 * time));
    PetscInt        dofs[MOST];

    for (a = 0; a < dim * corners; a++) dofs[a] = dim * nodes[corners * e + a / dim] + a % dim;
    for (a = 0; a < dim * corners * dim * corners; a++) k[a] = modulus * unit[a];
    PetscCall(MatSetValuesLocal(A, dim * corners, dofs, dim * corners, dofs, k, ADD_VALUES));
  }
  PetscCall(DMDARestoreElements(da, &n, &corners, &nodes));
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatZeroRowsColumnsIS(A, held, 1.0, NULL, NULL));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscInt           dim = 2, m = 9, times = 3, first, last, i, side;
  PetscMPIInt        rank;
  PetscReal          norm, size;
  PetscLogDouble     begin, end, seconds = 0;
  DM                 da;
  Mat                A;
  Vec                b, x, r, places;
  AO                 ao;
  IS                 held;
  KSP                ksp;
  MatNullSpace       motions;
  KSPConvergedReason reason;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-dim", &dim, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-m", &m, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-times", &times, NULL));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(DMDACreate(PETSC_COMM_WORLD, &da));
  PetscCall(DMSetDimension(da, dim));
  PetscCall(DMDASetSizes(da, m, m, dim == 3 ? m : 1));
  PetscCall(DMDASetDof(da, dim));
  PetscCall(DMDASetStencilType(da, DMDA_STENCIL_BOX));
  PetscCall(DMDASetStencilWidth(da, 1));
  PetscCall(DMSetMatType(da, MATIS));
  PetscCall(DMSetFromOptions(da));
  PetscCall(DMSetUp(da));
  PetscCall(DMDASetElementType(da, DMDA_ELEMENT_Q1));
  PetscCall(DMDASetUniformCoordinates(da, 0, 1, 0, 1, 0, 1));
  PetscCall(DMCreateMatrix(da, &A));
  PetscCall(DMGetCoordinates(da, &places));
  PetscCall(MatNullSpaceCreateRigidBody(places, &motions));
  PetscCall(MatSetNearNullSpace(A, motions));
  PetscCall(MatNullSpaceDestroy(&motions));
  /* the lower side is held */
  side = dim * m * (dim == 3 ? m : 1);
  PetscCall(ISCreateStride(PETSC_COMM_WORLD, rank ? 0 : side, 0, 1, &held));
  PetscCall(DMDAGetAO(da, &ao));
  PetscCall(AOApplicationToPetscIS(ao, held));
  PetscCall(DMCreateGlobalVector(da, &b));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(VecDuplicate(b, &r));
  PetscCall(VecGetOwnershipRange(b, &first, &last));
  for (i = first; i < last; i++) PetscCall(VecSetValue(b, i, PetscSinReal(1 + 0.37 * i), INSERT_VALUES));
  PetscCall(VecAssemblyBegin(b));
  PetscCall(VecAssemblyEnd(b));
  PetscCall(VecNorm(b, NORM_2, &size));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetFromOptions(ksp));
  for (i = 0; i < times; i++) {
    PetscCall(Assemble(da, dim, i, held, A));
    PetscCall(KSPSetOperators(ksp, A, A));
    PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
    PetscCall(PetscTime(&begin));
    PetscCall(KSPSetUp(ksp));
    PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
    PetscCall(PetscTime(&end));
    if (i == 0) seconds = end - begin;
    PetscCall(KSPSolve(ksp, b, x));
    PetscCall(KSPGetConvergedReason(ksp, &reason));
    PetscCall(MatMult(A, x, r));
    PetscCall(VecAXPY(r, -1.0, b));
    PetscCall(VecNorm(r, NORM_2, &norm));
    PetscCheck(reason > 0 && norm < 1e-4 * size, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "%s, residual %g of %g",
               KSPConvergedReasons[reason], (double)norm, (double)size);
    PetscCall(KSPGetTotalIterations(ksp, &last));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "set-up %d: %.2f s, %.2f of the first; %d iterations so far\n", (int)i + 1,
                          end - begin, (end - begin) / seconds, (int)last));
  }
  PetscCall(VecGetSize(b, &last));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%d unknowns\n", (int)last));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(ISDestroy(&held));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&r));
  PetscCall(MatDestroy(&A));
  PetscCall(DMDestroy(&da));
  PetscCall(PetscFinalize());
  return 0;
}
