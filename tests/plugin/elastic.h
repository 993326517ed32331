/* A block of plane elasticity on a DMDA, for test programs. */
#include <petscdmda.h>

/* Plane strain or so: lambda = mu = 1 on a square of bilinear functions, by two points in each direction. */
static void Stiffness(PetscScalar k[64])
{
  const PetscReal sx[4] = {-1, 1, 1, -1}, sy[4] = {-1, -1, 1, 1};
  PetscInt        q, i, j;

  for (i = 0; i < 64; i++) k[i] = 0;
  for (q = 0; q < 4; q++) {
    PetscReal g[4][2];

    for (i = 0; i < 4; i++) {
      g[i][0] = sx[i] * (1 + sy[i] * sy[q] / PetscSqrtReal(3.0)) / 4;
      g[i][1] = sy[i] * (1 + sx[i] * sx[q] / PetscSqrtReal(3.0)) / 4;
    }
    for (i = 0; i < 8; i++)
      for (j = 0; j < 8; j++) {
        const PetscReal *a = g[i / 2], *b = g[j / 2];
        const PetscInt   c = i % 2, d = j % 2;

        k[8 * i + j] += a[c] * b[d] + a[d] * b[c] + (c == d ? a[0] * b[0] + a[1] * b[1] : 0);
      }
  }
}

/* m x m nodes, the bottom held where that is wanted; a load that is nowhere zero. */
static PetscErrorCode BlockOn(MPI_Comm comm, PetscInt m, PetscBool hold, PetscBool near, DM *da, Mat *A, Vec *b)
{
  PetscScalar     ke[64];
  const PetscInt *e;
  PetscInt        n, nodes, i, k, first, last;
  AO              ao;
  IS              low;
  Vec             places;
  MatNullSpace    motions;

  PetscFunctionBeginUser;
  PetscCall(DMDACreate2d(comm, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, DMDA_STENCIL_BOX, m, m, PETSC_DECIDE, PETSC_DECIDE,
                         2, 1, NULL, NULL, da));
  PetscCall(DMSetMatType(*da, MATIS));
  PetscCall(DMSetUp(*da));
  PetscCall(DMDASetElementType(*da, DMDA_ELEMENT_Q1));
  PetscCall(DMDASetUniformCoordinates(*da, 0, 1, 0, 1, 0, 0));
  PetscCall(DMCreateMatrix(*da, A));
  Stiffness(ke);
  PetscCall(DMDAGetElements(*da, &n, &nodes, &e));
  for (i = 0; i < n; i++) {
    PetscInt dofs[8];

    for (k = 0; k < 8; k++) dofs[k] = 2 * e[4 * i + k / 2] + k % 2;
    PetscCall(MatSetValuesLocal(*A, 8, dofs, 8, dofs, ke, ADD_VALUES));
  }
  PetscCall(DMDARestoreElements(*da, &n, &nodes, &e));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  if (near) {
    PetscCall(DMGetCoordinates(*da, &places));
    PetscCall(MatNullSpaceCreateRigidBody(places, &motions));
    PetscCall(MatSetNearNullSpace(*A, motions));
    PetscCall(MatNullSpaceDestroy(&motions));
  }
  PetscCall(DMCreateGlobalVector(*da, b));
  PetscCall(VecGetOwnershipRange(*b, &first, &last));
  for (i = first; i < last; i++) PetscCall(VecSetValue(*b, i, PetscSinReal(1 + 0.37 * i) / m, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(*b));
  PetscCall(VecAssemblyEnd(*b));
  if (hold) {
    PetscCall(DMDAGetAO(*da, &ao));
    for (k = 0; k < 2; k++) {
      PetscCall(ISCreateStride(comm, first ? 0 : m, k, 2, &low));
      PetscCall(AOApplicationToPetscIS(ao, low));
      PetscCall(MatZeroRowsColumnsIS(*A, low, 1.0, NULL, NULL));
      PetscCall(ISDestroy(&low));
    }
  }
  PetscFunctionReturn(0);
}

static inline PetscErrorCode Block(PetscInt m, PetscBool hold, PetscBool near, DM *da, Mat *A, Vec *b)
{
  return BlockOn(PETSC_COMM_WORLD, m, hold, near, da, A, b);
}
