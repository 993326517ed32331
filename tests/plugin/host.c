/*
   A host program that knows nothing of FETI-FETI: Laplacians on a square of quadrilaterals, one strip of elements per
   rank, as a MATIS, and a KSP that takes its type from the options. What it does with the KSP is chosen by -do; it
   prints "ok" when everything was as it should be.
*/
static char help[] = "Solves with a KSP of any type in every way that programs do.\n";

#include <petscksp.h>

typedef struct {
  PetscInt  n;      /* elements per direction */
  PetscInt  idle;   /* ranks without elements, the last ones */
  PetscBool fixed;  /* held at the left side, else a null space */
  PetscReal skew;   /* added to one entry above the diagonal */
  PetscReal factor; /* of all entries */
  PetscReal shift;  /* subtracted from the diagonal of every element */
  PetscInt  hole;   /* this unknown has a zero on the diagonal; -1: none */
  PetscBool constant; /* the load is that of the solution one */
  char      nan[16]; /* what has an entry that is no number: load or matrix */
} Wanted;

/* The stiffness of a square element. */
static const PetscReal Ke[4][4] = {
  {4. / 6,  -1. / 6, -1. / 6, -2. / 6},
  {-1. / 6, 4. / 6,  -2. / 6, -1. / 6},
  {-1. / 6, -2. / 6, 4. / 6,  -1. / 6},
  {-2. / 6, -1. / 6, -1. / 6, 4. / 6 }
};

