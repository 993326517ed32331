/*
   KSPFETIFETI: the FETI-FETI method as a KSP for operators of type MATIS, in the manner of KSPFETIDP. The method is in
   Rust (src/embed, src/capi). This file has the functions that every KSP type must have; kspbodies.c has the functions
   for bodies, kspmatsolve.c those for several right-hand sides, kspregister.c makes the types known, pcfetifeti.c has
   the PC.
*/
#include "kspfetifeti.h"

/* Converts a status of Rust to a PETSc error. */
PetscErrorCode ff_raise(KSP ksp, int status)
{
  int         code;
  const char *message = fetifeti_plugin_message(&code);

  PetscFunctionBegin;
  if (status == FF_RAISED)
    PetscFunctionReturn(PetscError(PETSC_COMM_SELF, __LINE__, PETSC_FUNCTION_NAME, __FILE__, (PetscErrorCode)code,
                                   PETSC_ERROR_REPEAT, " "));
  SETERRQ(status == FF_ALONE ? PETSC_COMM_SELF : PetscObjectComm((PetscObject)ksp), (PetscErrorCode)code,
          "FETI-FETI: %s", message);
}

/* The inner KSP runs once or several times in a solve; monitors of the outer KSP see a single iteration count. */
static PetscErrorCode KSPMonitor_FETIFETI(KSP inner, PetscInt it, PetscReal rnorm, void *ctx)
{
  KSP           ksp = (KSP)ctx;
  KSP_FETIFETI *ff  = (KSP_FETIFETI *)ksp->data;

  PetscFunctionBegin;
  if (it == 0 && ff->last >= 0) {
    ff->base = ff->last;
    PetscFunctionReturn(0);
  }
  ff->last   = ff->base + it;
  ksp->its   = ff->last;
  ksp->rnorm = rnorm;
  PetscCall(KSPLogResidualHistory(ksp, rnorm));
  PetscCall(KSPMonitor(ksp, ff->last, rnorm));
  PetscFunctionReturn(0);
}

