/*
   KSPFETIFETI in the places where programs put solvers. A matrix of elasticity on a DMDA (elastic.h), a MATIS.
   -do local: other types of local matrices; split, composite: inside PCFIELDSPLIT and PCCOMPOSITE; nest: refused;
   half, world: half of the ranks, the others do nothing; codes: errors that a program goes on after.
*/
static char help[] = "A solver of type fetifeti inside other solvers.\n";

#include <petscksp.h>
#include "elastic.h"

/* The largest difference between x and the solution of PETSc's LU, over the largest of the solution. */
static PetscErrorCode Error(Mat A, Vec b, Vec x, PetscReal *error)
{
  Mat       assembled;
  KSP       ksp;
  PC        pc;
  Vec       exact;
  PetscReal size;

  PetscFunctionBeginUser;
  PetscCall(MatConvert(A, MATAIJ, MAT_INITIAL_MATRIX, &assembled));
  PetscCall(VecDuplicate(b, &exact));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)A), &ksp));
  PetscCall(KSPSetOperators(ksp, assembled, assembled));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCREDUNDANT));
  PetscCall(KSPSolve(ksp, b, exact));
  PetscCall(VecNorm(exact, NORM_INFINITY, &size));
  PetscCall(VecAXPY(exact, -1.0, x));
  PetscCall(VecNorm(exact, NORM_INFINITY, error));
  *error /= size;
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&exact));
  PetscCall(MatDestroy(&assembled));
  PetscFunctionReturn(0);
}