static PetscErrorCode Fill(MPI_Comm comm, const Wanted *wanted, Mat A)
{
  PetscMPIInt rank, size;
  PetscInt    n = wanted->n, strips, first, last, i, j, k, l;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  strips = size - wanted->idle;
  first  = rank < strips ? n * rank / strips : n;
  last   = rank < strips ? n * (rank + 1) / strips : n;
  PetscCall(MatZeroEntries(A));
  for (j = first; j < last; j++) {
    for (i = 0; i < n; i++) {
      PetscInt    dofs[4], low = (j - first) * (n + 1) + i;
      PetscScalar values[16];

      dofs[0] = low;
      dofs[1] = low + 1;
      dofs[2] = low + n + 1;
      dofs[3] = low + n + 2;
      for (k = 0; k < 4; k++)
        for (l = 0; l < 4; l++) values[4 * k + l] = wanted->factor * Ke[k][l];
      if (i == n / 2 && j == first) values[1] += wanted->skew;
      for (k = 0; k < 4; k++) {
        values[5 * k] -= wanted->shift;
        if (first * (n + 1) + dofs[k] == wanted->hole) values[5 * k] = 0;
      }
      if (i == 1 && j == n - 1 && !strcmp(wanted->nan, "matrix")) values[6] = values[9] = NAN;
      PetscCall(MatSetValuesLocal(A, 4, dofs, 4, dofs, values, ADD_VALUES));
    }
  }
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  if (wanted->fixed) {
    PetscInt *rows, count = rank == 0 ? n + 1 : 0;

    PetscCall(PetscMalloc1(n + 1, &rows));
    for (i = 0; i < count; i++) rows[i] = i;
    PetscCall(MatZeroRowsColumns(A, count, rows, wanted->factor, NULL, NULL));
    PetscCall(PetscFree(rows));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Build(MPI_Comm comm, const Wanted *wanted, Mat *A)
{
  PetscMPIInt            rank, size;
  PetscInt               n = wanted->n, N = (n + 1) * (n + 1), strips, first, last, count, i, *global;
  ISLocalToGlobalMapping map;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  strips = size - wanted->idle;
  first  = rank < strips ? n * rank / strips : n;
  last   = rank < strips ? n * (rank + 1) / strips : n;
  count  = last > first ? (last - first + 1) * (n + 1) : 0;
  PetscCall(PetscMalloc1(count + 1, &global));
  for (i = 0; i < count; i++) global[i] = first * (n + 1) + i;
  PetscCall(ISLocalToGlobalMappingCreate(comm, 1, count, global, PETSC_COPY_VALUES, &map));
  PetscCall(PetscFree(global));
  PetscCall(MatCreateIS(comm, 1, PETSC_DECIDE, PETSC_DECIDE, N, N, map, map, A));
  PetscCall(MatISSetPreallocation(*A, 9, NULL, 9, NULL));
  PetscCall(ISLocalToGlobalMappingDestroy(&map));
  PetscCall(Fill(comm, wanted, *A));
  if (!wanted->fixed && wanted->shift == 0) {
    MatNullSpace nullsp;

    PetscCall(MatNullSpaceCreate(comm, PETSC_TRUE, 0, NULL, &nullsp));
    PetscCall(MatSetNullSpace(*A, nullsp));
    PetscCall(MatNullSpaceDestroy(&nullsp));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode Load(Mat A, int seed, Vec *b)
{
  MatNullSpace nullsp;
  PetscInt     i, first, last;

  PetscFunctionBeginUser;
  PetscCall(MatCreateVecs(A, NULL, b));
  PetscCall(VecGetOwnershipRange(*b, &first, &last));
  for (i = first; i < last; i++)
    PetscCall(VecSetValue(*b, i, PetscSinReal((PetscReal)(seed * (i + 1))), INSERT_VALUES));
  PetscCall(VecAssemblyBegin(*b));
  PetscCall(VecAssemblyEnd(*b));
  PetscCall(MatGetNullSpace(A, &nullsp));
  if (nullsp) PetscCall(MatNullSpaceRemove(nullsp, *b));
  PetscFunctionReturn(0);
}

/* ||b - A x|| / ||b|| must be below the tolerance, and x close to what CG finds on the assembled matrix. */
static PetscErrorCode Check(KSP ksp, Mat A, Vec b, Vec x, const char *what)
{
  MPI_Comm           comm = PetscObjectComm((PetscObject)ksp);
  KSP                plain;
  Mat                assembled;
  Vec                r;
  PC                 pc;
  MatNullSpace       nullsp;
  PetscReal          rtol, norm, size, error, length;
  KSPConvergedReason reason;

  PetscFunctionBeginUser;
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCheck(reason > 0, comm, PETSC_ERR_PLIB, "%s: %s", what, KSPConvergedReasons[reason]);
  PetscCall(KSPGetTolerances(ksp, &rtol, NULL, NULL, NULL));
  PetscCall(VecDuplicate(b, &r));
  PetscCall(MatMult(A, x, r));
  PetscCall(VecAYPX(r, -1.0, b));
  PetscCall(VecNorm(r, NORM_2, &norm));
  PetscCall(VecNorm(b, NORM_2, &size));
  PetscCheck(norm <= 1.01 * rtol * size, comm, PETSC_ERR_PLIB, "%s: residual %g of %g, expected %g of it", what,
             (double)norm, (double)size, (double)rtol);
  PetscCall(MatConvert(A, MATAIJ, MAT_INITIAL_MATRIX, &assembled));
  PetscCall(MatGetNullSpace(A, &nullsp));
  PetscCall(MatSetNullSpace(assembled, nullsp));
  PetscCall(KSPCreate(comm, &plain));
  PetscCall(KSPSetOperators(plain, assembled, assembled));
  PetscCall(KSPSetType(plain, KSPCG));
  PetscCall(KSPGetPC(plain, &pc));
  PetscCall(PCSetType(pc, PCJACOBI));
  PetscCall(KSPSetTolerances(plain, 1e-13, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSolve(plain, b, r));
  if (nullsp) PetscCall(MatNullSpaceRemove(nullsp, r));
  PetscCall(VecNorm(r, NORM_2, &length));
  PetscCall(VecAXPY(r, -1.0, x));
  PetscCall(VecNorm(r, NORM_2, &error));
  PetscCheck(error <= 1e3 * rtol * length, comm, PETSC_ERR_PLIB, "%s: error %g of %g", what, (double)error,
             (double)length);
  PetscCall(KSPDestroy(&plain));
  PetscCall(MatDestroy(&assembled));
  PetscCall(VecDestroy(&r));
  PetscFunctionReturn(0);
}

static PetscErrorCode Solver(MPI_Comm comm, Mat A, const char *prefix, KSP *ksp)
{
  PetscFunctionBeginUser;
  PetscCall(KSPCreate(comm, ksp));
  PetscCall(KSPSetOptionsPrefix(*ksp, prefix));
  PetscCall(KSPSetOperators(*ksp, A, A));
  PetscCall(KSPSetFromOptions(*ksp));
  PetscFunctionReturn(0);
}

/* The load of the only solve, with an entry that is no number if that is wanted. */
static PetscErrorCode Spoil(const Wanted *wanted, Vec b)
{
  PetscInt first, last, i = (wanted->n + 1) * wanted->n + 2;

  PetscFunctionBeginUser;
  if (strcmp(wanted->nan, "load")) PetscFunctionReturn(0);
  PetscCall(VecGetOwnershipRange(b, &first, &last));
  if (i >= first && i < last) PetscCall(VecSetValue(b, i, NAN, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(b));
  PetscCall(VecAssemblyEnd(b));
  PetscFunctionReturn(0);
}

/* One system from beginning to end. */
static PetscErrorCode Once(MPI_Comm comm, const Wanted *wanted, const char *prefix, PetscBool check)
{
  Mat A;
  Vec b, x;
  KSP ksp;

  PetscFunctionBeginUser;
  PetscCall(Build(comm, wanted, &A));
  PetscCall(Load(A, 1, &b));
  if (wanted->constant) {
    Vec one;

    PetscCall(VecDuplicate(b, &one));
    PetscCall(VecSet(one, 1));
    PetscCall(MatMult(A, one, b));
    PetscCall(VecDestroy(&one));
  }
  PetscCall(Spoil(wanted, b));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(Solver(comm, A, prefix, &ksp));
  PetscCall(KSPSolve(ksp, b, x));
  if (check) PetscCall(Check(ksp, A, b, x, "one solve"));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(0);
}

/* The same KSP for another load, a changed operator, another operator, after a reset, and from a guess. */
static PetscErrorCode Again(MPI_Comm comm, Wanted wanted)
{
  Mat A, C;
  Vec b, x, c;
  KSP ksp;
  const PetscReal *history;
  PetscInt         its, entries;

  PetscFunctionBeginUser;
  PetscCall(Build(comm, &wanted, &A));
  PetscCall(Load(A, 1, &b));
  PetscCall(Load(A, 2, &c));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(Solver(comm, A, NULL, &ksp));
  PetscCall(KSPSetResidualHistory(ksp, NULL, 1000, PETSC_TRUE));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, A, b, x, "first solve"));
  PetscCall(KSPGetIterationNumber(ksp, &its));
  PetscCall(KSPGetResidualHistory(ksp, &history, &entries));
  PetscCheck(entries == its + 1, comm, PETSC_ERR_PLIB, "%" PetscInt_FMT " residuals of %" PetscInt_FMT " iterations",
             entries, its);
  PetscCall(KSPSolve(ksp, c, x));
  PetscCall(Check(ksp, A, c, x, "another load"));
  PetscCall(KSPSetInitialGuessNonzero(ksp, PETSC_TRUE));
  PetscCall(VecShift(x, wanted.fixed ? 0.3 : 0.0));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, A, b, x, "from a guess"));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, A, b, x, "from the solution"));
  PetscCall(KSPSetInitialGuessNonzero(ksp, PETSC_FALSE));
  wanted.factor = 7;
  PetscCall(Fill(comm, &wanted, A));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, A, b, x, "changed entries"));
  PetscCall(MatScale(A, 0.25));
  PetscCall(KSPSetOperators(ksp, A, A));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, A, b, x, "changed entries, said so"));
  PetscCall(KSPReset(ksp));
  PetscCall(KSPSetOperators(ksp, A, A));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, A, b, x, "after a reset"));
  wanted.factor = 3;
  PetscCall(Build(comm, &wanted, &C));
  PetscCall(KSPSetOperators(ksp, C, C));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, C, b, x, "another operator"));
  PetscCall(KSPSetType(ksp, KSPCG));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, C, b, x, "another type"));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&c));
  PetscCall(VecDestroy(&x));
  PetscCall(MatDestroy(&A));
  PetscCall(MatDestroy(&C));
  PetscFunctionReturn(0);
}

