/* A block of squares or cubes of an isotropic elastic material on a DMDA, which may be turned, for test programs. */
#include <petscdmda.h>
#include "fetifeti.h"

#define MOST 24

typedef struct {
  PetscInt  dim, cells[3];
  PetscReal edge, low[2], young, poisson, top[3], turn; /* top: the traction on the upper side */
  DM        da;
  Mat       A;
  Vec       load;
} Block;

/* A vector, turned with the block. */
static void Turn(PetscReal angle, PetscScalar v[])
{
  const PetscReal c = PetscCosReal(angle), s = PetscSinReal(angle), x = v[0];

  v[0] = c * x - s * v[1];
  v[1] = s * x + c * v[1];
}

/* Plane strain or space: two points in each direction. The corners of a face follow each other around. */
static void Stiffness(const Block *block, PetscScalar k[MOST * MOST])
{
  const PetscReal s[3][8] = {{-1, 1, 1, -1, -1, 1, 1, -1}, {-1, -1, 1, 1, -1, -1, 1, 1}, {-1, -1, -1, -1, 1, 1, 1, 1}};
  const PetscReal nu = block->poisson, mu = block->young / 2 / (1 + nu), lambda = 2 * mu * nu / (1 - 2 * nu);
  const PetscInt  dim = block->dim, corners = 1 << dim, n = dim * corners;
  PetscInt        q, a, b, c, d, e;

  for (a = 0; a < n * n; a++) k[a] = 0;
  for (q = 0; q < corners; q++) {
    const PetscReal weight = PetscPowRealInt(block->edge / 2, dim);
    PetscReal       g[8][3];

    for (a = 0; a < corners; a++)
      for (c = 0; c < dim; c++) {
        g[a][c] = s[c][a] / block->edge;
        for (d = 0; d < dim; d++)
          if (d != c) g[a][c] *= (1 + s[d][a] * s[d][q] / PetscSqrtReal(3.0)) / 2;
      }
    for (a = 0; a < corners; a++)
      for (b = 0; b < corners; b++)
        for (c = 0; c < dim; c++)
          for (d = 0; d < dim; d++) {
            PetscReal v = lambda * g[a][c] * g[b][d] + mu * g[a][d] * g[b][c];

            for (e = 0; e < dim && c == d; e++) v += mu * g[a][e] * g[b][e];
            k[(dim * a + c) * n + dim * b + d] += weight * v;
          }
  }
  /* columns, then rows, are turned: the matrix is symmetric in between */
  for (a = 0; a < 2; a++) {
    PetscScalar t[MOST * MOST];

    for (b = 0; b < n; b++)
      for (c = 0; c < n; c++) t[b * n + c] = k[c * n + b];
    for (b = 0; b < n * n; b += dim) Turn(block->turn, t + b);
    for (b = 0; b < n * n; b++) k[b] = t[b];
  }
}

/* Number of a node by its place in the grid. */
static PetscInt Node(const Block *block, PetscInt i, PetscInt j, PetscInt k)
{
  return i + (block->cells[0] + 1) * (j + (block->cells[1] + 1) * k);
}

/* The area of a node of the lower or upper side: its part of the faces there. */
static PetscReal Area(const Block *block, PetscInt i, PetscInt k)
{
  PetscReal area = block->edge * (i == 0 || i == block->cells[0] ? 0.5 : 1);

  if (block->dim == 3) area *= block->edge * (k == 0 || k == block->cells[2] ? 0.5 : 1);
  return area;
}

/* The numbers of component c of a side's nodes in its matrix: side 0 is the lower one, 1 the upper one. */
static PetscErrorCode Side(const Block *block, PetscInt side, PetscInt c, PetscInt **numbers, PetscInt *n)
{
  PetscInt i, k, depth = block->dim == 3 ? block->cells[2] + 1 : 1;
  AO       ao;

  PetscFunctionBeginUser;
  *n = 0;
  PetscCall(PetscMalloc1((block->cells[0] + 1) * depth, numbers));
  for (k = 0; k < depth; k++)
    for (i = 0; i <= block->cells[0]; i++)
      (*numbers)[(*n)++] = block->dim * Node(block, i, side ? block->cells[1] : 0, k) + c;
  PetscCall(DMDAGetAO(block->da, &ao));
  PetscCall(AOApplicationToPetsc(ao, *n, *numbers));
  PetscFunctionReturn(0);
}