PetscErrorCode ff_wishes(KSP ksp, FetiFetiWishes *wishes)
{
  PetscFunctionBegin;
  wishes->body   = (int)((KSP_FETIFETI *)ksp->data)->body;
  wishes->bodies = ((KSP_FETIFETI *)ksp->data)->bodies;
  wishes->primal = ((KSP_FETIFETI *)ksp->data)->primal;
  wishes->goal   = -1;
  wishes->rtol   = ksp->rtol;
  wishes->abstol = ksp->abstol;
  wishes->divtol = ksp->divtol;
  wishes->max_it = (int)ksp->max_it;
  wishes->begun  = (int)((KSP_FETIFETI *)ksp->data)->begun;
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPReset_FETIFETI(KSP ksp)
{
  KSP_FETIFETI *ff = (KSP_FETIFETI *)ksp->data;

  PetscFunctionBegin;
  if (ff->solver) fetifeti_plugin_free(ff->solver);
  ff->solver = NULL;
  ff->failed = KSP_CONVERGED_ITERATING;
  PetscFunctionReturn(0);
}

/* The reason is a word; the sentence that explains it goes to stderr, where users see it without an option. */
static PetscErrorCode Explain(KSP ksp, KSPConvergedReason reason)
{
  int code;

  PetscFunctionBegin;
  PetscCall(PetscFPrintf(PetscObjectComm((PetscObject)ksp), PETSC_STDERR, "FETI-FETI: KSP_%s: %s\n",
                         KSPConvergedReasons[reason], fetifeti_plugin_message(&code)));
  PetscFunctionReturn(0);
}

/* The identities of the spaces that are attached to the operator. */
static PetscErrorCode Spaces(Mat A, PetscObjectId *near, PetscObjectId *null)
{
  MatNullSpace space;

  PetscFunctionBegin;
  *near = *null = 0;
  PetscCall(MatGetNearNullSpace(A, &space));
  if (space) PetscCall(PetscObjectGetId((PetscObject)space, near));
  PetscCall(MatGetNullSpace(A, &space));
  if (space) PetscCall(PetscObjectGetId((PetscObject)space, null));
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPSetUp_FETIFETI(KSP ksp)
{
  KSP_FETIFETI    *ff = (KSP_FETIFETI *)ksp->data;
  Mat              A;
  PetscObjectId    id, near, null;
  PetscObjectState state;
  FetiFetiWishes   wishes;
  KSP              inner;
  int              status;

  PetscFunctionBegin;
  PetscCall(KSPGetOperators(ksp, &A, NULL));
  PetscCall(PetscObjectGetId((PetscObject)A, &id));
  PetscCall(PetscObjectStateGet((PetscObject)A, &state));
  if ((ff->solver || ff->failed) && !ff->stale && id == ff->id && state == ff->state) PetscFunctionReturn(0);
  PetscCall(Spaces(A, &near, &null));
  /* Other entries of a matrix of the same structure: Rust looks whether it is the same. What follows from bodies,
     options and motions would be another one. */
  if (ff->stale || ff->whole || ff->failed || ff->label || near != ff->near || null != ff->null)
    PetscCall(KSPReset_FETIFETI(ksp));
  PetscCall(ff_wishes(ksp, &wishes));
  if (ff->label) {
    PetscInt body;

    PetscCall(ff_label_body(ksp, A, ff->label, &body));
    wishes.body   = (int)body;
    wishes.bodies = NULL;
  }
  status = fetifeti_plugin_setup(PetscObjectComm((PetscObject)ksp), A, ((PetscObject)ksp)->prefix, &wishes,
                                 &ff->solver);
  ff->id    = id;
  ff->near  = near;
  ff->null  = null;
  ff->stale = ff->whole = PETSC_FALSE;
  if (status == FF_UNFIT && !ksp->errorifnotconverged) {
    PetscCall(Explain(ksp, KSP_DIVERGED_PC_FAILED));
    ff->failed = KSP_DIVERGED_PC_FAILED;
  } else if (status) PetscCall(ff_raise(ksp, status));
  /* Reading a local matrix counts as a change of the operator. */
  PetscCall(PetscObjectStateGet((PetscObject)A, &ff->state));
  if (ff->solver) {
    inner = fetifeti_plugin_inner(ff->solver);
    PetscCall(PetscObjectIncrementTabLevel((PetscObject)inner, (PetscObject)ksp, 1));
    PetscCall(KSPMonitorSet(inner, KSPMonitor_FETIFETI, ksp, NULL));
  }
  PetscFunctionReturn(0);
}

/* r <- b - A x */
static PetscErrorCode Residual(Mat A, Vec B, Vec X, Vec R, PetscReal *norm)
{
  PetscFunctionBegin;
  PetscCall(MatMult(A, X, R));
  PetscCall(VecAYPX(R, -1.0, B));
  PetscCall(VecNorm(R, NORM_2, norm));
  PetscFunctionReturn(0);
}

/* A right-hand side without its part in the kernel, and what an initial guess leaves of it; R may be B. */
PetscErrorCode ff_load(KSP ksp, Mat A, MatNullSpace kernel, Vec b, Vec x, Vec B, Vec R, PetscReal *norm)
{
  PetscFunctionBegin;
  PetscCall(VecCopy(b, B));
  if (kernel) PetscCall(MatNullSpaceRemove(kernel, B));
  if (ksp->guess_zero) PetscCall(VecNorm(B, NORM_2, norm)); /* the copy keeps it */
  if (R != B) PetscCall(VecCopy(B, R));
  if (!ksp->guess_zero) PetscCall(Residual(A, B, x, R, norm));
  if (kernel) PetscCall(MatNullSpaceRemove(kernel, R));
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPSolve_FETIFETI(KSP ksp)
{
  KSP_FETIFETI  *ff = (KSP_FETIFETI *)ksp->data;
  Mat            A;
  Vec            B, R, D;
  MatNullSpace   nullsp;
  FetiFetiWishes wishes;
  FetiFetiResult result;
  PetscBool      kernel;
  PetscReal      norm, size;
  int            status = 0;

  PetscFunctionBegin;
  PetscCall(KSPSetUp_FETIFETI(ksp)); /* the operator may have changed without KSPSetOperators() */
  ksp->its = 0;
  if (!ff->solver) {
    ksp->reason = ff->failed;
    PetscCall(FFSpoil(ksp->vec_sol));
    PetscFunctionReturn(0);
  }
  PetscCall(KSPGetOperators(ksp, &A, NULL));
  PetscCall(MatGetNullSpace(A, &nullsp));
  PetscCall(VecDuplicate(ksp->vec_rhs, &B));
  PetscCall(VecDuplicate(B, &R));
  PetscCall(VecDuplicate(ksp->vec_sol, &D));
  ff->base = 0;
  ff->last = -1;
  ff->running     = PETSC_TRUE;
  result.largest  = 0;
  result.smallest = 0;
  result.explained = 0;
  PetscCall(ff_wishes(ksp, &wishes));
  PetscCall(ff_load(ksp, A, nullsp, ksp->vec_rhs, ksp->vec_sol, B, R, &norm));
  PetscCall(VecNorm(B, NORM_2, &size));
  /* The inner KSP tests the jumps between subdomains; the residual of the host's equations is tested in addition. */
  if (ff->true_residual) wishes.goal = PetscMax(ksp->rtol * (size > 0 ? size : norm), ksp->abstol);
  if (!ksp->guess_zero && norm <= PetscMax(ksp->rtol * (size > 0 ? size : norm), ksp->abstol)) {
    /* the guess is a solution */
    result.iterations = 0;
    result.reason     = norm <= ksp->abstol ? KSP_CONVERGED_ATOL : KSP_CONVERGED_RTOL;
    PetscCall(VecSet(D, 0.0));
  } else status = fetifeti_plugin_solve(ff->solver, A, &wishes, R, D, &result);
  if (!status) PetscCall(VecAXPY(ksp->vec_sol, 1.0, D)); /* x <- x + d */
  ff->running = PETSC_FALSE;
  if (!status && ff->last < 0) { /* nothing to iterate on: monitors see the initial residual, which is the final one */
    PetscCall(Residual(A, B, ksp->vec_sol, R, &norm));
    PetscCall(KSPMonitor_FETIFETI(NULL, 0, norm, ksp));
  }
  PetscCall(VecDestroy(&B));
  PetscCall(VecDestroy(&R));
  PetscCall(VecDestroy(&D));
  ff->running = PETSC_FALSE;
  if (status == FF_UNFIT && !ksp->errorifnotconverged) { /* a load that is no number */
    ksp->reason = KSP_DIVERGED_NANORINF;
    PetscCall(Explain(ksp, ksp->reason));
    PetscCall(FFSpoil(ksp->vec_sol));
    PetscFunctionReturn(0);
  }
  if (status) PetscCall(ff_raise(ksp, status));
  ff->largest  = result.largest;
  ff->smallest = result.smallest;
  if (nullsp) { /* vectors that the operator does not map to zero are no kernel, even if they are attached as one */
    PetscCall(MatNullSpaceTest(nullsp, A, &kernel));
    if (kernel) PetscCall(MatNullSpaceRemove(nullsp, ksp->vec_sol));
  }
  ksp->its    = result.iterations;
  ksp->reason = (KSPConvergedReason)result.reason;
  if (result.explained) PetscCall(Explain(ksp, ksp->reason));
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPSetFromOptions_FETIFETI(KSP ksp, FFOptionItems PetscOptionsObject)
{
  KSP_FETIFETI *ff = (KSP_FETIFETI *)ksp->data;
  char          name[PETSC_MAX_PATH_LEN];
  PetscBool     set;

  PetscFunctionBegin;
  PetscOptionsHeadBegin(PetscOptionsObject, "KSP FETIFETI options");
  PetscCall(PetscOptionsString("-fetifeti_body_label", "Label of the DMPlex's cells that names the bodies",
                               "KSPFETIFETISetBodyLabel", ff->label ? ff->label : "", name, sizeof(name), &set));
  if (set) PetscCall(ff_plugin_set_body_label(ksp, name));
  PetscCall(PetscOptionsBool("-fetifeti_true_residual",
                             "Go on until the residual of the assembled equations is below the tolerance", NULL,
                             ff->true_residual, &ff->true_residual, NULL));
  PetscOptionsHeadEnd();
  ff->whole = PETSC_TRUE; /* the method reads its options at the next set-up of everything */
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPDestroy_FETIFETI(KSP ksp)
{
  PetscFunctionBegin;
  PetscCall(KSPReset_FETIFETI(ksp));
  PetscCall(ff_forget_bodies(ksp));
  PetscCall(PetscObjectComposeFunction((PetscObject)ksp, "KSPFETIFETIGetInnerKSP_C", NULL));
  PetscCall(KSPDestroyDefault(ksp));
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPView_FETIFETI(KSP ksp, PetscViewer viewer)
{
  KSP_FETIFETI *ff = (KSP_FETIFETI *)ksp->data;
  FetiFetiFacts facts;
  PetscBool     ascii;

  PetscFunctionBegin;
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ff->solver) {
    if (ascii) PetscCall(PetscViewerASCIIPrintf(viewer, "  not set up\n"));
    PetscFunctionReturn(0);
  }
  fetifeti_plugin_facts(ff->solver, &facts);
  if (ascii) {
    PetscCall(PetscViewerASCIIPrintf(viewer, "  bodies: %d (%d floating, kernels of dimension %d), subdomains: %d\n",
                                     facts.bodies, facts.floating, facts.kernel, facts.subdomains));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  multipliers: %.0f inside bodies, %.0f between bodies\n",
                                     facts.local_rows, facts.global_rows));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  primal dofs: %d\n", facts.primal));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  scaling: %s\n", facts.scaling));
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %s\n", facts.work));
    PetscCall(PetscViewerASCIIPrintf(viewer, "Inner KSP solver details\n"));
  }
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(KSPView(fetifeti_plugin_inner(ff->solver), viewer));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(0);
}

/* The solution; the current iterate while the inner KSP runs, for monitors. */
static PetscErrorCode KSPBuildSolution_FETIFETI(KSP ksp, Vec v, Vec *V)
{
  KSP_FETIFETI *ff    = (KSP_FETIFETI *)ksp->data;
  int           there = 0, status;
  Vec           now;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(ksp->vec_sol, &now));
  if (ff->solver) {
    status = fetifeti_plugin_solution(ff->solver, now, &there);
    if (status) PetscCall(ff_raise(ksp, status));
  }
  if (there) PetscCall(VecAXPY(now, 1.0, ksp->vec_sol)); /* the iteration computes a correction of the initial guess */
  else PetscCall(VecCopy(ksp->vec_sol, now));
  if (v) {
    PetscCall(VecCopy(now, v));
    *V = v;
  } else {
    /* lent until the next call, as KSPBuildSolution() does it */
    PetscCall(PetscObjectCompose((PetscObject)ksp, "FetiFetiSolution", (PetscObject)now));
    *V = now;
  }
  PetscCall(VecDestroy(&now));
  PetscFunctionReturn(0);
}