/* Two solvers at the same time. */
static PetscErrorCode Two(MPI_Comm comm, Wanted wanted)
{
  Mat A, C;
  Vec b, x, y;
  KSP one, two;

  PetscFunctionBeginUser;
  PetscCall(Build(comm, &wanted, &A));
  wanted.factor = 5;
  PetscCall(Build(comm, &wanted, &C));
  PetscCall(Load(A, 1, &b));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(VecDuplicate(b, &y));
  PetscCall(Solver(comm, A, "one_", &one));
  PetscCall(Solver(comm, C, "two_", &two));
  PetscCall(KSPSetUp(one));
  PetscCall(KSPSetUp(two));
  PetscCall(KSPSolve(one, b, x));
  PetscCall(KSPSolve(two, b, y));
  PetscCall(Check(one, A, b, x, "one"));
  PetscCall(Check(two, C, b, y, "two"));
  PetscCall(KSPDestroy(&one));
  PetscCall(KSPSolve(two, x, y));
  PetscCall(Check(two, C, x, y, "the one that is left"));
  PetscCall(KSPDestroy(&two));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscCall(MatDestroy(&A));
  PetscCall(MatDestroy(&C));
  PetscFunctionReturn(0);
}

/* Bodies by hand: every rank its own. */
static PetscErrorCode Bodies(MPI_Comm comm, const Wanted *wanted)
{
  Mat         A;
  Vec         b, x;
  KSP         ksp;
  PetscMPIInt rank;
  PetscErrorCode (*set)(KSP, PetscInt);

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(Build(comm, wanted, &A));
  PetscCall(Load(A, 1, &b));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(Solver(comm, A, NULL, &ksp));
  PetscCall(PetscObjectQueryFunction((PetscObject)ksp, "KSPFETIFETISetBody_C", &set));
  PetscCheck(set, comm, PETSC_ERR_PLIB, "the KSP has no bodies");
  PetscCall((*set)(ksp, 100 + rank));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, A, b, x, "bodies by hand"));
  PetscCall((*set)(ksp, rank / 2));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, A, b, x, "other bodies"));
  PetscCall(KSPView(ksp, PETSC_VIEWER_STDOUT_(comm)));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(0);
}

