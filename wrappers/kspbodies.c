/* What the host says of a KSPFETIFETI: bodies by rank, by rows, or by a label of the mesh; primal unknowns. */
#include "kspfetifeti.h"
#include <petscdmplex.h>

/* The label value of most of this rank's cells, the lowest in a tie; -1 on a rank without cells. */
PetscErrorCode ff_label_body(KSP ksp, Mat A, const char *name, PetscInt *body)
{
  DM        dm = ksp->dm;
  DMLabel   label;
  PetscBool plex = PETSC_FALSE;
  PetscInt  first, last, c, v, n = 0, most = 0, *values;

  PetscFunctionBegin;
  *body = -1;
  if (dm) PetscCall(PetscObjectTypeCompare((PetscObject)dm, DMPLEX, &plex));
  if (!plex) PetscCall(MatGetDM(A, &dm));
  if (!plex && dm) PetscCall(PetscObjectTypeCompare((PetscObject)dm, DMPLEX, &plex));
  PetscCheck(plex, PetscObjectComm((PetscObject)ksp), PETSC_ERR_ARG_WRONGSTATE,
             "The label %s is to name the bodies, but neither the KSP nor its operator has a DMPlex: "
             "expected KSPSetDM(), or an operator of DMCreateMatrix()",
             name);
  PetscCall(DMGetLabel(dm, name, &label));
  PetscCheck(label, PetscObjectComm((PetscObject)ksp), PETSC_ERR_ARG_WRONG,
             "The DMPlex has no label %s that could name the bodies", name);
  PetscCall(DMPlexGetHeightStratum(dm, 0, &first, &last));
  PetscCall(PetscMalloc1(last - first, &values));
  for (c = first; c < last; c++) PetscCall(DMLabelGetValue(label, c, &values[c - first]));
  PetscCall(PetscSortInt(last - first, values));
  for (c = 0; c < last - first; c += v) {
    for (v = 1; c + v < last - first && values[c + v] == values[c]; v++) { }
    if (values[c] >= 0 && v > most) {
      *body = values[c];
      most  = v;
    }
    n++;
  }
  if (n > 1)
    PetscCall(PetscInfo(ksp,
                        "This rank's cells have %" PetscInt_FMT " values of the label %s; "
                        "its subdomain belongs to body %" PetscInt_FMT "\n",
                        n, name, *body));
  PetscCheck(*body >= 0 || first == last, PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG,
             "No cell of this rank has a value of at least 0 of the label %s, expected one for every cell", name);
  PetscCall(PetscFree(values));
  PetscFunctionReturn(0);
}

/* Forgets the bodies that were named before. */
static PetscErrorCode Forget(KSP_FETIFETI *ff)
{
  PetscFunctionBegin;
  PetscCall(ISDestroy(&ff->bodies));
  PetscCall(PetscFree(ff->label));
  ff->body  = -1;
  ff->stale = PETSC_TRUE;
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPFETIFETISetBody_FETIFETI(KSP ksp, PetscInt body)
{
  KSP_FETIFETI *ff = (KSP_FETIFETI *)ksp->data;

  PetscFunctionBegin;
  PetscCheck(body >= 0, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "The body of a rank is %" PetscInt_FMT ", expected a number of at least 0", body);
  if (ff->body == body) PetscFunctionReturn(0);
  PetscCall(Forget(ff));
  ff->body = body;
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPFETIFETISetBodyIS_FETIFETI(KSP ksp, IS bodies)
{
  KSP_FETIFETI *ff = (KSP_FETIFETI *)ksp->data;

  PetscFunctionBegin;
  PetscCall(PetscObjectReference((PetscObject)bodies));
  PetscCall(Forget(ff));
  ff->bodies = bodies;
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPFETIFETISetBodyLabel_FETIFETI(KSP ksp, const char *name)
{
  KSP_FETIFETI *ff = (KSP_FETIFETI *)ksp->data;
  PetscBool     same;

  PetscFunctionBegin;
  PetscCall(PetscStrcmp(ff->label, name, &same));
  if (same) PetscFunctionReturn(0);
  PetscCall(Forget(ff));
  PetscCall(PetscStrallocpy(name, &ff->label));
  PetscFunctionReturn(0);
}

int ff_plugin_set_body(KSP ksp, PetscInt body)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(ksp, KSP_CLASSID, 1);
  PetscTryMethod((PetscObject)ksp, "KSPFETIFETISetBody_C", (KSP, PetscInt), (ksp, body));
  PetscFunctionReturn(0);
}

int ff_plugin_set_body_is(KSP ksp, IS bodies)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(ksp, KSP_CLASSID, 1);
  PetscValidHeaderSpecific(bodies, IS_CLASSID, 2);
  PetscTryMethod((PetscObject)ksp, "KSPFETIFETISetBodyIS_C", (KSP, IS), (ksp, bodies));
  PetscFunctionReturn(0);
}

int ff_plugin_set_body_label(KSP ksp, const char *name)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(ksp, KSP_CLASSID, 1);
  PetscTryMethod((PetscObject)ksp, "KSPFETIFETISetBodyLabel_C", (KSP, const char *), (ksp, name));
  PetscFunctionReturn(0);
}