static PetscErrorCode Inner(KSP ksp, KSP *inner)
{
  KSP_FETIFETI *ff = (KSP_FETIFETI *)ksp->data;

  PetscFunctionBegin;
  PetscCheck(ff->solver, PetscObjectComm((PetscObject)ksp), PETSC_ERR_ARG_WRONGSTATE, "Must call KSPSetUp() first");
  *inner = fetifeti_plugin_inner(ff->solver);
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPComputeEigenvalues_FETIFETI(KSP ksp, PetscInt nmax, PetscReal *r, PetscReal *c, PetscInt *neig)
{
  KSP inner;

  PetscFunctionBegin;
  PetscCall(Inner(ksp, &inner));
  PetscCall(KSPComputeEigenvalues(inner, nmax, r, c, neig));
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPComputeExtremeSingularValues_FETIFETI(KSP ksp, PetscReal *emax, PetscReal *emin)
{
  KSP_FETIFETI *ff = (KSP_FETIFETI *)ksp->data;
  KSP           inner;

  PetscFunctionBegin;
  PetscCall(Inner(ksp, &inner));
  if (ff->running || !(ff->smallest > 0)) PetscCall(KSPComputeExtremeSingularValues(inner, emax, emin));
  else {
    *emax = ff->largest;
    *emin = ff->smallest;
  }
  PetscFunctionReturn(0);
}

int ff_plugin_get_inner(KSP ksp, KSP *inner)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(ksp, KSP_CLASSID, 1);
  PetscUseMethod((PetscObject)ksp, "KSPFETIFETIGetInnerKSP_C", (KSP, KSP *), (ksp, inner));
  PetscFunctionReturn(0);
}

PetscErrorCode KSPCreate_FETIFETI(KSP ksp)
{
  KSP_FETIFETI *ff;
  PC            pc;

  PetscFunctionBegin;
  PetscCall(KSPSetSupportedNorm(ksp, KSP_NORM_NONE, PC_LEFT, 3));
  PetscCall(KSPSetSupportedNorm(ksp, KSP_NORM_NONE, PC_RIGHT, 2));
  PetscCall(KSPSetSupportedNorm(ksp, KSP_NORM_PRECONDITIONED, PC_LEFT, 2));
  PetscCall(KSPSetSupportedNorm(ksp, KSP_NORM_PRECONDITIONED, PC_RIGHT, 2));
  PetscCall(KSPSetSupportedNorm(ksp, KSP_NORM_UNPRECONDITIONED, PC_LEFT, 2));
  PetscCall(KSPSetSupportedNorm(ksp, KSP_NORM_UNPRECONDITIONED, PC_RIGHT, 2));
  PetscCall(KSPSetSupportedNorm(ksp, KSP_NORM_NATURAL, PC_LEFT, 2));

  PetscCall(PetscNew(&ff));
  ff->body                               = -1;
  ff->begun                              = -1;
  ff->true_residual                      = PETSC_TRUE;
  ksp->data                              = (void *)ff;
  ksp->ops->setup                        = KSPSetUp_FETIFETI;
  ksp->ops->solve                        = KSPSolve_FETIFETI;
  ksp->ops->matsolve                     = KSPMatSolve_FETIFETI;
  ksp->ops->reset                        = KSPReset_FETIFETI;
  ksp->ops->destroy                      = KSPDestroy_FETIFETI;
  ksp->ops->view                         = KSPView_FETIFETI;
  ksp->ops->setfromoptions               = KSPSetFromOptions_FETIFETI;
  ksp->ops->computeeigenvalues           = KSPComputeEigenvalues_FETIFETI;
  ksp->ops->computeextremesingularvalues = KSPComputeExtremeSingularValues_FETIFETI;
  ksp->ops->buildsolution                = KSPBuildSolution_FETIFETI;
  ksp->ops->buildresidual                = KSPBuildResidualDefault;
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCNONE));
  PetscCall(ff_compose_bodies(ksp));
  PetscCall(PetscObjectComposeFunction((PetscObject)ksp, "KSPFETIFETIGetInnerKSP_C", Inner));
  /* set up again with a new operator */
  ksp->setupnewmatrix = PETSC_TRUE;
  PetscFunctionReturn(0);
}