static PetscErrorCode Make(Block *block)
{
  PetscScalar     ke[MOST * MOST], *at;
  const PetscInt  dim = block->dim, *e, depth = dim == 3 ? block->cells[2] + 1 : 1;
  PetscInt        elements, corners, i, k, c, dofs[MOST], n, *side;
  Vec             places;
  MatNullSpace    motions;
  PetscMPIInt     rank;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(DMDACreate(PETSC_COMM_WORLD, &block->da));
  PetscCall(DMSetDimension(block->da, dim));
  PetscCall(DMDASetSizes(block->da, block->cells[0] + 1, block->cells[1] + 1, depth));
  PetscCall(DMDASetDof(block->da, dim));
  PetscCall(DMDASetStencilType(block->da, DMDA_STENCIL_BOX));
  PetscCall(DMDASetStencilWidth(block->da, 1));
  PetscCall(DMSetMatType(block->da, MATIS));
  PetscCall(DMSetUp(block->da));
  PetscCall(DMDASetElementType(block->da, DMDA_ELEMENT_Q1));
  PetscCall(DMDASetUniformCoordinates(block->da, block->low[0], block->low[0] + block->edge * block->cells[0],
                                      block->low[1], block->low[1] + block->edge * block->cells[1], 0,
                                      block->edge * block->cells[2]));
  PetscCall(DMGetCoordinates(block->da, &places));
  PetscCall(VecGetLocalSize(places, &n));
  PetscCall(VecGetArray(places, &at));
  for (i = 0; i < n; i += dim) Turn(block->turn, at + i);
  PetscCall(VecRestoreArray(places, &at));
  PetscCall(DMCreateMatrix(block->da, &block->A));
  Stiffness(block, ke);
  PetscCall(DMDAGetElements(block->da, &elements, &corners, &e));
  for (i = 0; i < elements; i++) {
    for (c = 0; c < dim * corners; c++) dofs[c] = dim * e[corners * i + c / dim] + c % dim;
    PetscCall(MatSetValuesLocal(block->A, dim * corners, dofs, dim * corners, dofs, ke, ADD_VALUES));
  }
  PetscCall(DMDARestoreElements(block->da, &elements, &corners, &e));
  for (i = 0; i < 2; i++) PetscCall((i ? MatAssemblyEnd : MatAssemblyBegin)(block->A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatNullSpaceCreateRigidBody(places, &motions));
  PetscCall(MatSetNearNullSpace(block->A, motions));
  PetscCall(MatNullSpaceDestroy(&motions));
  PetscCall(DMCreateGlobalVector(block->da, &block->load));
  for (c = 0; c < dim; c++) {
    PetscReal top[3] = {block->top[0], block->top[1], block->top[2]};

    Turn(block->turn, top);
    PetscCall(Side(block, 1, c, &side, &n));
    for (k = 0; k < depth && !rank; k++)
      for (i = 0; i <= block->cells[0]; i++)
        PetscCall(VecSetValue(block->load, side[i + (block->cells[0] + 1) * k], top[c] * Area(block, i, k),
                              INSERT_VALUES));
    PetscCall(PetscFree(side));
  }
  PetscCall(VecAssemblyBegin(block->load));
  PetscCall(VecAssemblyEnd(block->load));
  PetscFunctionReturn(0);
}

/* Holds component c of a side. */
static PetscErrorCode Hold(Block *block, PetscInt side, PetscInt c)
{
  PetscInt   *numbers, n;
  PetscMPIInt rank;
  IS          is;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(Side(block, side, c, &numbers, &n));
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, rank ? 0 : n, numbers, PETSC_COPY_VALUES, &is));
  PetscCall(MatZeroRowsColumnsIS(block->A, is, 1.0, NULL, NULL));
  PetscCall(ISDestroy(&is));
  PetscCall(PetscFree(numbers));
  PetscFunctionReturn(0);
}

/* Its side towards the other block; `own`: the nodes of which this rank owns the unknowns. */
static PetscErrorCode Surface(FetiFeti ff, const Block *block, PetscInt matrix, PetscInt *nodes, PetscBool **own)
{
  const PetscInt         of[2][2][4] = {{{0, 1}, {2, 3}}, {{0, 1, 5, 4}, {2, 3, 7, 6}}};
  const PetscInt         dim = block->dim, up = !matrix, *e, *dofs;
  const PetscScalar     *at;
  const PetscReal        y = block->low[1] + (up ? block->edge * block->cells[1] : 0);
  PetscInt               elements, corners, i, k, faces = 0, each = dim == 2 ? 2 : 4, first, last, *start, *list;
  Vec                    places;
  ISLocalToGlobalMapping map;

  PetscFunctionBeginUser;
  PetscCall(DMGetCoordinatesLocal(block->da, &places));
  PetscCall(VecGetArrayRead(places, &at));
  PetscCall(DMDAGetElements(block->da, &elements, &corners, &e));
  PetscCall(PetscMalloc2(elements + 1, &start, each * elements, &list));
  start[0] = 0;
  for (i = 0; i < elements; i++, e += corners) {
    const PetscInt *face = of[dim - 2][up];
    PetscReal       p[2] = {at[dim * e[face[0]]], at[dim * e[face[0]] + 1]};

    Turn(-block->turn, p);
    if (PetscAbsReal(p[1] - y) > 1e-9) continue;
    for (k = 0; k < each; k++) list[each * faces + k] = e[face[k]];
    faces++;
    start[faces] = each * faces;
  }
  PetscCall(DMGetLocalToGlobalMapping(block->da, &map));
  PetscCall(ISLocalToGlobalMappingGetIndices(map, &dofs));
  PetscCall(VecGetLocalSize(places, nodes));
  *nodes /= dim;
  PetscCall(VecGetOwnershipRange(block->load, &first, &last));
  PetscCall(PetscMalloc1(*nodes, own));
  for (i = 0; i < *nodes; i++) (*own)[i] = (PetscBool)(first <= dofs[dim * i] && dofs[dim * i] < last);
  PetscCall(FetiFetiAddSurface(ff, matrix, dim, dim, *nodes, dofs, at, faces, start, list, NULL));
  PetscCall(ISLocalToGlobalMappingRestoreIndices(map, &dofs));
  PetscCall(VecRestoreArrayRead(places, &at));
  PetscCall(PetscFree2(start, list));
  PetscFunctionReturn(0);
}
