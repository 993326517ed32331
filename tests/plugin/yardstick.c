/*
   Times one solver of PETSc on a box of triangles or tetrahedra that is cut into subdomains: a Laplacian or elasticity,
   held where x = 0. The matrices of the subdomains are the same for every solver; -operator says how it gets them:

     matis    a MATIS with all subdomains of a rank, each with its own copies (PETSc >= 3.21)
     merged   a MATIS with one local matrix for each rank, the sum of its subdomains
     aij      the assembled matrix
     capi     the C API of this library, for which any PETSc will do

   -motions 0 leaves the near-null space out, -corners names vertices that hold the subdomains, -columns N solves
   for N more right-hand sides, by KSPMatSolve() and one after the other.

   Everything else is said by the options of KSP and PC. scripts/yardstick.py makes tables of it.
*/
static char help[] = "Times a solver on subdomains.\n";

#include "corners.h"
#include "fetifeti.h"
#include <sys/resource.h>

/* The operator as a MATIS of the parts of this rank. */
static PetscErrorCode Unassembled(const Problem *p, PetscBool apart, Mat *A)
{
  PetscInt               first, last, low, high, count, *nodes, bs = p->components;
  ISLocalToGlobalMapping map;
  Mat                    local;

  PetscFunctionBeginUser;
  Share(p->parts, &first, &last);
  Share(p->free, &low, &high);
  PetscCall(Local(p, first, last, apart, &local, &count, &nodes));
  PetscCall(ISLocalToGlobalMappingCreate(PETSC_COMM_WORLD, bs, count, nodes, PETSC_OWN_POINTER, &map));
  PetscCall(MatCreate(PETSC_COMM_WORLD, A));
  PetscCall(MatSetSizes(*A, (high - low) * bs, (high - low) * bs, p->free * bs, p->free * bs));
  PetscCall(MatSetBlockSize(*A, bs));
  PetscCall(MatSetType(*A, MATIS));
#if PETSC_VERSION_GE(3, 21, 0)
  PetscCall(MatISSetAllowRepeated(*A, PETSC_TRUE));
#else
  PetscCheck(!apart, PETSC_COMM_WORLD, PETSC_ERR_SUP, "-operator matis needs PETSc 3.21 or later");
#endif
  PetscCall(MatSetLocalToGlobalMapping(*A, map, map));
  PetscCall(MatISSetLocalMat(*A, local));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatDestroy(&local));
  PetscCall(ISLocalToGlobalMappingDestroy(&map));
  PetscFunctionReturn(0);
}

/* The assembled operator, by the rank of each part. */
static PetscErrorCode Assembled(const Problem *p, Mat *A)
{
  PetscInt first, last, low, high, bs = p->components, wide = (p->mesh.dim == 2 ? 9 : 30) * bs, c;

  PetscFunctionBeginUser;
  Share(p->parts, &first, &last);
  Share(p->free, &low, &high);
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, (high - low) * bs, (high - low) * bs, p->free * bs, p->free * bs, wide, NULL,
                         wide, NULL, A));
  PetscCall(MatSetBlockSize(*A, bs));
  for (c = 0; c < p->mesh.cells; c++)
    if (p->part[c] >= first && p->part[c] < last) PetscCall(AddCell(p, (int)c, NULL, *A));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

/* The subdomains of this rank, for the C API. */
static PetscErrorCode Subdomains(const Problem *p, FetiFeti ff)
{
  PetscInt first, last, low, high, bs = p->components, g, i;

  PetscFunctionBeginUser;
  Share(p->parts, &first, &last);
  Share(p->free, &low, &high);
  PetscCall(FetiFetiSetFromOptions(ff));
  PetscCall(FetiFetiSetSizes(ff, (high - low) * bs, p->free * bs));
  PetscCall(FetiFetiSetBlockSize(ff, bs));
  for (g = first; g < last; g++) {
    Mat             A;
    PetscInt        count, *nodes, *dofs;
    const PetscInt *ia, *ja;
    PetscScalar    *a;
    PetscBool       done;

    PetscCall(Local(p, g, g + 1, PETSC_FALSE, &A, &count, &nodes));
    PetscCall(PetscMalloc1(count * bs, &dofs));
    for (i = 0; i < count * bs; i++) dofs[i] = nodes[i / bs] * bs + i % bs;
    PetscCall(MatGetRowIJ(A, 0, PETSC_FALSE, PETSC_FALSE, &count, &ia, &ja, &done));
    PetscCall(MatSeqAIJGetArray(A, &a));
    PetscCall(FetiFetiAddSubdomain(ff, PETSC_DECIDE, count, ia, ja, a, dofs));
    PetscCall(MatSeqAIJRestoreArray(A, &a));
    PetscCall(MatRestoreRowIJ(A, 0, PETSC_FALSE, PETSC_FALSE, &count, &ia, &ja, &done));
    PetscCall(MatDestroy(&A));
    PetscCall(PetscFree(nodes));
    PetscCall(PetscFree(dofs));
  }
  PetscFunctionReturn(0);
}

