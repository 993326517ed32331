/*
   Two bars of springs by raw arrays: body 0 is held at its left end at 0, body 1 at its right end at -d, and the ends
   between may come as close as the gap g. Spring constants are 1, so that the force between them is (d - g) / (2 N)
   where they touch. -wrong does one thing wrong.
*/
static const char help[] = "The functions of fetifeti.h on bars.\n";

#include "fetifeti.h"

#define SUBDOMAINS 3
#define LENGTH     4
#define N          (SUBDOMAINS * LENGTH)

static PetscErrorCode Bar(FetiFeti ff, PetscInt body, PetscInt s, const char wrong[])
{
  static PetscBool tied = PETSC_FALSE;
  PetscInt    ia[LENGTH + 2], ja[3 * (LENGTH + 1)], dofs[LENGTH + 1], i, nnz = 0, own = body;
  PetscScalar a[3 * (LENGTH + 1)];
  PetscBool   is;

  PetscFunctionBeginUser;
  /* the last subdomain of bar 0 is a body by itself, tied to the others */
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-tied", &tied, NULL));
  if (tied && body == 0 && s == SUBDOMAINS - 1) own = 7;
  if (tied && body == 1 && s == 0) own = 0; /* of a body that is in two pieces */
  for (i = 0; i <= LENGTH; i++) {
    ia[i]   = nnz;
    dofs[i] = body * (N + 1) + s * LENGTH + i;
    if (i) {
      ja[nnz]  = i - 1;
      a[nnz++] = -1;
    }
    ja[nnz]  = i;
    a[nnz++] = i && i < LENGTH ? 2 : 1;
    if (i < LENGTH) {
      ja[nnz]  = i + 1;
      a[nnz++] = -1;
    }
  }
  ia[LENGTH + 1] = nnz;
  PetscCall(PetscStrcmp(wrong, "symmetry", &is));
  if (is) a[4] = -0.5;
  PetscCall(PetscStrcmp(wrong, "column", &is));
  if (is) ja[1] = LENGTH + 1;
  PetscCall(PetscStrcmp(wrong, "start", &is));
  if (is) ia[1] = 9;
  PetscCall(PetscStrcmp(wrong, "dof", &is));
  if (is) dofs[1] = 1000;
  PetscCall(PetscStrcmp(wrong, "bodies", &is));
  PetscCall(FetiFetiAddSubdomain(ff, is && s == 1 ? PETSC_DECIDE : own, LENGTH + 1, ia, ja, a, dofs));
  PetscFunctionReturn(0);
}