static PetscErrorCode Solve(Mat A, Vec b, const char what[])
{
  MPI_Comm           comm = PetscObjectComm((PetscObject)A);
  KSP                ksp;
  Vec                x;
  PetscReal          error;
  KSPConvergedReason reason;

  PetscFunctionBeginUser;
  PetscCall(VecDuplicate(b, &x));
  PetscCall(KSPCreate(comm, &ksp));
  PetscCall(KSPSetOperators(ksp, A, A));
  PetscCall(KSPSetTolerances(ksp, 1e-11, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSetFromOptions(ksp));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCall(Error(A, b, x, &error));
  PetscCheck(reason > 0 && error < 1e-8, comm, PETSC_ERR_PLIB, "%s: reason %d, error %g", what, (int)reason,
             (double)error);
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(0);
}

/* Local matrices of other types: what they say about symmetry and blocks does not change the answer. */
static PetscErrorCode Local(Mat A, Vec b)
{
  const char *const types[] = {MATSEQBAIJ, MATSEQSBAIJ, MATSEQDENSE};
  Mat               local, other;
  PetscInt          k;

  PetscFunctionBeginUser;
  for (k = 0; k < 3; k++) {
    PetscCall(MatISGetLocalMat(A, &local));
    PetscCall(MatSetOption(local, MAT_SYMMETRIC, PETSC_TRUE));
    PetscCall(MatConvert(local, types[k], MAT_INITIAL_MATRIX, &other));
    PetscCall(MatISRestoreLocalMat(A, &local));
    PetscCall(MatISSetLocalMat(A, other));
    PetscCall(MatDestroy(&other));
    PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
    PetscCall(Solve(A, b, types[k]));
    PetscCall(MatISGetLocalMat(A, &local));
    PetscCall(MatConvert(local, MATSEQAIJ, MAT_INITIAL_MATRIX, &other));
    PetscCall(MatISRestoreLocalMat(A, &local));
    PetscCall(MatISSetLocalMat(A, other));
    PetscCall(MatDestroy(&other));
  }
  PetscFunctionReturn(0);
}

/* [A Bt; B -I / 8], as Stokes has it with a little compressibility: A by fetifeti, the rest by PCFIELDSPLIT of type
   schur with the complement A11 - A10 diag(A00)^-1 A01 as preconditioner. */
static PetscErrorCode Saddle(Mat A, Mat *S)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)A);
  Mat      part[4];
  PetscInt n, N, first, last, i, row[2];

  PetscFunctionBeginUser;
  PetscCall(MatGetLocalSize(A, &n, NULL));
  PetscCall(MatGetSize(A, &N, NULL));
  part[0] = A;
  PetscCall(MatCreateAIJ(comm, n / 2, n, PETSC_DETERMINE, N, 2, NULL, 2, NULL, &part[2]));
  PetscCall(MatGetOwnershipRange(part[2], &first, &last));
  for (i = first; i < last; i++) { /* a difference of the components of a node */
    PetscScalar v[2] = {0.3, -0.2};

    row[0] = 2 * i;
    row[1] = 2 * i + 1;
    PetscCall(MatSetValues(part[2], 1, &i, 2, row, v, INSERT_VALUES));
  }
  PetscCall(MatAssemblyBegin(part[2], MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(part[2], MAT_FINAL_ASSEMBLY));
  PetscCall(MatTranspose(part[2], MAT_INITIAL_MATRIX, &part[1]));
  PetscCall(MatCreateAIJ(comm, n / 2, n / 2, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, &part[3]));
  for (i = first; i < last; i++) PetscCall(MatSetValue(part[3], i, i, -0.125, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(part[3], MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(part[3], MAT_FINAL_ASSEMBLY));
  PetscCall(MatCreateNest(comm, 2, NULL, 2, NULL, part, S));
  for (i = 1; i < 4; i++) PetscCall(MatDestroy(&part[i]));
  PetscFunctionReturn(0);
}

static PetscErrorCode Split(Mat A, PetscBool as_operator)
{
  MPI_Comm           comm = PetscObjectComm((PetscObject)A);
  Mat                S;
  Vec                b, x, r;
  KSP                ksp, *inner;
  PC                 pc = NULL;
  IS                 parts[2];
  PetscInt           n;
  PetscReal          norm, size;
  PetscBool          same;
  KSPConvergedReason reason;

  PetscFunctionBeginUser;
  PetscCall(Saddle(A, &S));
  PetscCall(MatCreateVecs(S, &x, &b));
  PetscCall(VecDuplicate(b, &r));
  PetscCall(VecSet(x, 1.0));
  PetscCall(MatMult(S, x, b));
  PetscCall(VecNorm(b, NORM_2, &size));
  PetscCall(KSPCreate(comm, &ksp));
  PetscCall(KSPSetOperators(ksp, S, S));
  if (!as_operator) {
    PetscCall(KSPGetPC(ksp, &pc));
    PetscCall(MatNestGetISs(S, parts, NULL));
    PetscCall(PCSetType(pc, PCFIELDSPLIT));
    PetscCall(PCFieldSplitSetIS(pc, "u", parts[0]));
    PetscCall(PCFieldSplitSetIS(pc, "p", parts[1]));
  }
  PetscCall(KSPSetFromOptions(ksp));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCall(MatMult(S, x, r));
  PetscCall(VecAXPY(r, -1.0, b));
  PetscCall(VecNorm(r, NORM_2, &norm));
  PetscCheck(reason > 0 && norm < 1e-6 * size, comm, PETSC_ERR_PLIB, "split: reason %d, residual %g of %g", (int)reason,
             (double)norm, (double)size);
  PetscCall(PCFieldSplitGetSubKSP(pc, &n, &inner));
  PetscCall(PetscObjectTypeCompare((PetscObject)inner[0], "fetifeti", &same));
  PetscCheck(same, comm, PETSC_ERR_PLIB, "the block of displacements is solved by another KSP");
  PetscCall(PetscFree(inner));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&r));
  PetscCall(MatDestroy(&S));
  PetscFunctionReturn(0);
}

/* An error handler that says nothing. PETSc's own has another name in each version. */
static PetscErrorCode Quiet(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                            PetscErrorType type, const char *message, void *ctx)
{
  return code;
}

