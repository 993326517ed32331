/*
   Two blocks of plane elasticity with different meshes in contact: FetiFetiAddMortar() joins them. The upper one is
   pressed on the lower one by a constant load, so the pressure between them is that load everywhere.
     mpicc mortar.c -o mortar $(pkg-config --cflags --libs fetifeti) \
         -Wl,-rpath,$(pkg-config --variable=libdir fetifeti)
     mpirun -n 4 ./mortar -fetifeti_ksp_rtol 1e-12
*/
#include <petscdmda.h>
#include "fetifeti.h"

/* A block of m x n rectangles on [0, 1] x [low, low + 1], lambda = mu = 1, held at its left in x, the lower one at its
   bottom in y. The solver gets its matrix and its side towards the other block. */
static PetscErrorCode Block(FetiFeti ff, PetscInt m, PetscInt n, PetscInt low, Vec *b, PetscInt *nodes)
{
  const PetscInt         x[4] = {0, 1, 1, 0}, y[4] = {0, 0, 1, 1}, *e, *dofs;
  const PetscScalar     *at;
  PetscScalar            k[64], ***load;
  PetscInt               elements, corners, i, j, xs, ys, xm, ym, held = 0, faces = 0, *start, *list;
  DM                     da;
  Mat                    A;
  Vec                    places;
  MatStencil            *rows;
  ISLocalToGlobalMapping map;

  PetscFunctionBeginUser;
  PetscCall(DMDACreate2d(PETSC_COMM_WORLD, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, DMDA_STENCIL_BOX, m + 1, n + 1,
                         PETSC_DECIDE, PETSC_DECIDE, 2, 1, NULL, NULL, &da));
  PetscCall(DMSetMatType(da, MATIS));
  PetscCall(DMSetUp(da));
  PetscCall(DMDASetUniformCoordinates(da, 0, 1, low, low + 1, 0, 0));
  PetscCall(DMCreateMatrix(da, &A));
  for (i = 0; i < 4; i++)
    for (j = 0; j < 4; j++) {
      const PetscReal dx = (x[i] == x[j] ? 1 : -1) * (y[i] == y[j] ? 2 : 1) / 6.0 * m / n;
      const PetscReal dy = (y[i] == y[j] ? 1 : -1) * (x[i] == x[j] ? 2 : 1) / 6.0 * n / m;

      k[16 * i + 2 * j]     = 3 * dx + dy;
      k[16 * i + 2 * j + 9] = dx + 3 * dy;
      k[16 * i + 2 * j + 1] = k[16 * i + 2 * j + 8] = (x[i] == y[j] ? 0.25 : -0.25) + (x[j] == y[i] ? 0.25 : -0.25);
    }
  PetscCall(DMGetCoordinatesLocal(da, &places));
  PetscCall(VecGetArrayRead(places, &at));
  PetscCall(DMDAGetElements(da, &elements, &corners, &e));
  PetscCall(PetscCalloc3(elements + 1, &start, 2 * elements, &list, m + n + 2, &rows));
  for (i = 0; i < elements; i++, e += 4) {
    PetscCall(MatSetValuesBlockedLocal(A, 4, e, 4, e, k, ADD_VALUES));
    if (PetscAbsReal(at[2 * e[low ? 0 : 3] + 1] - 1) > 1e-9) continue;
    list[2 * faces]       = e[low ? 0 : 2]; /* the bottom from left to right, the top from right to left */
    list[2 * faces++ + 1] = e[low ? 1 : 3];
    start[faces]          = 2 * faces;
  }
  for (i = 0; i < 2; i++) PetscCall((i ? MatAssemblyEnd : MatAssemblyBegin)(A, MAT_FINAL_ASSEMBLY));
  PetscCall(DMCreateGlobalVector(da, b));
  PetscCall(DMDAGetCorners(da, &xs, &ys, NULL, &xm, &ym, NULL));
  PetscCall(DMDAVecGetArrayDOF(da, *b, &load));
  for (j = ys; j < ys + ym; j++)
    for (i = xs; i < xs + xm; i++) {
      if (low && j == n) load[j][i][1] = -0.1 / m / (i == 0 || i == m ? 2 : 1);
      if (i == 0) rows[held++] = (MatStencil){0, j, i, 0};
      if (!low && j == 0) rows[held++] = (MatStencil){0, j, i, 1};
    }
  PetscCall(DMDAVecRestoreArrayDOF(da, *b, &load));
  PetscCall(MatZeroRowsColumnsStencil(A, held, rows, 1.0, NULL, NULL));
  PetscCall(FetiFetiAddMatIS(ff, A, NULL, low));
  PetscCall(DMGetLocalToGlobalMapping(da, &map)); /* all nodes of this rank; those of faces count */
  PetscCall(ISLocalToGlobalMappingGetIndices(map, &dofs));
  PetscCall(VecGetLocalSize(places, nodes));
  *nodes /= 2;
  PetscCall(FetiFetiAddSurface(ff, low, 2, 2, *nodes, dofs, at, faces, start, list, NULL));
  PetscCall(ISLocalToGlobalMappingRestoreIndices(map, &dofs));
  PetscCall(VecRestoreArrayRead(places, &at));
  PetscCall(PetscFree3(start, list, rows));
  PetscCall(MatDestroy(&A)); /* its entries have been copied */
  PetscCall(DMDestroy(&da));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  FetiFeti   ff;
  Vec        b[2], load, u;
  PetscInt   k, n[2], *state;
  PetscReal *pressure, error[2] = {0, 0};

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
  for (k = 0; k < 2; k++) PetscCall(Block(ff, k ? 8 : 11, k ? 9 : 7, k, &b[k], &n[k]));
  PetscCall(FetiFetiAddMortar(ff, 0, 1, FETIFETI_INEQUALITY, 0, 0, 0, NULL, NULL, NULL));
  PetscCall(VecCreateNest(PETSC_COMM_WORLD, 2, NULL, b, &load));
  PetscCall(VecDuplicate(load, &u));
  PetscCall(FetiFetiSolve(ff, load, u));
  PetscCall(PetscMalloc2(n[0], &pressure, n[0], &state));
  PetscCall(FetiFetiGetMortar(ff, 0, n[0], NULL, pressure, NULL, state));
  for (k = 0; k < n[0]; k++)
    if (state[k] >= 0) error[0] = PetscMax(error[0], PetscAbsReal(pressure[k] - 0.1));
  PetscCallMPI(MPI_Allreduce(&error[0], &error[1], 1, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "pressure 0.1 but for %.2e\n", (double)error[1]));
  PetscCheck(error[1] < 1e-10, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "not the pressure that was expected");
  PetscCall(PetscFree2(pressure, state));
  for (k = 0; k < 2; k++) PetscCall(VecDestroy(&b[k]));
  PetscCall(VecDestroy(&load));
  PetscCall(VecDestroy(&u));
  PetscCall(FetiFetiDestroy(&ff));
  return PetscFinalize();
}
