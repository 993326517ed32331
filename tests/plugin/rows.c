/*
   A chain of bars of springs, one subdomain and body each, dealt out over the ranks. Rows join the bars, and each row
   shares an unknown with the next, so that all of them are one block; other rows have held unknowns. Ranks give rows
   that have nothing to do with their own bars: -shift says which. Every solution is compared with a direct one.
*/
static const char help[] = "Rows that are connected over the ranks.\n";

#include "fetifeti.h"

#define BARS 8
#define LEN  4 /* unknowns of a bar */
#define N    (BARS * LEN)
#define ROWS (BARS + 1)
#define MOST 4 /* terms of a row */

typedef struct {
  PetscInt    n, dof[MOST];
  PetscScalar c[MOST];
  PetscReal   gap;
} Row;

static PetscBool Held(PetscInt dof)
{
  return (PetscBool)(dof % LEN == 0 && (dof / LEN) % 2 == 0);
}

static PetscReal Value(PetscInt dof, PetscReal load)
{
  return 0.01 * load * (1 + dof);
}

static void Term(Row *row, PetscInt bar, PetscInt i, PetscScalar c)
{
  row->dof[row->n] = bar * LEN + i;
  row->c[row->n++] = c;
}

static void Rows(PetscReal gap, Row rows[])
{
  PetscInt r;

  for (r = 0; r < ROWS; r++) {
    rows[r].n   = 0;
    rows[r].gap = gap * (1 + r);
  }
  for (r = 0; r < BARS - 1; r++) {
    Term(&rows[r], r + 1, LEN - 1, 0.25);
    Term(&rows[r], r, LEN - 1, 0.5);
    Term(&rows[r], r + 1, r % 2, -1); /* not the first unknown of an even bar, which is held */
    Term(&rows[r], r, LEN - 1, 0.5);  /* twice the same unknown: terms are added up */
  }
  /* a row with held unknowns of other bars, and one that has no others */
  Term(&rows[BARS - 1], 0, 1, 1);
  Term(&rows[BARS - 1], 4, 0, -0.5);
  Term(&rows[BARS - 1], 6, 0, 2);
  Term(&rows[BARS], 2, 0, 1);
  Term(&rows[BARS], 6, 0, -1);
}

static PetscReal Load(PetscInt dof, PetscReal load)
{
  return Held(dof) ? 0 : load * PetscSinReal(1.0 + dof);
}

/* K u + B' lambda = f, B u = g with all bars on each rank; the row without unknowns is left out. */
static PetscErrorCode Direct(const Row rows[], PetscReal load, PetscScalar u[])
{
  const PetscInt     n = N + ROWS;
  PetscInt           i, r, t;
  Mat                A;
  Vec                b, x;
  KSP                ksp;
  PC                 pc;
  const PetscScalar *v;

  PetscFunctionBeginUser;
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, n, n, NULL, &A));
  PetscCall(MatCreateVecs(A, &x, &b));
  for (i = 0; i < N; i++) {
    if (i % LEN < LEN - 1) {
      const PetscInt    at[2] = {i, i + 1};
      const PetscScalar k[4]  = {1, -1, -1, 1};

      PetscCall(MatSetValues(A, 2, at, 2, at, k, ADD_VALUES));
    }
    PetscCall(VecSetValue(b, i, Load(i, load), INSERT_VALUES));
  }
  for (r = 0; r < BARS; r++) {
    PetscCall(VecSetValue(b, N + r, rows[r].gap, INSERT_VALUES));
    for (t = 0; t < rows[r].n; t++) {
      PetscCall(MatSetValue(A, N + r, rows[r].dof[t], rows[r].c[t], ADD_VALUES));
      PetscCall(MatSetValue(A, rows[r].dof[t], N + r, rows[r].c[t], ADD_VALUES));
    }
  }
  PetscCall(MatSetValue(A, N + BARS, N + BARS, 1, ADD_VALUES));
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  for (i = 0; i < N; i++) {
    if (!Held(i)) continue;
    PetscCall(MatZeroRows(A, 1, &i, 1, NULL, NULL));
    PetscCall(VecSetValue(b, i, Value(i, load), INSERT_VALUES));
  }
  PetscCall(KSPCreate(PETSC_COMM_SELF, &ksp));
  PetscCall(KSPSetOperators(ksp, A, A));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(VecGetArrayRead(x, &v));
  for (i = 0; i < n; i++) u[i] = v[i];
  PetscCall(VecRestoreArrayRead(x, &v));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(MatDestroy(&A));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(0);
}