/* Translations and rotations, for vectors like u; NULL for a scalar problem. */
static PetscErrorCode Motions(const Problem *p, Vec u, MatNullSpace *space)
{
  PetscInt first, last, c, d, bs = p->components;
  Vec      x;

  PetscFunctionBeginUser;
  *space = NULL;
  if (bs == 1) PetscFunctionReturn(0);
  PetscCall(VecDuplicate(u, &x));
  PetscCall(VecGetOwnershipRange(x, &first, &last));
  for (c = 0; c < p->mesh.nodes; c++)
    for (d = 0; d < bs; d++) {
      PetscInt dof = p->number[c] * bs + d;

      if (dof >= first && dof < last && p->number[c] >= 0)
        PetscCall(VecSetValue(x, dof, p->mesh.x[3 * c + d], INSERT_VALUES));
    }
  PetscCall(VecAssemblyBegin(x));
  PetscCall(VecAssemblyEnd(x));
  PetscCall(MatNullSpaceCreateRigidBody(x, space));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(0);
}

/* A load that is nowhere zero, the same for every number of ranks. */
static PetscErrorCode Load(Vec b)
{
  PetscInt first, last, n, i;

  PetscFunctionBeginUser;
  PetscCall(VecGetSize(b, &n));
  PetscCall(VecGetOwnershipRange(b, &first, &last));
  random_state = 77;
  for (i = 0; i < n; i++) {
    PetscReal value = Unit() - 0.3;

    if (i >= first && i < last) PetscCall(VecSetValue(b, i, value, INSERT_VALUES));
  }
  PetscCall(VecAssemblyBegin(b));
  PetscCall(VecAssemblyEnd(b));
  PetscFunctionReturn(0);
}

/* Seconds by the clock and megabytes at most in use so far, the sum over the ranks. */
static PetscErrorCode Now(double *seconds, double *megabytes)
{
  struct rusage used;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  *seconds = MPI_Wtime();
  getrusage(RUSAGE_SELF, &used);
  *megabytes = (double)used.ru_maxrss / 1024;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, megabytes, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD));
  PetscFunctionReturn(0);
}

