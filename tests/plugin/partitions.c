/*
   Random partitions of random simplicial meshes: subdomains that hang together by an edge or a node, fragments,
   whatever a partitioner makes. Each case is solved by FETI-FETI and by a direct solver; the program prints a line for
   each, and "ok" if none was refused and all solutions are as close as -near says.
*/
static char help[] = "Solves on random partitions of random meshes, and compares with a direct solver.\n";

#include "simplices.h"
#include "direct.h"
#include "fetifeti.h"

typedef struct {
  int        dim, components, parts, motions;
  int        kept; /* unknowns of the clamped side are there, and held */
  const char *how;
} Case;

/* The unknowns: nodes off the plane x = 0, where the body is clamped; -1 there unless they are kept. */
static PetscErrorCode Number(const Mesh *mesh, const Case *k, int **number, int *free)
{
  int node;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(mesh->nodes, number));
  for (*free = node = 0; node < mesh->nodes; node++)
    (*number)[node] = mesh->x[3 * node] > 0 || k->kept ? (*free)++ : -1;
  PetscFunctionReturn(0);
}

/* The unknowns that are kept and held, in the order of the nodes. */
static PetscErrorCode Held(const Mesh *mesh, const Case *k, const int *number, IS *held)
{
  PetscInt *dofs, n = 0;
  int       node, c;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1(mesh->nodes * k->components, &dofs));
  for (node = 0; node < mesh->nodes && k->kept; node++)
    for (c = 0; c < k->components; c++)
      if (!(mesh->x[3 * node] > 0)) dofs[n++] = number[node] * k->components + c;
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, n, dofs, PETSC_OWN_POINTER, held));
  PetscFunctionReturn(0);
}

/* Unknowns that this rank owns: whole nodes. */
static PetscInt Owned(const Case *k, int n)
{
  PetscMPIInt rank, size;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  return (n * (rank + 1) / size - n * rank / size) * k->components;
}