/* Solves and compares displacements and the multipliers of this rank's rows, mine of them. */
static PetscErrorCode Check(FetiFeti ff, const char what[], const Row rows[], PetscReal load, PetscInt mine,
                            const PetscInt number[])
{
  PetscScalar        exact[N + ROWS];
  const PetscScalar *u;
  PetscReal          worst = 0, all, lambda[ROWS];
  PetscInt           first, last, i;
  Vec                b, x, held;
  IS                 is;
  KSPConvergedReason reason;
  PetscInt           dofs[N], n = 0;

  PetscFunctionBeginUser;
  PetscCall(Direct(rows, load, exact));
  PetscCall(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, N, &b));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(VecDuplicate(b, &held));
  PetscCall(VecGetOwnershipRange(b, &first, &last));
  for (i = first; i < last; i++) {
    PetscCall(VecSetValue(b, i, Load(i, load), INSERT_VALUES));
    if (Held(i)) PetscCall(VecSetValue(held, i, Value(i, load), INSERT_VALUES));
    if (Held(i)) dofs[n++] = i;
  }
  PetscCall(VecAssemblyBegin(b));
  PetscCall(VecAssemblyEnd(b));
  PetscCall(VecAssemblyBegin(held));
  PetscCall(VecAssemblyEnd(held));
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, n, dofs, PETSC_COPY_VALUES, &is));
  PetscCall(FetiFetiSetDirichletBoundaries(ff, is, held));
  PetscCall(FetiFetiSolve(ff, b, x));
  PetscCall(FetiFetiGetConvergedReason(ff, &reason));
  PetscCheck(reason > 0, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "%s: reason %d", what, (int)reason);
  PetscCall(FetiFetiGetMultipliers(ff, mine, lambda));
  for (i = 0; i < mine; i++) worst = PetscMax(worst, PetscAbsReal(lambda[i] - exact[N + number[i]]));
  PetscCall(VecGetArrayRead(x, &u));
  for (i = first; i < last; i++) worst = PetscMax(worst, PetscAbsReal(u[i - first] - exact[i]));
  PetscCall(VecRestoreArrayRead(x, &u));
  PetscCallMPI(MPI_Allreduce(&worst, &all, 1, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s: off by %g\n", what, (double)all));
  PetscCheck(all < 1e-7, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "%s: off by %g", what, (double)all);
  PetscCall(ISDestroy(&is));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&held));
  PetscFunctionReturn(0);
}

/* Gives the rows of this rank; their number and numbers are returned. */
static PetscErrorCode Give(FetiFeti ff, const Row rows[], PetscInt shift, PetscInt *mine, PetscInt number[])
{
  PetscMPIInt rank, size;
  PetscInt    r, t, n = 0, ia[ROWS + 1] = {0}, ja[ROWS * MOST], kind[ROWS];
  PetscScalar a[ROWS * MOST];
  PetscReal   gap[ROWS];

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  for (r = 0; r < ROWS; r++) {
    if ((shift < 0 ? -shift : r + shift) % size != rank) continue;
    ia[n + 1] = ia[n];
    for (t = 0; t < rows[r].n; t++) {
      ja[ia[n + 1]]  = rows[r].dof[t];
      a[ia[n + 1]++] = rows[r].c[t];
    }
    gap[n]      = rows[r].gap;
    kind[n]     = FETIFETI_EQUALITY;
    number[n++] = r;
  }
  *mine = n;
  PetscCall(FetiFetiSetContactRows(ff, n, ia, ja, a, gap, kind));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  FetiFeti    ff;
  PetscMPIInt rank, size;
  PetscInt    bar, i, mine, number[ROWS], shift = 0;
  PetscReal   gaps[ROWS];
  Row         rows[ROWS];

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-shift", &shift, NULL));
  PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
  PetscCall(FetiFetiSetFromOptions(ff));
  PetscCall(FetiFetiSetSizes(ff, PETSC_DECIDE, N));
  for (bar = rank; bar < BARS; bar += size) {
    PetscInt    ia[LEN + 1] = {0}, ja[3 * LEN], dofs[LEN], nnz = 0;
    PetscScalar a[3 * LEN];

    for (i = 0; i < LEN; i++) {
      const PetscInt beside = (i > 0) + (i < LEN - 1);

      dofs[i] = bar * LEN + i;
      if (i) {
        ja[nnz]  = i - 1;
        a[nnz++] = -1;
      }
      ja[nnz]  = i;
      a[nnz++] = beside;
      if (i < LEN - 1) {
        ja[nnz]  = i + 1;
        a[nnz++] = -1;
      }
      ia[i + 1] = nnz;
    }
    PetscCall(FetiFetiAddSubdomain(ff, bar, LEN, ia, ja, a, dofs));
  }
  Rows(0.1, rows);
  PetscCall(Give(ff, rows, shift, &mine, number));
  PetscCall(Check(ff, "rows", rows, 1, mine, number));
  PetscCall(Check(ff, "another load", rows, -3, mine, number));
  Rows(-0.3, rows);
  for (i = 0; i < mine; i++) gaps[i] = rows[number[i]].gap;
  PetscCall(FetiFetiSetContactGaps(ff, mine, gaps));
  PetscCall(Check(ff, "other gaps", rows, 1, mine, number));
  rows[3].c[0] = 0.75;
  PetscCall(Give(ff, rows, shift + 1, &mine, number));
  PetscCall(Check(ff, "other rows from other ranks", rows, 2, mine, number));
  PetscCall(Give(ff, rows, -1, &mine, number));
  PetscCall(Check(ff, "all rows from one rank", rows, 2, mine, number));
  PetscCall(FetiFetiDestroy(&ff));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "ok\n"));
  PetscCall(PetscFinalize());
  return 0;
}
