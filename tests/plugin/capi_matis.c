/*
   Blocks of plane elasticity, assembled into a MATIS each by a DMDA. -do matis, raw: one block by FetiFetiSetMatIS()
   and FetiFetiAddSubdomain(), against a direct solver. -do stack: two blocks one after the other, tied by pairs, judged
   by their own matrices. -do cycles: that again and again. -wrong does one thing wrong.
*/
static const char help[] = "Matrices and the C API.\n";

#include <petscdmcomposite.h>
#include <math.h>
#include "elastic.h"
#include "fetifeti.h"

/* Compares with a direct solver. */
static PetscErrorCode Compare(Mat A, Vec b, Vec x, const char what[])
{
  Mat       assembled;
  KSP       ksp;
  PC        pc;
  Vec       exact;
  PetscReal size, error;

  PetscFunctionBeginUser;
  PetscCall(MatConvert(A, MATAIJ, MAT_INITIAL_MATRIX, &assembled));
  PetscCall(VecDuplicate(b, &exact));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetOperators(ksp, assembled, assembled));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCREDUNDANT));
  PetscCall(KSPSolve(ksp, b, exact));
  PetscCall(VecNorm(exact, NORM_2, &size));
  PetscCall(VecAXPY(exact, -1.0, x));
  PetscCall(VecNorm(exact, NORM_2, &error));
  PetscCheck(error < 1e-7 * size, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "%s: off by %g of %g", what, (double)error,
             (double)size);
  PetscCall(KSPDestroy(&ksp));
  PetscCall(VecDestroy(&exact));
  PetscCall(MatDestroy(&assembled));
  PetscFunctionReturn(0);
}

/* One block in the ways that there are. */
static PetscErrorCode One(FetiFeti ff, PetscInt m, PetscBool raw)
{
  DM                     da;
  Mat                    A, local;
  Vec                    b, x, places;
  MatNullSpace           motions;
  ISLocalToGlobalMapping map;
  const PetscInt        *ia, *ja, *dofs;
  const PetscScalar     *a;
  PetscInt               n, k;
  PetscBool              done;

  PetscFunctionBeginUser;
  PetscCall(Block(m, PETSC_TRUE, (PetscBool)!raw, &da, &A, &b));
  PetscCall(VecDuplicate(b, &x));
  if (raw) {
    PetscCall(VecGetLocalSize(b, &n));
    PetscCall(FetiFetiSetSizes(ff, n, PETSC_DETERMINE));
    PetscCall(FetiFetiSetBlockSize(ff, 2));
    PetscCall(MatISGetLocalMat(A, &local));
    PetscCall(MatISGetLocalToGlobalMapping(A, &map, NULL));
    PetscCall(ISLocalToGlobalMappingGetIndices(map, &dofs));
    PetscCall(MatGetRowIJ(local, 0, PETSC_FALSE, PETSC_FALSE, &n, &ia, &ja, &done));
    PetscCall(MatSeqAIJGetArrayRead(local, &a));
    PetscCall(FetiFetiAddSubdomain(ff, PETSC_DECIDE, n, ia, ja, a, dofs));
    PetscCall(MatSeqAIJRestoreArrayRead(local, &a));
    PetscCall(MatRestoreRowIJ(local, 0, PETSC_FALSE, PETSC_FALSE, &n, &ia, &ja, &done));
    PetscCall(ISLocalToGlobalMappingRestoreIndices(map, &dofs));
    PetscCall(MatISRestoreLocalMat(A, &local));
  }
  PetscCall(DMGetCoordinates(da, &places));
  PetscCall(MatNullSpaceCreateRigidBody(places, &motions));
  for (k = 0; k < 3; k++) { /* without motions, with, by the matrix */
    if (!raw) PetscCall(FetiFetiSetMatIS(ff, A, PETSC_DECIDE));
    PetscCall(FetiFetiSetNearNullSpace(ff, k == 1 ? motions : NULL));
    PetscCall(FetiFetiSolve(ff, b, x));
    PetscCall(Compare(A, b, x, raw ? "raw" : "matis"));
    PetscCall(VecScale(b, -2.0));
    if (!raw && k == 1) PetscCall(MatScale(A, 3.0));
  }
  PetscCall(MatNullSpaceDestroy(&motions));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&b));
  PetscCall(MatDestroy(&A));
  PetscCall(DMDestroy(&da));
  PetscFunctionReturn(0);
}

