/*
   KSPMatSolve() for KSPFETIFETI: several right-hand sides at once.
*/
#include "kspfetifeti.h"

/* Solves for all columns of B. After the first one the iterations of the others run together; then each is finished as
   KSPSolve() does it. */
PetscErrorCode KSPMatSolve_FETIFETI(KSP ksp, Mat B, Mat X)
{
  KSP_FETIFETI      *ff = (KSP_FETIFETI *)ksp->data;
  Mat                A;
  Vec               *b, *x, *r, rhs = ksp->vec_rhs, sol = ksp->vec_sol, column;
  MatNullSpace       kernel;
  FetiFetiWishes     wishes;
  PetscReal          norm;
  PetscInt           n, i, its = 0;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  int                status = 0;

  PetscFunctionBegin;
  PetscCall((*ksp->ops->setup)(ksp));
  PetscCall(KSPGetOperators(ksp, &A, NULL));
  PetscCall(MatGetNullSpace(A, &kernel));
  PetscCall(MatGetSize(B, NULL, &n));
  PetscCall(MatCreateVecs(A, &column, NULL));
  PetscCall(VecDuplicateVecs(column, n, &b));
  PetscCall(VecDuplicateVecs(column, n, &x));
  PetscCall(VecDuplicateVecs(column, n, &r));
  PetscCall(VecDestroy(&column));
  for (i = 0; i < n; i++) {
    PetscCall(MatDenseGetColumnVecRead(B, i, &column));
    PetscCall(VecCopy(column, b[i]));
    PetscCall(MatDenseRestoreColumnVecRead(B, i, &column));
    PetscCall(MatDenseGetColumnVecRead(X, i, &column));
    PetscCall(VecCopy(column, x[i]));
    PetscCall(MatDenseRestoreColumnVecRead(X, i, &column));
    PetscCall(ff_load(ksp, A, kernel, b[i], x[i], r[i], r[i], &norm));
  }
  for (i = 0; i < n && !status; i++) {
    PetscErrorCode ierr;

    ksp->vec_rhs = b[i];
    ksp->vec_sol = x[i];
    if (i == 1 && n > 2 && ff->solver) { /* the directions of the first column serve the others */
      ff->base    = 0;
      ff->last    = -1;
      ff->running = PETSC_TRUE;
      PetscCall(ff_wishes(ksp, &wishes));
      status      = fetifeti_plugin_together(ff->solver, &wishes, (int)n - 1, r + 1);
      ff->running = PETSC_FALSE;
      if (status) break;
    }
    ff->begun = i - 1;
    ierr      = (*ksp->ops->solve)(ksp);
    ff->begun = -1;
    if (ierr) {
      ksp->vec_rhs = rhs;
      ksp->vec_sol = sol;
    }
    PetscCall(ierr);
    its = PetscMax(its, ksp->its);
    if (!reason || reason > 0) reason = ksp->reason; /* the first that failed */
    PetscCall(MatDenseGetColumnVecWrite(X, i, &column));
    PetscCall(VecCopy(x[i], column));
    PetscCall(MatDenseRestoreColumnVecWrite(X, i, &column));
  }
  ksp->vec_rhs = rhs;
  ksp->vec_sol = sol;
  ksp->its     = its;
  ksp->reason  = reason;
  PetscCall(VecDestroyVecs(n, &b));
  PetscCall(VecDestroyVecs(n, &x));
  PetscCall(VecDestroyVecs(n, &r));
  if (status) PetscCall(ff_raise(ksp, status));
  PetscFunctionReturn(0);
}