/* Seconds for `columns` right-hand sides by KSPMatSolve(), and one after the other on a solver of its own. */
static PetscErrorCode Columns(Mat A, KSP ksp, PetscInt columns)
{
  Mat      B, X;
  Vec      b, x;
  KSP      alone;
  double   begin, middle, end, memory;
  PetscInt i, n, its, most;

  PetscFunctionBeginUser;
  PetscCall(MatGetLocalSize(A, &n, NULL));
  PetscCall(MatCreateDense(PETSC_COMM_WORLD, n, PETSC_DECIDE, PETSC_DECIDE, columns, NULL, &B));
  PetscCall(MatSetRandom(B, NULL));
  PetscCall(MatDuplicate(B, MAT_DO_NOT_COPY_VALUES, &X));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &alone));
  PetscCall(KSPSetOperators(alone, A, A));
  PetscCall(KSPSetNormType(alone, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetFromOptions(alone));
  PetscCall(KSPSetUp(alone));
  PetscCall(Now(&begin, &memory));
  PetscCall(KSPMatSolve(ksp, B, X));
  PetscCall(Now(&middle, &memory));
  PetscCall(KSPGetIterationNumber(ksp, &most));
  PetscCall(MatCreateVecs(A, &x, NULL));
  for (i = 0; i < columns; i++) {
    PetscCall(MatDenseGetColumnVecRead(B, i, &b));
    PetscCall(KSPSolve(alone, b, x));
    PetscCall(MatDenseRestoreColumnVecRead(B, i, &b));
  }
  PetscCall(Now(&end, &memory));
  PetscCall(KSPGetIterationNumber(alone, &its));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "columns %d together %.4f iterations %d alone %.4f iterations %d\n",
                        (int)columns, middle - begin, (int)most, end - middle, (int)its));
  PetscCall(KSPDestroy(&alone));
  PetscCall(VecDestroy(&x));
  PetscCall(MatDestroy(&B));
  PetscCall(MatDestroy(&X));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Problem            p;
  char               how[16] = "aij";
  Mat                A;
  Vec                b, u, r;
  KSP                ksp;
  PC                 pc;
  IS                 primal;
  FetiFeti           ff;
  MatNullSpace       space;
  KSPConvergedReason reason;
  PetscInt           its, n, columns = 0;
  PetscReal          large = 0, small = 0, residual, load, size;
  PetscBool          capi, aij, apart, bddc, motions = PETSC_TRUE, corners = PETSC_FALSE;
  double             begin, ready, end, before, after;

  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-operator", how, sizeof(how), NULL));
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-motions", &motions, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-columns", &columns, NULL));
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-corners", &corners, NULL));
  PetscCall(PetscStrcmp(how, "capi", &capi));
  PetscCall(PetscStrcmp(how, "aij", &aij));
  PetscCall(PetscStrcmp(how, "matis", &apart));
  PetscCall(FetiFetiInitializePackage());
  PetscCall(Make(&p));
  if (aij || capi) PetscCall(Assembled(&p, &A));
  else PetscCall(Unassembled(&p, apart, &A));
  PetscCall(MatCreateVecs(A, &u, &b));
  PetscCall(Load(b));
  PetscCall(Motions(&p, u, &space));
  if (capi) {
    PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
    PetscCall(Subdomains(&p, ff));
    if (space && motions) PetscCall(FetiFetiSetNearNullSpace(ff, space));
    PetscCall(Now(&begin, &before));
    PetscCall(FetiFetiSetUp(ff));
    PetscCall(Now(&ready, &after));
    PetscCall(FetiFetiSolve(ff, b, u));
    PetscCall(Now(&end, &after));
    PetscCall(FetiFetiGetIterations(ff, &its));
    PetscCall(FetiFetiGetConvergedReason(ff, &reason));
    PetscCall(FetiFetiGetSpectrum(ff, &small, &large));
    PetscCall(FetiFetiDestroy(&ff));
  } else {
    if (space && motions) PetscCall(MatSetNearNullSpace(A, space));
    PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
    PetscCall(KSPSetOperators(ksp, A, A));
    PetscCall(KSPSetType(ksp, KSPCG));
    PetscCall(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
    PetscCall(KSPSetComputeSingularValues(ksp, PETSC_TRUE));
    PetscCall(KSPSetFromOptions(ksp));
    PetscCall(KSPGetPC(ksp, &pc));
    PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCBDDC, &bddc));
    if (bddc && p.components > 1) PetscCall(Positions(&p, b, pc));
    if (corners) {
      PetscCall(Corners(&p, &primal));
      if (bddc) PetscCall(PCBDDCSetPrimalVerticesIS(pc, primal));
      else PetscCall(KSPFETIFETISetPrimalDofs(ksp, primal));
      PetscCall(ISDestroy(&primal));
    }
    PetscCall(Now(&begin, &before));
    PetscCall(KSPSetUp(ksp));
    PetscCall(KSPSetUpOnBlocks(ksp));
    PetscCall(Now(&ready, &after));
    PetscCall(KSPSolve(ksp, b, u));
    PetscCall(Now(&end, &after));
    PetscCall(KSPGetIterationNumber(ksp, &its));
    PetscCall(KSPGetConvergedReason(ksp, &reason));
    if (its > 0) PetscCall(KSPComputeExtremeSingularValues(ksp, &large, &small));
    if (columns > 0) PetscCall(Columns(A, ksp, columns));
    PetscCall(KSPDestroy(&ksp));
  }
  PetscCall(VecDuplicate(b, &r));
  PetscCall(MatMult(A, u, r));
  PetscCall(VecAYPX(r, -1, b));
  PetscCall(VecNorm(r, NORM_2, &residual));
  PetscCall(VecNorm(b, NORM_2, &load));
  PetscCall(VecNorm(u, NORM_2, &size));
  PetscCall(VecGetSize(b, &n));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                        "unknowns %d parts %d reason %s iterations %d kappa %.3f setup %.4f solve %.4f residual %.2e "
                        "megabytes %.1f before %.1f norm %.9e\n",
                        (int)n, (int)p.parts, KSPConvergedReasons[reason], (int)its, small > 0 ? large / small : 0,
                        ready - begin, end - ready, residual / load, after, before, size));
  PetscCall(MatNullSpaceDestroy(&space));
  PetscCall(MatDestroy(&A));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&u));
  PetscCall(VecDestroy(&r));
  PetscCall(PetscFree(p.mesh.x));
  PetscCall(PetscFree(p.mesh.cell));
  PetscCall(PetscFree(p.part));
  PetscCall(PetscFree(p.factor));
  PetscCall(PetscFree(p.number));
  PetscCall(PetscFinalize());
  return 0;
}