/* K u + B'l = f and B u = gap of the tied blocks, by their own matrices. */
static PetscErrorCode Balance(Mat A[2], Vec b[2], Vec u[2], IS side[2][2], PetscInt n, const PetscReal lambda[],
                              PetscReal gap)
{
  PetscInt        k, c, i, s;
  const PetscInt *dof;
  PetscReal       norm[2], size;
  Vec             r;
  VecScatter      scatter;
  Vec             part[2][2];

  PetscFunctionBeginUser;
  for (k = 0; k < 2; k++) {
    PetscCall(VecDuplicate(b[k], &r));
    PetscCall(MatMult(A[k], u[k], r));
    PetscCall(VecAYPX(r, -1.0, b[k]));
    PetscCall(VecNorm(b[k], NORM_2, &size));
    for (c = 0; c < 2; c++) {
      PetscCall(ISGetIndices(side[k][c], &dof));
      for (i = 0; i < n; i++) PetscCall(VecSetValue(r, dof[i], (k ? 1 : -1) * lambda[c * n + i], ADD_VALUES));
      PetscCall(ISRestoreIndices(side[k][c], &dof));
      PetscCall(VecCreateMPI(PETSC_COMM_WORLD, n, PETSC_DETERMINE, &part[k][c]));
      PetscCall(VecScatterCreate(u[k], side[k][c], part[k][c], NULL, &scatter));
      PetscCall(VecScatterBegin(scatter, u[k], part[k][c], INSERT_VALUES, SCATTER_FORWARD));
      PetscCall(VecScatterEnd(scatter, u[k], part[k][c], INSERT_VALUES, SCATTER_FORWARD));
      PetscCall(VecScatterDestroy(&scatter));
    }
    PetscCall(VecAssemblyBegin(r));
    PetscCall(VecAssemblyEnd(r));
    PetscCall(VecNorm(r, NORM_2, &norm[0]));
    PetscCheck(norm[0] < 1e-6 * size, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "block %d is out of balance by %g", (int)k,
               (double)norm[0]);
    PetscCall(VecDestroy(&r));
  }
  for (c = 0; c < 2; c++) {
    PetscCall(VecAXPY(part[0][c], -1.0, part[1][c]));
    PetscCall(VecShift(part[0][c], c ? -gap : 0.0));
    PetscCall(VecNorm(part[0][c], NORM_INFINITY, &size));
    PetscCheck(size < 1e-6, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "the sides differ by %g in component %d", (double)size,
               (int)c);
    for (s = 0; s < 2; s++) PetscCall(VecDestroy(&part[s][c]));
  }
  PetscFunctionReturn(0);
}

/* The numbers among all unknowns of those of one matrix; `where` has them for the rows that a rank owns. */
static PetscErrorCode Numbers(Vec b, IS where, IS side, IS *all)
{
  PetscInt        total, n, i, first, last, *mine, *every;
  const PetscInt *list;

  PetscFunctionBeginUser;
  PetscCall(VecGetSize(b, &total));
  PetscCall(VecGetOwnershipRange(b, &first, &last));
  PetscCall(PetscCalloc2(total, &mine, total, &every));
  PetscCall(ISGetIndices(where, &list));
  for (i = first; i < last; i++) mine[i] = list[i - first];
  PetscCall(ISRestoreIndices(where, &list));
  PetscCallMPI(MPI_Allreduce(mine, every, total, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD));
  PetscCall(ISGetLocalSize(side, &n));
  PetscCall(ISGetIndices(side, &list));
  for (i = 0; i < n; i++) mine[i] = every[list[i]];
  PetscCall(ISRestoreIndices(side, &list));
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, n, mine, PETSC_COPY_VALUES, all));
  PetscCall(PetscFree2(mine, every));
  PetscFunctionReturn(0);
}

