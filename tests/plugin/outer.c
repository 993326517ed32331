/*
   A host program with more than a KSP: Laplacians on a DMDA as MATIS matrices. -do chooses what it solves:
   many: several right-hand sides by KSPMatSolve(), and the transposed system; once more from the guesses of KSPGuess.
   mg: PCMG with two levels, of which the coarse one is a MATIS.
   nest: two coupled fields, each a MATIS, by PCFIELDSPLIT.
   It prints "ok" when every residual is below the tolerance.
*/
static char help[] = "Solves with KSPs and PCs that have the method inside.\n";

#include <petscdmda.h>
#include <petscksp.h>

/* The stiffness of a square element, of which the lower side is held, on n x n elements. */
static PetscErrorCode Laplacian(DM da, Mat *A)
{
  const PetscScalar ke[16] = {4. / 6,  -1. / 6, -2. / 6, -1. / 6, -1. / 6, 4. / 6,  -1. / 6, -2. / 6,
                              -2. / 6, -1. / 6, 4. / 6,  -1. / 6, -1. / 6, -2. / 6, -1. / 6, 4. / 6};
  const PetscInt   *e;
  PetscInt          elements, corners, i, m, *held;
  PetscMPIInt       rank;
  AO                ao;

  PetscFunctionBeginUser;
  PetscCall(DMCreateMatrix(da, A));
  PetscCall(DMDAGetElements(da, &elements, &corners, &e));
  for (i = 0; i < elements; i++)
    PetscCall(MatSetValuesLocal(*A, 4, e + 4 * i, 4, e + 4 * i, ke, ADD_VALUES));
  PetscCall(DMDARestoreElements(da, &elements, &corners, &e));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(DMDAGetInfo(da, NULL, &m, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank) m = 0;
  PetscCall(PetscMalloc1(m, &held));
  for (i = 0; i < m; i++) held[i] = i;
  PetscCall(DMDAGetAO(da, &ao));
  PetscCall(AOApplicationToPetsc(ao, m, held));
  PetscCall(MatZeroRowsColumns(*A, m, held, 1.0, NULL, NULL));
  PetscCall(PetscFree(held));
  PetscFunctionReturn(0);
}

static PetscErrorCode Grid(PetscInt n, DM *da)
{
  PetscFunctionBeginUser;
  PetscCall(DMDACreate2d(PETSC_COMM_WORLD, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, DMDA_STENCIL_BOX, n + 1, n + 1,
                         PETSC_DECIDE, PETSC_DECIDE, 1, 1, NULL, NULL, da));
  PetscCall(DMSetMatType(*da, MATIS));
  PetscCall(DMSetUp(*da));
  PetscCall(DMDASetElementType(*da, DMDA_ELEMENT_Q1));
  PetscFunctionReturn(0);
}

/* Numbers that follow from the place in the vector and differ from `seed` to `seed`. */
static PetscErrorCode Load(Vec b, PetscInt seed)
{
  PetscInt i, first, last;

  PetscFunctionBeginUser;
  PetscCall(VecGetOwnershipRange(b, &first, &last));
  for (i = first; i < last; i++) PetscCall(VecSetValue(b, i, PetscSinReal((seed + 1.) * (i + 1)), INSERT_VALUES));
  PetscCall(VecAssemblyBegin(b));
  PetscCall(VecAssemblyEnd(b));
  PetscFunctionReturn(0);
}

static PetscErrorCode Solver(Mat A, KSP *ksp)
{
  PetscFunctionBeginUser;
  PetscCall(KSPCreate(PETSC_COMM_WORLD, ksp));
  PetscCall(KSPSetOperators(*ksp, A, A));
  PetscCall(KSPSetTolerances(*ksp, 1e-8, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSetFromOptions(*ksp));
  PetscFunctionReturn(0);
}

/* ||b - A x|| must be below the tolerance times ||b||. */
static PetscErrorCode Check(Mat A, Vec b, Vec x, PetscBool transposed, const char *what)
{
  Vec       r;
  PetscReal norm, size;

  PetscFunctionBeginUser;
  PetscCall(VecDuplicate(b, &r));
  PetscCall((transposed ? MatMultTranspose : MatMult)(A, x, r));
  PetscCall(VecAYPX(r, -1, b));
  PetscCall(VecNorm(r, NORM_2, &norm));
  PetscCall(VecNorm(b, NORM_2, &size));
  PetscCall(VecDestroy(&r));
  PetscCheck(norm <= 1.01e-8 * size, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "%s: residual %g of %g", what, (double)norm,
             (double)size);
  PetscFunctionReturn(0);
}

/* All unknowns are primal, each said by its owner. */
static PetscErrorCode AllPrimal(Mat A, KSP ksp)
{
  PetscErrorCode (*set)(KSP, IS);
  PetscInt first, last;
  IS       all;

  PetscFunctionBeginUser;
  PetscCall(PetscObjectQueryFunction((PetscObject)ksp, "KSPFETIFETISetPrimalDofs_C", &set));
  PetscCheck(set, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "the KSP has no primal unknowns");
  PetscCall(MatGetOwnershipRange(A, &first, &last));
  PetscCall(ISCreateStride(PETSC_COMM_WORLD, last - first, first, 1, &all));
  PetscCall((*set)(ksp, all));
  PetscCall(ISDestroy(&all));
  PetscFunctionReturn(0);
}

static PetscErrorCode Many(PetscInt n)
{
  const PetscInt columns = 5;
  PetscInt       i, local;
  PetscBool      device, primal;
  DM             da;
  Mat            A, B, X;
  Vec            b, x;
  KSP            ksp;

  PetscFunctionBeginUser;
  PetscCall(Grid(n, &da));
  PetscCall(Laplacian(da, &A));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-device", &device));
  if (device) PetscCall(MatSetVecType(A, VECCUDA));
  PetscCall(Solver(A, &ksp));
  if (device) PetscCall(KSPSetUp(ksp));
  PetscCall(MatGetLocalSize(A, &local, NULL));
  PetscCall(PetscOptionsHasName(NULL, NULL, "-primal", &primal));
  if (primal) PetscCall(AllPrimal(A, ksp));
  PetscCall(MatCreateDense(PETSC_COMM_WORLD, local, PETSC_DECIDE, PETSC_DECIDE, columns, NULL, &B));
  PetscCall(MatCreateDense(PETSC_COMM_WORLD, local, PETSC_DECIDE, PETSC_DECIDE, columns, NULL, &X));
  for (i = 0; i < columns; i++) {
    PetscCall(MatDenseGetColumnVecWrite(B, i, &b));
    PetscCall(Load(b, i));
    PetscCall(MatDenseRestoreColumnVecWrite(B, i, &b));
  }
  PetscCall(MatAssemblyBegin(B, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(B, MAT_FINAL_ASSEMBLY));
  PetscCall(KSPMatSolve(ksp, B, X));
  for (i = 0; i < columns; i++) {
    PetscCall(MatDenseGetColumnVecRead(B, i, &b));
    PetscCall(MatDenseGetColumnVecRead(X, i, &x));
    PetscCall(Check(A, b, x, PETSC_FALSE, "KSPMatSolve"));
    PetscCall(MatDenseRestoreColumnVecRead(X, i, &x));
    PetscCall(MatDenseRestoreColumnVecRead(B, i, &b));
  }
  PetscCall(MatCreateVecs(A, &x, &b));
  PetscCall(Load(b, 7));
  PetscCall(KSPSolveTranspose(ksp, b, x));
  PetscCall(Check(A, b, x, PETSC_TRUE, "KSPSolveTranspose"));
  for (i = 0; i < 3; i++) { /* loads that differ by little */
    PetscCall(VecShift(b, 1e-3));
    PetscCall(KSPSolve(ksp, b, x));
    PetscCall(Check(A, b, x, PETSC_FALSE, "one load after another"));
  }
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&b));
  PetscCall(MatDestroy(&X));
  PetscCall(MatDestroy(&B));
  PetscCall(MatDestroy(&A));
  PetscCall(DMDestroy(&da));
  PetscFunctionReturn(0);
}

static PetscErrorCode Multigrid(PetscInt n)
{
  DM  coarse, fine;
  Mat A[2], Afine, P;
  Vec b, x;
  KSP ksp, inner;
  PC  pc;

  PetscFunctionBeginUser;
  PetscCall(Grid(n, &coarse));
  PetscCall(DMRefine(coarse, PETSC_COMM_WORLD, &fine));
  PetscCall(DMDASetElementType(fine, DMDA_ELEMENT_Q1));
  PetscCall(Laplacian(coarse, &A[0]));
  PetscCall(Laplacian(fine, &A[1]));
  PetscCall(MatConvert(A[1], MATAIJ, MAT_INITIAL_MATRIX, &Afine));
  PetscCall(DMCreateInterpolation(coarse, fine, &P, NULL));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetOperators(ksp, Afine, Afine));
  PetscCall(KSPSetTolerances(ksp, 1e-8, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCMG));
  PetscCall(PCMGSetLevels(pc, 2, NULL));
  PetscCall(PCMGSetInterpolation(pc, 1, P));
  PetscCall(PCMGGetCoarseSolve(pc, &inner));
  PetscCall(KSPSetOperators(inner, A[0], A[0]));
  PetscCall(KSPSetFromOptions(ksp));
  PetscCall(MatCreateVecs(Afine, &x, &b));
  PetscCall(Load(b, 1));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(Afine, b, x, PETSC_FALSE, "PCMG"));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&b));
  PetscCall(MatDestroy(&P));
  PetscCall(MatDestroy(&Afine));
  PetscCall(MatDestroy(&A[0]));
  PetscCall(MatDestroy(&A[1]));
  PetscCall(DMDestroy(&fine));
  PetscCall(DMDestroy(&coarse));
  PetscFunctionReturn(0);
}

