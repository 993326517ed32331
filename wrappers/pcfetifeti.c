/*
   PCFETIFETI: one application of the method as a preconditioner, to a tolerance or for a fixed number of iterations. It
   has a KSP of type fetifeti (kspfetifeti.c), whose options are those of the PC with -pc_fetifeti_ in front.
*/
#include "kspfetifeti.h"
#include <petsc/private/pcimpl.h>

typedef struct {
  KSP      ksp;
  PetscInt its; /* iterations of each application; 0: to the tolerance */
} PC_FETIFETI;

/* The relative tolerance of an application. */
#define FF_TOLERANCE 1e-2
/* Smaller than any residual that falls: the iterations alone end an application. */
#define FF_NEVER 1e-60

static PetscErrorCode Tolerances(PC pc)
{
  PC_FETIFETI *ff = (PC_FETIFETI *)pc->data;

  PetscFunctionBegin;
  if (ff->its) PetscCall(KSPSetTolerances(ff->ksp, FF_NEVER, FF_NEVER, PETSC_CURRENT, ff->its));
  else PetscCall(KSPSetTolerances(ff->ksp, FF_TOLERANCE, PETSC_CURRENT, PETSC_CURRENT, PETSC_CURRENT));
  PetscFunctionReturn(0);
}

static PetscErrorCode PCFETIFETIGetKSP_FETIFETI(PC pc, KSP *ksp)
{
  PC_FETIFETI *ff = (PC_FETIFETI *)pc->data;
  const char  *prefix;

  PetscFunctionBegin;
  if (!ff->ksp) {
    PetscCall(KSPCreate(PetscObjectComm((PetscObject)pc), &ff->ksp));
    PetscCall(PetscObjectIncrementTabLevel((PetscObject)ff->ksp, (PetscObject)pc, 1));
    PetscCall(PCGetOptionsPrefix(pc, &prefix));
    PetscCall(KSPSetOptionsPrefix(ff->ksp, prefix));
    PetscCall(KSPAppendOptionsPrefix(ff->ksp, "pc_"));
    PetscCall(KSPSetType(ff->ksp, "fetifeti"));
    /* The outer KSP looks at the residual. */
    ((KSP_FETIFETI *)ff->ksp->data)->true_residual = PETSC_FALSE;
    if (pc->dm) PetscCall(FFLendDM(ff->ksp, pc->dm));
    PetscCall(Tolerances(pc));
  }
  *ksp = ff->ksp;
  PetscFunctionReturn(0);
}

int ff_plugin_get_ksp(PC pc, KSP *ksp)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(pc, PC_CLASSID, 1);
  PetscUseMethod((PetscObject)pc, "PCFETIFETIGetKSP_C", (PC, KSP *), (pc, ksp));
  PetscFunctionReturn(0);
}

static PetscErrorCode PCSetFromOptions_FETIFETI(PC pc, FFOptionItems PetscOptionsObject)
{
  PC_FETIFETI *ff = (PC_FETIFETI *)pc->data;
  KSP          ksp;

  PetscFunctionBegin;
  PetscOptionsHeadBegin(PetscOptionsObject, "FETIFETI options");
  PetscCall(PetscOptionsInt("-pc_fetifeti_its", "Iterations of an application; 0: to the tolerance",
                            "PCFETIFETIGetKSP", ff->its, &ff->its, NULL));
  PetscOptionsHeadEnd();
  PetscCheck(ff->its >= 0, PetscObjectComm((PetscObject)pc), PETSC_ERR_ARG_OUTOFRANGE,
             "-pc_fetifeti_its is %" PetscInt_FMT ", expected a number of at least 0", ff->its);
  PetscCall(PCFETIFETIGetKSP_FETIFETI(pc, &ksp));
  PetscCall(Tolerances(pc));
  PetscFunctionReturn(0);
}