/* The matrix of the cells of one part, or of all if it is negative, in the numbering of the unknowns. */
static PetscErrorCode Assemble(const Mesh *mesh, int bs, const int *part, int p, const int *number, int n, Mat *A)
{
  int         m = Vertices(mesh), c, v, i;
  PetscInt    dofs[12];
  PetscScalar k[144];

  PetscFunctionBeginUser;
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, n * bs, n * bs, 0, NULL, A));
  PetscCall(MatSetUp(*A));
  PetscCall(MatSeqAIJSetPreallocation(*A, 60 * bs, NULL));
  PetscCall(MatSetOption(*A, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  for (c = 0; c < mesh->cells; c++) {
    if (p >= 0 && part[c] != p) continue;
    Stiffness(mesh, c, bs, k);
    for (v = 0; v < m; v++)
      for (i = 0; i < bs; i++) {
        int node = number[mesh->cell[c * m + v]];

        dofs[v * bs + i] = node < 0 ? -1 : node * bs + i;
      }
    PetscCall(MatSetValues(*A, m * bs, dofs, m * bs, dofs, k, ADD_VALUES));
  }
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

/* The assembled problem with a random load, and its solution by a direct solver. */
static PetscErrorCode Assembled(const Mesh *mesh, const Case *k, const int *part, const int *number, int n, IS held,
                                Vec *b, Vec *x)
{
  Mat      A;
  PetscInt i;

  PetscFunctionBeginUser;
  PetscCall(Assemble(mesh, k->components, part, -1, number, n, &A));
  PetscCall(MatCreateVecs(A, b, x));
  for (i = 0; i < n * k->components; i++) PetscCall(VecSetValue(*b, i, Unit() - 0.5, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(*b));
  PetscCall(VecAssemblyEnd(*b));
  PetscCall(VecISSet(*b, held, 0));
  PetscCall(MatZeroRowsColumnsIS(A, held, 1, NULL, NULL));
  PetscCall(Direct(A, *b, *x));
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(0);
}

/* Adds the subdomains of this rank to the solver. */
static PetscErrorCode Add(FetiFeti ff, const Mesh *mesh, const Case *k, const int *part, const int *number, int n)
{
  PetscMPIInt rank, size;
  int         p;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  for (p = 0; p < k->parts; p++) {
    Mat             A, B;
    IS              rows;
    const PetscInt *ia, *ja, *dofs;
    PetscScalar    *a;
    PetscInt        count;
    PetscBool       done;

    if (p * size / k->parts != rank) continue;
    PetscCall(Assemble(mesh, k->components, part, p, number, n, &A));
    PetscCall(Squeezed(A, &rows, &B));
    PetscCall(ISGetLocalSize(rows, &count));
    PetscCall(ISGetIndices(rows, &dofs));
    PetscCall(MatGetRowIJ(B, 0, PETSC_FALSE, PETSC_FALSE, &count, &ia, &ja, &done));
    PetscCall(MatSeqAIJGetArray(B, &a));
    PetscCall(FetiFetiAddSubdomain(ff, PETSC_DECIDE, count, ia, ja, a, dofs));
    PetscCall(MatSeqAIJRestoreArray(B, &a));
    PetscCall(MatRestoreRowIJ(B, 0, PETSC_FALSE, PETSC_FALSE, &count, &ia, &ja, &done));
    PetscCall(ISRestoreIndices(rows, &dofs));
    PetscCall(ISDestroy(&rows));
    PetscCall(MatDestroy(&B));
    PetscCall(MatDestroy(&A));
  }
  PetscFunctionReturn(0);
}

/* Constants or rigid motions at the unknowns, for vectors like u. */
static PetscErrorCode Motions(const Mesh *mesh, const Case *k, const int *number, Vec u, MatNullSpace *space)
{
  Vec      x;
  PetscInt first, last;
  int      node, d;

  PetscFunctionBeginUser;
  if (k->components == 1) {
    PetscCall(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_TRUE, 0, NULL, space));
    PetscFunctionReturn(0);
  }
  PetscCall(VecDuplicate(u, &x));
  PetscCall(VecSetBlockSize(x, k->components));
  PetscCall(VecGetOwnershipRange(x, &first, &last));
  for (node = 0; node < mesh->nodes; node++)
    for (d = 0; d < mesh->dim; d++) {
      PetscInt dof = number[node] * mesh->dim + d;

      if (number[node] >= 0 && dof >= first && dof < last)
        PetscCall(VecSetValue(x, dof, mesh->x[3 * node + d], INSERT_VALUES));
    }
  PetscCall(VecAssemblyBegin(x));
  PetscCall(VecAssemblyEnd(x));
  PetscCall(MatNullSpaceCreateRigidBody(x, space));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(0);
}

/* Solves a case both ways; prints what came out. A refusal is no error. */
static PetscErrorCode Run(int id, const Case *k, const Mesh *mesh, const int *part, PetscReal near, PetscBool *good)
{
  int                *number, n, i, refused;
  IS                  held;
  Vec                 b, x, u, all;
  VecScatter          scatter;
  FetiFeti            ff;
  PetscInt            its    = -1;
  PetscReal           length = 1, error = 1;
  KSPConvergedReason  reason = KSP_DIVERGED_NULL;

  PetscFunctionBeginUser;
  PetscCall(Number(mesh, k, &number, &n));
  PetscCall(Held(mesh, k, number, &held));
  PetscCall(Assembled(mesh, k, part, number, n, held, &b, &x));
  PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
  PetscCall(FetiFetiSetFromOptions(ff));
  PetscCall(FetiFetiSetSizes(ff, Owned(k, n), n * k->components));
  if (k->motions >= 0) PetscCall(FetiFetiSetBlockSize(ff, k->components));
  PetscCall(Add(ff, mesh, k, part, number, n));
  PetscCall(FetiFetiSetDirichletBoundaries(ff, held, NULL));
  PetscCall(VecCreate(PETSC_COMM_WORLD, &u));
  PetscCall(VecSetSizes(u, Owned(k, n), n * k->components));
  if (k->motions >= 0) PetscCall(VecSetBlockSize(u, k->components));
  PetscCall(VecSetUp(u));
  if (k->motions > 0) {
    MatNullSpace space;

    PetscCall(Motions(mesh, k, number, u, &space));
    PetscCall(FetiFetiSetNearNullSpace(ff, space));
    PetscCall(MatNullSpaceDestroy(&space));
  }
  { /* the load of every rank is the same */
    PetscInt           first, last;
    const PetscScalar *load;
    Vec                c;

    PetscCall(VecDuplicate(u, &c));
    PetscCall(VecGetOwnershipRange(c, &first, &last));
    PetscCall(VecGetArrayRead(b, &load));
    for (i = first; i < last; i++) PetscCall(VecSetValue(c, i, load[i], INSERT_VALUES));
    PetscCall(VecRestoreArrayRead(b, &load));
    PetscCall(VecAssemblyBegin(c));
    PetscCall(VecAssemblyEnd(c));
    PetscCall(PetscPushErrorHandler(PetscTraceBackErrorHandler, NULL));
    refused = (int)FetiFetiSolve(ff, c, u);
    PetscCall(PetscPopErrorHandler());
    PetscCall(VecDestroy(&c));
  }
  if (!refused) {
    PetscCall(FetiFetiGetConvergedReason(ff, &reason));
    PetscCall(FetiFetiGetIterations(ff, &its));
    PetscCall(VecScatterCreateToAll(u, &scatter, &all));
    PetscCall(VecScatterBegin(scatter, u, all, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecScatterEnd(scatter, u, all, INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecScatterDestroy(&scatter));
    PetscCall(VecNorm(x, NORM_INFINITY, &length));
    PetscCall(VecAXPY(all, -1, x));
    PetscCall(VecNorm(all, NORM_INFINITY, &error));
    PetscCall(VecDestroy(&all));
  }
  if (refused || reason < 0 || !(error <= near * length)) *good = PETSC_FALSE;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%d: dim %d components %d parts %d by %s motions %d kept %d cells %d: ", id,
                        k->dim, k->components, k->parts, k->how, k->motions, k->kept, mesh->cells));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "code %d %s its %d error %.1e\n", refused,
                        refused ? "REFUSED" : KSPConvergedReasons[reason], (int)its, (double)(error / length)));
  PetscCall(FetiFetiDestroy(&ff));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&u));
  PetscCall(ISDestroy(&held));
  PetscCall(PetscFree(number));
  PetscFunctionReturn(0);
}