/* A matrix that cannot be factored: no error, but a reason. */
static PetscErrorCode Unfit(MPI_Comm comm, Wanted wanted)
{
  Mat                A;
  Vec                b, x;
  KSP                ksp;
  KSPConvergedReason reason;

  PetscFunctionBeginUser;
  wanted.factor = -1;
  PetscCall(Build(comm, &wanted, &A));
  PetscCall(Load(A, 1, &b));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(Solver(comm, A, NULL, &ksp));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCheck(reason == KSP_DIVERGED_PC_FAILED, comm, PETSC_ERR_PLIB, "negative matrix: %s",
             KSPConvergedReasons[reason]);
  /* and a good one after that */
  wanted.factor = 1;
  PetscCall(Fill(comm, &wanted, A));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(Check(ksp, A, b, x, "repaired matrix"));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  Wanted      wanted = {12, 0, PETSC_TRUE, 0, 1, 0, -1, PETSC_FALSE, ""};
  char        what[64] = "once";
  PetscInt    cycles   = 10, i;
  PetscBool   same;
  PetscMPIInt rank, size;
  MPI_Comm    comm;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-do", what, sizeof(what), NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-n", &wanted.n, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-idle", &wanted.idle, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-cycles", &cycles, NULL));
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-skew", &wanted.skew, NULL));
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-shift", &wanted.shift, NULL));
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-constant", &wanted.constant, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-hole", &wanted.hole, NULL));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-no_number", wanted.nan, sizeof(wanted.nan), NULL));
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-fixed", &wanted.fixed, NULL));
  comm = PETSC_COMM_WORLD;
  PetscCall(PetscStrcmp(what, "once", &same));
  if (same) PetscCall(Once(comm, &wanted, NULL, PETSC_TRUE));
  PetscCall(PetscStrcmp(what, "again", &same));
  if (same) PetscCall(Again(comm, wanted));
  PetscCall(PetscStrcmp(what, "two", &same));
  if (same) PetscCall(Two(comm, wanted));
  PetscCall(PetscStrcmp(what, "bodies", &same));
  if (same) PetscCall(Bodies(comm, &wanted));
  PetscCall(PetscStrcmp(what, "unfit", &same));
  if (same) PetscCall(Unfit(comm, wanted));
  PetscCall(PetscStrcmp(what, "split", &same));
  if (same) { /* the halves solve different problems, and one of them twice */
    PetscCallMPI(MPI_Comm_split(PETSC_COMM_WORLD, rank < size / 2 ? 0 : 1, rank, &comm));
    if (rank < size / 2) wanted.n += 3;
    PetscCall(Once(comm, &wanted, NULL, PETSC_TRUE));
    if (rank < size / 2) PetscCall(Once(comm, &wanted, NULL, PETSC_TRUE));
    PetscCallMPI(MPI_Comm_free(&comm));
    comm = PETSC_COMM_WORLD;
  }
  PetscCall(PetscStrcmp(what, "cycles", &same));
  if (same) {
    PetscLogDouble before = 0, after;

    for (i = 0; i < cycles; i++) {
      PetscCall(Once(comm, &wanted, NULL, PETSC_FALSE));
      if (i == cycles / 10) PetscCall(PetscMemoryGetCurrentUsage(&before));
    }
    PetscCall(PetscMemoryGetCurrentUsage(&after));
    PetscCall(PetscPrintf(comm, "bytes per cycle: %.0f\n", (double)((after - before) / (cycles - cycles / 10))));
  }
  PetscCall(PetscPrintf(comm, "ok\n"));
  PetscCall(PetscFinalize());
  return 0;
}