/* Solves for one d and compares; kind as in FetiFetiSetContactRows(). */
static PetscErrorCode Check(FetiFeti ff, Vec held, Vec b, Vec x, PetscReal d, PetscReal g, PetscInt kind,
                            PetscBool mine)
{
  const PetscReal    force = (kind == FETIFETI_INEQUALITY && d < g) ? 0 : (d - g) / (2 * N);
  const PetscScalar *u;
  PetscInt           first, last, i;
  PetscReal          worst = 0, lambda = 0, kkt[4], all;
  KSPConvergedReason reason;

  PetscFunctionBeginUser;
  PetscCall(VecSetValue(held, 2 * N + 1, -d, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(held));
  PetscCall(VecAssemblyEnd(held));
  PetscCall(FetiFetiSolve(ff, b, x));
  PetscCall(FetiFetiGetConvergedReason(ff, &reason));
  PetscCheck(reason > 0, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "reason %d", (int)reason);
  PetscCall(FetiFetiGetKKT(ff, kkt));
  PetscCheck(kkt[0] < 1e-5 && kkt[3] >= 0, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "kkt %g %g", (double)kkt[0],
             (double)kkt[3]);
  if (mine) PetscCall(FetiFetiGetMultipliers(ff, 1, &lambda));
  if (mine) worst = PetscAbsReal(lambda - force) * N;
  PetscCall(VecGetOwnershipRange(x, &first, &last));
  PetscCall(VecGetArrayRead(x, &u));
  for (i = first; i < last; i++) {
    const PetscReal exact = i <= N ? -force * i : -d + force * (2 * N + 1 - i);

    worst = PetscMax(worst, PetscAbsReal(u[i - first] - exact));
  }
  PetscCall(VecRestoreArrayRead(x, &u));
  PetscCallMPI(MPI_Allreduce(&worst, &all, 1, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD));
  PetscCheck(all < 1e-6, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "d %g, g %g: off by %g", (double)d, (double)g, (double)all);
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  FetiFeti    ff;
  PetscMPIInt rank, size;
  PetscInt    s, k, its, ends[2] = {0, 2 * N + 1}, middle = LENGTH;
  PetscInt    ia[2] = {0, 2}, ja[2] = {N, N + 1}, kind = FETIFETI_INEQUALITY;
  PetscScalar row[2] = {1, -1};
  PetscReal   gap    = 0.5, least, most;
  PetscBool   last, is;
  Vec         b, x, held;
  IS          dofs, primal;
  KSP         inner;
  char        wrong[20] = "";

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-wrong", wrong, sizeof(wrong), NULL));
  last = (PetscBool)(rank == size - 1);
  PetscCall(PetscStrcmp(wrong, "null", &is));
  if (is) PetscCall(FetiFetiSetUp(NULL));
  PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
  PetscCall(FetiFetiSetOptionsPrefix(ff, "bar_"));
  PetscCall(FetiFetiSetFromOptions(ff));
  PetscCall(PetscStrcmp(wrong, "order", &is));
  if (is) PetscCall(FetiFetiGetIterations(ff, &its));
  PetscCall(FetiFetiSetSizes(ff, PETSC_DECIDE, 2 * N + 2));
  for (s = 0; s < 2 * SUBDOMAINS; s++) /* dealt out like cards */
    if (s % size == rank) PetscCall(Bar(ff, s / SUBDOMAINS, s % SUBDOMAINS, wrong));
  PetscCall(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, 2 * N + 2, &b));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(VecDuplicate(b, &held));
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, rank ? 0 : 2, ends, PETSC_COPY_VALUES, &dofs));
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, 1, &middle, PETSC_COPY_VALUES, &primal));
  PetscCall(FetiFetiSetDirichletBoundaries(ff, dofs, held));
  PetscCall(FetiFetiSetNeumannBoundaries(ff, NULL));
  PetscCall(FetiFetiSetPrimalDofs(ff, primal));
  PetscCall(PetscStrcmp(wrong, "row", &is));
  if (is) ja[1] = 2 * N + 7;
  PetscCall(PetscStrcmp(wrong, "kind", &is));
  if (is) kind = 2;
  PetscCall(FetiFetiSetContactRows(ff, last, ia, ja, row, &gap, &kind));
  PetscCall(PetscStrcmp(wrong, "vector", &is));
  if (is) {
    PetscCall(VecDestroy(&b));
    PetscCall(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, 2 * N + 5, &b));
  }
  for (k = 0; k < 4; k++) PetscCall(Check(ff, held, b, x, k == 2 ? 0.25 : 1 + k, gap, kind, last));
  PetscCall(PetscStrcmp(wrong, "room", &is));
  if (is) PetscCall(FetiFetiGetMultipliers(ff, 7, NULL));
  PetscCall(FetiFetiGetSpectrum(ff, &least, &most));
  PetscCall(FetiFetiGetInnerKSP(ff, &inner));
  PetscCall(FetiFetiView(ff, PETSC_VIEWER_STDOUT_WORLD));
  { /* a second row, at an unknown that bodies may share, by another rank: it does not bind */
    PetscInt    start[2] = {0, 1}, at = N - LENGTH, two = FETIFETI_INEQUALITY;
    PetscScalar one  = 1;
    PetscReal   far  = 0.001;

    if (size > 1) {
      PetscCall(FetiFetiSetContactRows(ff, rank == 0, start, &at, &one, &far, &two));
      if (last) PetscCall(FetiFetiSetContactRows(ff, 1, ia, ja, row, &gap, &kind));
      PetscCall(Check(ff, held, b, x, 2, gap, kind, last));
      PetscCall(FetiFetiSetContactRows(ff, 0, NULL, NULL, NULL, NULL, NULL));
    }
  }
  kind = FETIFETI_EQUALITY; /* the same as an equation: it pulls, too */
  PetscCall(FetiFetiSetContactRows(ff, last, ia, ja, row, &gap, &kind));
  for (k = 0; k < 2; k++) PetscCall(Check(ff, held, b, x, k, gap, kind, last));
  ja[1] = 2 * N + 1; /* an obstacle at a held unknown: u_N - u_{2N+1} = d + g with d known */
  PetscCall(FetiFetiSetContactRows(ff, last, ia, ja, row, &gap, &kind));
  PetscCall(FetiFetiSolve(ff, b, x));
  for (s = 0; s < 1; s++) {
    const PetscScalar *u;
    PetscInt           first, end;

    PetscCall(VecGetOwnershipRange(x, &first, &end));
    PetscCall(VecGetArrayRead(x, &u));
    if (first <= N && N < end)
      PetscCheck(PetscAbsReal(u[N - first] - (gap - 1)) < 1e-6, PETSC_COMM_SELF, PETSC_ERR_PLIB, "u_N is %g",
                 (double)u[N - first]);
    PetscCall(VecRestoreArrayRead(x, &u));
  }
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&held));
  PetscCall(ISDestroy(&dofs));
  PetscCall(ISDestroy(&primal));
  PetscCall(FetiFetiDestroy(&ff));
  PetscCheck(!ff, PETSC_COMM_WORLD, PETSC_ERR_PLIB, "the handle is still there");
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "ok\n"));
  PetscCall(PetscFinalize());
  return 0;
}