static PetscErrorCode KSPFETIFETISetPrimalDofs_FETIFETI(KSP ksp, IS dofs)
{
  KSP_FETIFETI *ff = (KSP_FETIFETI *)ksp->data;

  PetscFunctionBegin;
  if (dofs) PetscCall(PetscObjectReference((PetscObject)dofs));
  PetscCall(ISDestroy(&ff->primal));
  ff->primal = dofs;
  ff->stale  = PETSC_TRUE;
  PetscFunctionReturn(0);
}

int ff_plugin_set_primal(KSP ksp, IS dofs)
{
  PetscFunctionBegin;
  PetscValidHeaderSpecific(ksp, KSP_CLASSID, 1);
  if (dofs) PetscValidHeaderSpecific(dofs, IS_CLASSID, 2);
  PetscTryMethod((PetscObject)ksp, "KSPFETIFETISetPrimalDofs_C", (KSP, IS), (ksp, dofs));
  PetscFunctionReturn(0);
}

PetscErrorCode ff_compose_bodies(KSP ksp)
{
  PetscFunctionBegin;
  PetscCall(PetscObjectComposeFunction((PetscObject)ksp, "KSPFETIFETISetBody_C", KSPFETIFETISetBody_FETIFETI));
  PetscCall(PetscObjectComposeFunction((PetscObject)ksp, "KSPFETIFETISetBodyIS_C", KSPFETIFETISetBodyIS_FETIFETI));
  PetscCall(PetscObjectComposeFunction((PetscObject)ksp, "KSPFETIFETISetBodyLabel_C",
                                       KSPFETIFETISetBodyLabel_FETIFETI));
  PetscCall(PetscObjectComposeFunction((PetscObject)ksp, "KSPFETIFETISetPrimalDofs_C",
                                       KSPFETIFETISetPrimalDofs_FETIFETI));
  PetscFunctionReturn(0);
}

PetscErrorCode ff_forget_bodies(KSP ksp)
{
  PetscFunctionBegin;
  PetscCall(Forget((KSP_FETIFETI *)ksp->data));
  PetscCall(ISDestroy(&((KSP_FETIFETI *)ksp->data)->primal));
  PetscCall(PetscObjectComposeFunction((PetscObject)ksp, "KSPFETIFETISetBody_C", NULL));
  PetscCall(PetscObjectComposeFunction((PetscObject)ksp, "KSPFETIFETISetBodyIS_C", NULL));
  PetscCall(PetscObjectComposeFunction((PetscObject)ksp, "KSPFETIFETISetBodyLabel_C", NULL));
  PetscCall(PetscObjectComposeFunction((PetscObject)ksp, "KSPFETIFETISetPrimalDofs_C", NULL));
  PetscFunctionReturn(0);
}