/* Solves by a KSP on a MATIS, one part on every rank, and compares with the direct solution. */
static PetscErrorCode Matis(const Case *k, const Mesh *mesh, const int *part, PetscReal near, PetscBool *good)
{
  PetscMPIInt            rank;
  int                   *number, n, i;
  const PetscInt        *dofs;
  PetscInt               count, first, last, its;
  PetscReal              length, error;
  Mat                    L, B, M;
  IS                     rows, held;
  ISLocalToGlobalMapping map;
  Vec                    b, x, c, u, all;
  VecScatter             scatter;
  KSP                    ksp;
  KSPConvergedReason     reason;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(Number(mesh, k, &number, &n));
  PetscCall(Held(mesh, k, number, &held));
  PetscCall(Assembled(mesh, k, part, number, n, held, &b, &x));
  PetscCall(Assemble(mesh, k->components, part, rank, number, n, &L));
  PetscCall(Squeezed(L, &rows, &B));
  PetscCall(ISGetLocalSize(rows, &count));
  PetscCall(ISGetIndices(rows, &dofs));
  PetscCall(ISLocalToGlobalMappingCreate(PETSC_COMM_WORLD, 1, count, dofs, PETSC_COPY_VALUES, &map));
  PetscCall(ISRestoreIndices(rows, &dofs));
  PetscCall(MatCreateIS(PETSC_COMM_WORLD, 1, Owned(k, n), Owned(k, n), n * k->components, n * k->components,
                        map, map, &M));
  if (k->motions >= 0) PetscCall(MatSetBlockSize(M, k->components));
  PetscCall(MatISSetLocalMat(M, B));
  PetscCall(MatAssemblyBegin(M, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(M, MAT_FINAL_ASSEMBLY));
  if (k->kept) PetscCall(MatZeroRowsColumnsIS(M, held, 1, NULL, NULL));
  PetscCall(MatCreateVecs(M, &c, &u));
  if (k->motions > 0) {
    MatNullSpace space;

    PetscCall(Motions(mesh, k, number, u, &space));
    PetscCall(MatSetNearNullSpace(M, space));
    PetscCall(MatNullSpaceDestroy(&space));
  }
  PetscCall(VecGetOwnershipRange(c, &first, &last));
  {
    const PetscScalar *load;

    PetscCall(VecGetArrayRead(b, &load));
    for (i = first; i < last; i++) PetscCall(VecSetValue(c, i, load[i], INSERT_VALUES));
    PetscCall(VecRestoreArrayRead(b, &load));
    PetscCall(VecAssemblyBegin(c));
    PetscCall(VecAssemblyEnd(c));
  }
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetOperators(ksp, M, M));
  PetscCall(KSPSetType(ksp, "fetifeti"));
  PetscCall(KSPSetFromOptions(ksp));
  PetscCall(KSPSolve(ksp, c, u));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCall(KSPGetIterationNumber(ksp, &its));
  PetscCall(VecScatterCreateToAll(u, &scatter, &all));
  PetscCall(VecScatterBegin(scatter, u, all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(scatter, u, all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecNorm(x, NORM_INFINITY, &length));
  PetscCall(VecAXPY(all, -1, x));
  PetscCall(VecNorm(all, NORM_INFINITY, &error));
  if (reason < 0 || !(error <= near * length)) *good = PETSC_FALSE;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s its %d error %.1e\n", KSPConvergedReasons[reason], (int)its,
                        (double)(error / length)));
  PetscCall(VecScatterDestroy(&scatter));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&all));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&c));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&u));
  PetscCall(MatDestroy(&M));
  PetscCall(MatDestroy(&B));
  PetscCall(MatDestroy(&L));
  PetscCall(ISDestroy(&held));
  PetscCall(ISDestroy(&rows));
  PetscCall(ISLocalToGlobalMappingDestroy(&map));
  PetscCall(PetscFree(number));
  PetscFunctionReturn(0);
}