/* Every rank gets a code, the same one, and the program goes on. */
static PetscErrorCode Codes(Mat A, Vec b)
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)A);
  Mat         local, spoiled;
  KSP         ksp;
  Vec         x;
  PetscMPIInt rank, size;
  PetscInt    n, code, least, most;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(VecDuplicate(b, &x));
  /* one rank alone spoils the symmetry */
  PetscCall(MatDuplicate(A, MAT_COPY_VALUES, &spoiled));
  PetscCall(MatISGetLocalMat(spoiled, &local));
  PetscCall(MatGetLocalSize(local, &n, NULL));
  if (rank == size - 1) PetscCall(MatSetValue(local, n - 1, n - 3, 7.0, ADD_VALUES));
  PetscCall(MatAssemblyBegin(local, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(local, MAT_FINAL_ASSEMBLY));
  PetscCall(MatISRestoreLocalMat(spoiled, &local));
  PetscCall(MatAssemblyBegin(spoiled, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(spoiled, MAT_FINAL_ASSEMBLY));
  PetscCall(KSPCreate(comm, &ksp));
  PetscCall(KSPSetOperators(ksp, spoiled, spoiled));
  PetscCall(KSPSetFromOptions(ksp));
  PetscCall(PetscPushErrorHandler(Quiet, NULL));
  code = (PetscInt)KSPSetUp(ksp);
  PetscCall(PetscPopErrorHandler());
  PetscCallMPI(MPI_Allreduce(&code, &least, 1, MPIU_INT, MPI_MIN, comm));
  PetscCallMPI(MPI_Allreduce(&code, &most, 1, MPIU_INT, MPI_MAX, comm));
  PetscCheck(least == PETSC_ERR_SUP && most == PETSC_ERR_SUP, comm, PETSC_ERR_PLIB, "codes from %d to %d, expected %d",
             (int)least, (int)most, (int)PETSC_ERR_SUP);
  /* the same solver for a good matrix: first that matrix, then one that is repaired, with a solver in between */
  PetscCall(KSPSetOperators(ksp, A, A));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPSetOperators(ksp, spoiled, spoiled));
  PetscCall(PetscPushErrorHandler(Quiet, NULL));
  code = (PetscInt)KSPSolve(ksp, b, x);
  PetscCall(PetscPopErrorHandler());
  PetscCheck(code == PETSC_ERR_SUP, PETSC_COMM_SELF, PETSC_ERR_PLIB, "code %d where a good matrix is replaced",
             (int)code);
  PetscCall(KSPDestroy(&ksp));
  PetscCall(MatDestroy(&spoiled));
  PetscCall(VecDestroy(&x));
  PetscCall(Solve(A, b, "after errors"));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  char        what[64] = "";
  PetscMPIInt rank, size;
  PetscBool   same, half;
  MPI_Comm    comm;
  DM          da;
  Mat         A;
  Vec         b;
  int         k;

  /* PETSC_COMM_WORLD is half of MPI_COMM_WORLD: the other half starts no PETSc */
  half = PETSC_FALSE;
  for (k = 1; k < argc; k++) half = (PetscBool)(half || !strcmp(argv[k], "world"));
  if (half) {
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    MPI_Comm_split(MPI_COMM_WORLD, rank % 2, rank, &comm);
    if (rank % 2 == 1) {
      MPI_Finalize();
      return 0;
    }
    PETSC_COMM_WORLD = comm;
  }
  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-do", what, sizeof(what), NULL));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(PetscStrcmp(what, "half", &same));
  if (same) { /* the odd ranks wait at the end of the program */
    MPI_Comm world = PETSC_COMM_WORLD;

    PetscCallMPI(MPI_Comm_split(world, rank % 2, rank, &comm));
    if (rank % 2 == 0) {
      PetscCall(BlockOn(comm, 9, PETSC_TRUE, PETSC_TRUE, &da, &A, &b));
      PetscCall(Solve(A, b, "half of the ranks"));
      PetscCall(VecDestroy(&b));
      PetscCall(MatDestroy(&A));
      PetscCall(DMDestroy(&da));
    }
    PetscCallMPI(MPI_Comm_free(&comm));
  } else {
    PetscCall(Block(9, PETSC_TRUE, PETSC_TRUE, &da, &A, &b));
    PetscCall(PetscStrcmp(what, "world", &same));
    if (same) PetscCall(Solve(A, b, "half of the world"));
    PetscCall(PetscStrcmp(what, "local", &same));
    if (same) PetscCall(Local(A, b));
    PetscCall(PetscStrcmp(what, "composite", &same));
    if (same) PetscCall(Solve(A, b, "composite"));
    PetscCall(PetscStrcmp(what, "split", &same));
    if (same) PetscCall(Split(A, PETSC_FALSE));
    PetscCall(PetscStrcmp(what, "nest", &same));
    if (same) PetscCall(Split(A, PETSC_TRUE));
    PetscCall(PetscStrcmp(what, "codes", &same));
    if (same) PetscCall(Codes(A, b));
    PetscCall(VecDestroy(&b));
    PetscCall(MatDestroy(&A));
    PetscCall(DMDestroy(&da));
  }
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "ok\n"));
  PetscCall(PetscFinalize());
  if (half) MPI_Finalize();
  return 0;
}