/* [A, D; D, A] with a diagonal D. */
static PetscErrorCode Fields(PetscInt n)
{
  PetscInt k, first, last;
  DM       da;
  Mat      A, D, blocks[4], N;
  Vec      b, x;
  IS       rows[2];
  KSP      ksp;
  PC       pc;

  PetscFunctionBeginUser;
  PetscCall(Grid(n, &da));
  PetscCall(Laplacian(da, &A));
  PetscCall(MatConvert(A, MATAIJ, MAT_INITIAL_MATRIX, &D));
  PetscCall(MatZeroEntries(D));
  PetscCall(MatGetOwnershipRange(D, &first, &last));
  for (k = first; k < last; k++) PetscCall(MatSetValue(D, k, k, 1e-2, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(D, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(D, MAT_FINAL_ASSEMBLY));
  for (k = 0; k < 4; k++) blocks[k] = k == 0 || k == 3 ? A : D;
  PetscCall(MatCreateNest(PETSC_COMM_WORLD, 2, NULL, 2, NULL, blocks, &N));
  PetscCall(MatNestGetISs(N, rows, NULL));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetOperators(ksp, N, N));
  PetscCall(KSPSetTolerances(ksp, 1e-8, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCFIELDSPLIT));
  for (k = 0; k < 2; k++) PetscCall(PCFieldSplitSetIS(pc, k ? "second" : "first", rows[k]));
  PetscCall(KSPSetFromOptions(ksp));
  PetscCall(MatCreateVecs(N, &x, &b));
  PetscCall(VecSet(b, 1));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(N, b, x, PETSC_FALSE, "PCFIELDSPLIT"));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&b));
  PetscCall(MatDestroy(&N));
  PetscCall(MatDestroy(&D));
  PetscCall(MatDestroy(&A));
  PetscCall(DMDestroy(&da));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  char      what[16] = "many";
  PetscInt  n        = 16;
  PetscBool is;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-do", what, sizeof(what), NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-n", &n, NULL));
  PetscCall(PetscStrcmp(what, "many", &is));
  if (is) PetscCall(Many(n));
  PetscCall(PetscStrcmp(what, "mg", &is));
  if (is) PetscCall(Multigrid(n));
  PetscCall(PetscStrcmp(what, "nest", &is));
  if (is) PetscCall(Fields(n));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "ok\n"));
  PetscCall(PetscFinalize());
  return 0;
}