/* A cube of 2 x 2 x 2 x 6 tetrahedra, or a plate of n x n x 2 triangles, cut across x into as many parts as ranks. With
   -hinge i the first part gets the i-th cell of the second one that hangs by an edge (in the plane by a node). */
static PetscErrorCode Slices(PetscReal near, PetscBool *good)
{
  Case        k = {3, 3, 0, 1, 1, "slices"};
  Mesh        mesh;
  PetscInt    size = 2, dim = 3, motions = 1;
  PetscMPIInt ranks;
  PetscInt    hinge = -1;
  PetscBool   kept  = PETSC_TRUE;
  int        *part, n[3], c, v;

  PetscFunctionBeginUser;
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-n", &size, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-dim", &dim, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-motions", &motions, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-hinge", &hinge, NULL));
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-kept", &kept, NULL));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  k.kept = kept;
  k.dim = k.components = (int)dim;
  k.motions            = (int)motions;
  k.parts              = ranks;
  for (v = 0; v < 3; v++) n[v] = (int)size;
  PetscCall(Cubes(k.dim, n, &mesh));
  PetscCall(PetscMalloc1(mesh.cells, &part));
  for (c = 0; c < mesh.cells; c++) {
    PetscReal x = 0;

    for (v = 0; v <= k.dim; v++) x += mesh.x[3 * mesh.cell[c * (k.dim + 1) + v]] / (k.dim + 1);
    part[c] = (int)(x * ranks / n[0]);
  }
  for (c = 0; c < mesh.cells && hinge >= 0; c++) {
    int at = 0;

    for (v = 0; v <= k.dim; v++) at += mesh.x[3 * mesh.cell[c * (k.dim + 1) + v]] == n[0] / (PetscReal)ranks;
    if (part[c] != 1 || at != k.dim - 1 || hinge-- > 0) continue;
    part[c] = 0;
  }
  PetscCall(Matis(&k, &mesh, part, near, good));
  PetscCall(PetscFree(part));
  PetscCall(PetscFree(mesh.x));
  PetscCall(PetscFree(mesh.cell));
  PetscFunctionReturn(0);
}

/* A random case; the numbers depend on its id alone. */
static PetscErrorCode Random(int id, PetscReal near, PetscBool *good)
{
  static const char *const hows[3] = {"sides", "nodes", "ragged"};
  Case  k;
  Mesh  mesh;
  int  *part, n[3], d;

  PetscFunctionBeginUser;
  random_state = (uint64_t)id * 7919 + 1;
  k.dim        = 2 + Below(2);
  k.components = Below(4) ? k.dim : 1;
  k.how        = hows[Below(3)];
  k.motions    = Below(2) - (Below(5) == 0); /* -1: not even a block size, 0: a block size, 1: all motions */
  k.kept       = Below(2);
  k.parts      = 2 + (int)(62 * Unit() * Unit() + 0.5);
  for (d = 0; d < 3; d++) n[d] = k.dim == 2 ? 4 + Below(12) : 2 + Below(4);
  PetscCall(RandomMesh(k.dim, n, Below(k.dim == 2 ? 100 : 60), &mesh));
  if (k.parts > mesh.cells / 3) k.parts = mesh.cells / 3;
  if (k.parts > mesh.nodes / 2) k.parts = mesh.nodes / 2;
  PetscCall(PetscMalloc1(mesh.cells, &part));
  PetscCall(Partition(&mesh, k.how, k.parts, part));
  PetscCall(Run(id, &k, &mesh, part, near, good));
  PetscCall(PetscFree(part));
  PetscCall(PetscFree(mesh.x));
  PetscCall(PetscFree(mesh.cell));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscInt  first = 0, count = 10, i;
  PetscReal near = 1e-9;
  PetscBool good = PETSC_TRUE, slices = PETSC_FALSE;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(FetiFetiInitializePackage());
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-slices", &slices, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-first", &first, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-count", &count, NULL));
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-near", &near, NULL));
  if (slices) PetscCall(Slices(near, &good));
  for (i = first; i < first + count && !slices; i++) PetscCall(Random((int)i, near, &good));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, good ? "ok\n" : "some were refused or are wrong\n"));
  PetscCall(PetscFinalize());
  return 0;
}