/* Two blocks one after the other; the top of the one and the bottom of the other are tied with a gap in between. */
static PetscErrorCode Two(FetiFeti ff, PetscInt m, DM da[2], Mat A[2], Vec b[2], PetscBool judge, const char wrong[])
{
  DM             pack;
  Vec            load, u, plain, x, values, to[2], *parts;
  IS             side[2][2], all[2], own, *where, held;
  AO             ao;
  PetscReal     *gap, *lambda, norm[2], other;
  PetscInt       k, c, i, n, *ia, *ja, *kind, count;
  PetscScalar   *row;
  PetscMPIInt    rank, size;
  PetscBool      is;
  MatNullSpace   space;
  Mat            assembled;
  const PetscInt *number;

  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  n = rank == size - 1 ? m : 0;
  for (k = 0; k < 2; k++)
    for (c = 0; c < 2; c++) {
      PetscCall(ISCreateStride(PETSC_COMM_WORLD, n, (k ? 0 : 2 * m * (m - 1)) + c, 2, &side[k][c]));
      PetscCall(DMDAGetAO(da[k], &ao));
      PetscCall(AOApplicationToPetscIS(ao, side[k][c]));
    }
  PetscCall(PetscCalloc6(n, &gap, 2 * n, &lambda, n + 1, &ia, 2 * n, &ja, n, &kind, 2 * n, &row));
  for (i = 0; i < n; i++) gap[i] = 0.125;
  PetscCall(VecCreateNest(PETSC_COMM_WORLD, 2, NULL, b, &load));
  PetscCall(VecDuplicate(load, &u));
  PetscCall(DMCompositeCreate(PETSC_COMM_WORLD, &pack)); /* which numbers in the same way */
  for (k = 0; k < 2; k++) PetscCall(DMCompositeAddDM(pack, da[k]));
  PetscCall(DMCreateGlobalVector(pack, &plain));
  PetscCall(DMCompositeGetGlobalISs(pack, &where));
  PetscCall(DMCompositeGetAccess(pack, plain, &to[0], &to[1]));
  for (k = 0; k < 2; k++) PetscCall(VecCopy(b[k], to[k]));
  PetscCall(DMCompositeRestoreAccess(pack, plain, &to[0], &to[1]));
  PetscCall(VecDuplicate(plain, &x));

  for (k = 0; k < 2; k++) PetscCall(FetiFetiAddMatIS(ff, A[k], NULL, k));
  PetscCall(PetscStrcmp(wrong, "mixed", &is));
  if (is) {
    PetscCall(ISCreateStride(PETSC_COMM_WORLD, 0, 0, 1, &own));
    PetscCall(FetiFetiAddMatIS(ff, A[1], own, 1));
  }
  PetscCall(PetscStrcmp(wrong, "raw", &is));
  if (is) PetscCall(FetiFetiAddSubdomain(ff, 0, 0, NULL, NULL, NULL, NULL));
  PetscCall(PetscStrcmp(wrong, "type", &is));
  if (is) {
    PetscCall(MatConvert(A[0], MATAIJ, MAT_INITIAL_MATRIX, &assembled));
    PetscCall(FetiFetiAddMatIS(ff, assembled, NULL, 0));
  }
  PetscCall(PetscStrcmp(wrong, "size", &is));
  if (is) PetscCall(FetiFetiSetSizes(ff, PETSC_DECIDE, 7));
  PetscCall(PetscStrcmp(wrong, "near", &is));
  if (is) {
    Vec short_one;

    PetscCall(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, 12, &short_one));
    PetscCall(VecSet(short_one, 1 / PetscSqrtReal(12.0)));
    PetscCall(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, 1, &short_one, &space));
    PetscCall(FetiFetiSetNearNullSpace(ff, space));
  }
  PetscCall(PetscStrcmp(wrong, "matrix", &is));
  if (is) PetscCall(FetiFetiSetContactPairs(ff, 2, side[0][0], 1, side[1][0], NULL, FETIFETI_EQUALITY));
  PetscCall(PetscStrcmp(wrong, "same", &is));
  if (is) PetscCall(FetiFetiSetContactPairs(ff, 1, side[1][0], 1, side[1][0], NULL, FETIFETI_EQUALITY));
  PetscCall(PetscStrcmp(wrong, "sort", &is));
  if (is) PetscCall(FetiFetiSetContactPairs(ff, 0, side[0][0], 1, side[1][0], NULL, 9));
  PetscCall(PetscStrcmp(wrong, "finite", &is));
  if (is && n) gap[1] = NAN;
  PetscCall(PetscStrcmp(wrong, "missing", &is));
  if (is) PetscCall(FetiFetiSetContactPairs(ff, 0, side[0][0], 1, NULL, gap, FETIFETI_EQUALITY));
  PetscCall(PetscStrcmp(wrong, "length", &is));
  if (is) {
    PetscCall(ISCreateStride(PETSC_COMM_WORLD, 3, 0, 1, &own));
    PetscCall(FetiFetiSetContactPairs(ff, 0, side[0][0], 1, own, NULL, FETIFETI_EQUALITY));
  }
  PetscCall(PetscStrcmp(wrong, "range", &is));
  if (is) {
    PetscCall(ISCreateStride(PETSC_COMM_WORLD, n, 2 * m * m - 2, 1, &own));
    PetscCall(FetiFetiSetContactPairs(ff, 0, side[0][0], 1, own, NULL, FETIFETI_EQUALITY));
  }
  PetscCall(FetiFetiSetContactPairs(ff, 0, side[0][0], 1, side[1][0], NULL, FETIFETI_EQUALITY));
  PetscCall(FetiFetiSetContactPairs(ff, 0, side[0][1], 1, side[1][1], gap, FETIFETI_EQUALITY));
  PetscCall(PetscStrcmp(wrong, "gone", &is));
  if (is) PetscCall(FetiFetiSetMatIS(ff, A[0], PETSC_DECIDE));
  PetscCall(PetscStrcmp(wrong, "nest", &is));
  if (is) {
    Vec three[3] = {b[0], b[1], b[1]};

    PetscCall(VecCreateNest(PETSC_COMM_WORLD, 3, NULL, three, &load));
  }
  PetscCall(PetscStrcmp(wrong, "part", &is));
  if (is) {
    Vec two[2] = {b[0], NULL};

    PetscCall(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, 12, &two[1]));
    PetscCall(VecCreateNest(PETSC_COMM_WORLD, 2, NULL, two, &load));
  }
  PetscCall(VecNorm(u, NORM_2, &norm[0]));
  PetscCall(FetiFetiSolve(ff, load, u));
  PetscCall(VecNorm(u, NORM_2, &norm[1])); /* not the norm that PETSc remembers from before */
  PetscCheck(norm[0] == 0.0 && norm[1] > 0.0, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "the norms are %g and %g",
             (double)norm[0], (double)norm[1]);
  if (judge) {
    PetscCall(FetiFetiGetMultipliers(ff, 2 * n, lambda));
    PetscCall(VecNestGetSubVecs(u, NULL, &parts));
    PetscCall(Balance(A, b, parts, side, n, lambda, 0.125));
    PetscCall(FetiFetiSolve(ff, plain, x)); /* plain vectors, and a nested one for the solution */
    PetscCall(VecNorm(x, NORM_2, &other));
    PetscCheck(PetscAbsReal(other - norm[1]) < 1e-7 * other, PETSC_COMM_WORLD, PETSC_ERR_PLIB,
               "a plain vector gives %g, a nested one %g", (double)other, (double)norm[1]);
    PetscCall(VecSet(u, 0.0));
    PetscCall(FetiFetiSolve(ff, plain, u));
    PetscCall(Balance(A, b, parts, side, n, lambda, 0.125));

    /* the first component by pairs of all unknowns, the other one by rows */
    PetscCall(FetiFetiSetContactPairs(ff, 0, NULL, 0, NULL, NULL, 0));
    for (k = 0; k < 2; k++) {
      PetscCall(Numbers(b[k], where[k], side[k][0], &all[k]));
      PetscCall(Numbers(b[k], where[k], side[k][1], &own));
      PetscCall(ISGetIndices(own, &number));
      for (i = 0; i < n; i++) {
        ja[2 * i + k]  = number[i];
        row[2 * i + k] = k ? -1 : 1;
        ia[i + 1]      = 2 * (i + 1);
        kind[i]        = FETIFETI_EQUALITY;
      }
      PetscCall(ISRestoreIndices(own, &number));
      PetscCall(ISDestroy(&own));
    }
    PetscCall(FetiFetiSetContactRows(ff, n, ia, ja, row, gap, kind));
    PetscCall(FetiFetiSetContactPairs(ff, PETSC_DECIDE, all[0], PETSC_DECIDE, all[1], NULL, FETIFETI_EQUALITY));
    PetscCall(FetiFetiSetContactRows(ff, n, ia, ja, row, gap, kind)); /* again: after the pairs now */
    for (k = 0; k < 2; k++) PetscCall(ISDestroy(&all[k]));
    PetscCall(FetiFetiSolve(ff, load, u));
    PetscCall(FetiFetiGetMultipliers(ff, 2 * n, lambda));
    PetscCall(Balance(A, b, parts, side, n, lambda, 0.125));

    PetscCall(VecDuplicate(load, &values)); /* a held unknown of the second block, its value in a nested vector */
    PetscCall(VecSet(values, 0.5));
    PetscCall(ISGetLocalSize(where[1], &count));
    PetscCall(ISGetIndices(where[1], &number));
    PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, rank == 0 && count ? 1 : 0, number + (count ? count - 1 : 0),
                              PETSC_COPY_VALUES, &held));
    PetscCall(ISRestoreIndices(where[1], &number));
    PetscCall(FetiFetiSetDirichletBoundaries(ff, held, values));
    PetscCall(FetiFetiSolve(ff, load, u));
    if (rank == 0 && count) {
      const PetscScalar *v;

      PetscCall(VecGetArrayRead(parts[1], &v));
      PetscCheck(PetscAbsReal(v[count - 1] - 0.5) < 1e-12, PETSC_COMM_SELF, PETSC_ERR_PLIB, "a held unknown is %g",
                 (double)v[count - 1]);
      PetscCall(VecRestoreArrayRead(parts[1], &v));
    }
    PetscCall(ISDestroy(&held));
    PetscCall(VecDestroy(&values));
  }
  for (k = 0; k < 2; k++) {
    for (c = 0; c < 2; c++) PetscCall(ISDestroy(&side[k][c]));
    PetscCall(ISDestroy(&where[k]));
  }
  PetscCall(PetscFree(where));
  PetscCall(DMDestroy(&pack));
  PetscCall(PetscFree6(gap, lambda, ia, ja, kind, row));
  PetscCall(VecDestroy(&load));
  PetscCall(VecDestroy(&u));
  PetscCall(VecDestroy(&plain));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  FetiFeti       ff;
  DM             da[2];
  Mat            A[2];
  Vec            b[2];
  PetscInt       m = 9, cycles = 0, i, k;
  char           what[20] = "stack", wrong[20] = "";
  PetscBool      two, raw, near = PETSC_TRUE;
  PetscLogDouble before = 0, after = 0;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-m", &m, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-cycles", &cycles, NULL));
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-near", &near, NULL));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-do", what, sizeof(what), NULL));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-wrong", wrong, sizeof(wrong), NULL));
  PetscCall(PetscStrcmp(what, "stack", &two));
  PetscCall(PetscStrcmp(what, "raw", &raw));
  if (two) {
    for (k = 0; k < 2; k++) PetscCall(Block(m, (PetscBool)!k, near, &da[k], &A[k], &b[k]));
    for (i = 0; i < PetscMax(1, cycles); i++) {
      PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
      PetscCall(FetiFetiSetFromOptions(ff));
      PetscCall(Two(ff, m, da, A, b, (PetscBool)!cycles, wrong));
      PetscCall(FetiFetiDestroy(&ff));
      if (i == cycles / 10) PetscCall(PetscMemoryGetCurrentUsage(&before));
    }
    PetscCall(PetscMemoryGetCurrentUsage(&after));
    if (cycles)
      PetscCall(PetscPrintf(PETSC_COMM_WORLD, "bytes per cycle: %.0f\n",
                            (double)((after - before) / (cycles - cycles / 10))));
    for (k = 0; k < 2; k++) {
      PetscCall(VecDestroy(&b[k]));
      PetscCall(MatDestroy(&A[k]));
      PetscCall(DMDestroy(&da[k]));
    }
  } else {
    PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
    PetscCall(FetiFetiSetFromOptions(ff));
    PetscCall(One(ff, m, raw));
    PetscCall(FetiFetiDestroy(&ff));
  }
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "ok\n"));
  PetscCall(PetscFinalize());
  return 0;
}