static PetscErrorCode PCSetUp_FETIFETI(PC pc)
{
  KSP                ksp;
  KSPConvergedReason failed;

  PetscFunctionBegin;
  PetscCall(PCFETIFETIGetKSP_FETIFETI(pc, &ksp));
  PetscCall(KSPSetOperators(ksp, pc->pmat, pc->pmat));
  PetscCall(KSPSetFromOptions(ksp));
  /* A matrix that is no stiffness matrix: the sentence goes to stderr, or is the error. */
  PetscCall(KSPSetErrorIfNotConverged(ksp, pc->erroriffailure));
  PetscCall(KSPSetUp(ksp));
  PetscCall(KSPSetErrorIfNotConverged(ksp, PETSC_FALSE));
  failed           = ((KSP_FETIFETI *)ksp->data)->failed;
  pc->failedreason = failed ? PC_SUBPC_ERROR : PC_NOERROR;
  PetscFunctionReturn(0);
}

/* y <- the method's approximation of A^-1 x; A is symmetric, so that this is the transposed application, too. */
static PetscErrorCode PCApply_FETIFETI(PC pc, Vec x, Vec y)
{
  PC_FETIFETI       *ff = (PC_FETIFETI *)pc->data;
  KSPConvergedReason reason;

  PetscFunctionBegin;
  PetscCall(KSPSolve(ff->ksp, x, y));
  PetscCall(KSPGetConvergedReason(ff->ksp, &reason));
  if (reason >= 0 || reason == KSP_DIVERGED_ITS) PetscFunctionReturn(0);
  PetscCheck(!pc->erroriffailure, PetscObjectComm((PetscObject)pc), PETSC_ERR_NOT_CONVERGED,
             "An application of the preconditioner fetifeti ended with %s", KSPConvergedReasons[reason]);
  pc->failedreason = PC_SUBPC_ERROR;
  PetscCall(FFSpoil(y));
  PetscFunctionReturn(0);
}

static PetscErrorCode PCReset_FETIFETI(PC pc)
{
  PC_FETIFETI *ff = (PC_FETIFETI *)pc->data;

  PetscFunctionBegin;
  if (ff->ksp) PetscCall(KSPReset(ff->ksp));
  PetscFunctionReturn(0);
}

static PetscErrorCode PCDestroy_FETIFETI(PC pc)
{
  PC_FETIFETI *ff = (PC_FETIFETI *)pc->data;

  PetscFunctionBegin;
  PetscCall(KSPDestroy(&ff->ksp));
  PetscCall(PetscObjectComposeFunction((PetscObject)pc, "PCFETIFETIGetKSP_C", NULL));
  PetscCall(PetscFree(pc->data));
  PetscFunctionReturn(0);
}

static PetscErrorCode PCView_FETIFETI(PC pc, PetscViewer viewer)
{
  PC_FETIFETI *ff = (PC_FETIFETI *)pc->data;
  PetscBool    ascii;

  PetscFunctionBegin;
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (ascii && ff->its)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  each application: %" PetscInt_FMT " iterations\n", ff->its));
  if (!ff->ksp) PetscFunctionReturn(0);
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(KSPView(ff->ksp, viewer));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(0);
}

PetscErrorCode PCCreate_FETIFETI(PC pc)
{
  PC_FETIFETI *ff;

  PetscFunctionBegin;
  PetscCall(PetscNew(&ff));
  pc->data                = (void *)ff;
  pc->ops->setup          = PCSetUp_FETIFETI;
  pc->ops->apply          = PCApply_FETIFETI;
  pc->ops->applytranspose = PCApply_FETIFETI;
  pc->ops->setfromoptions = PCSetFromOptions_FETIFETI;
  pc->ops->reset          = PCReset_FETIFETI;
  pc->ops->destroy        = PCDestroy_FETIFETI;
  pc->ops->view           = PCView_FETIFETI;
  PetscCall(PetscObjectComposeFunction((PetscObject)pc, "PCFETIFETIGetKSP_C", PCFETIFETIGetKSP_FETIFETI));
  PetscFunctionReturn(0);
}
