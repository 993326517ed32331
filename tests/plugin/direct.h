/* Direct solutions of PETSc, for test programs. */
#include <petscksp.h>

/* A matrix without its empty rows, and the numbers of the others. */
static PetscErrorCode Squeezed(Mat A, IS *rows, Mat *B)
{
  PetscInt n;

  PetscFunctionBeginUser;
  PetscCall(MatGetSize(A, &n, NULL));
  PetscCall(MatFindNonzeroRows(A, rows)); /* NULL if no row is empty */
  if (!*rows) PetscCall(ISCreateStride(PETSC_COMM_SELF, n, 0, 1, rows));
  PetscCall(MatCreateSubMatrix(A, *rows, *rows, MAT_INITIAL_MATRIX, B));
  PetscFunctionReturn(0);
}

/* The direct solution, with a step of refinement. */
static PetscErrorCode Direct(Mat A, Vec b, Vec x)
{
  KSP ksp;
  PC  pc;
  Vec r, d;

  PetscFunctionBeginUser;
  PetscCall(KSPCreate(PETSC_COMM_SELF, &ksp));
  PetscCall(KSPSetOptionsPrefix(ksp, "direct_"));
  PetscCall(KSPSetOperators(ksp, A, A));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(VecDuplicate(b, &r));
  PetscCall(VecDuplicate(b, &d));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(MatMult(A, x, r));
  PetscCall(VecAYPX(r, -1, b));
  PetscCall(KSPSolve(ksp, r, d));
  PetscCall(VecAXPY(x, 1, d));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&r));
  PetscCall(VecDestroy(&d));
  PetscFunctionReturn(0);
}
