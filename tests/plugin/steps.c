/*
   Solves the load steps of a scene, -scene FILE, and prints energy, contact force and displacements of each. With
   -checkpoint FILE the steps stop after the first one, with -resume FILE they go on from there. -wrong does one thing
   wrong.
*/
static const char help[] = "The functions of fetifeti_step.h.\n";

#include "fetifeti_step.h"

#define NAME 1024

static PetscErrorCode Show(FetiFetiStep step)
{
  const FetiFetiStepRow *rows;
  const char            *name;
  KSPConvergedReason     reason;
  PetscInt               number, its, bodies, b, n, i, active = 0;
  PetscReal              t, energy, force = 0, least = PETSC_MAX_REAL;

  PetscFunctionBeginUser;
  PetscCall(FetiFetiStepGetNumber(step, &number));
  PetscCall(FetiFetiStepGetTime(step, &t));
  PetscCall(FetiFetiStepGetEnergy(step, &energy));
  PetscCall(FetiFetiStepGetIterations(step, &its));
  PetscCall(FetiFetiStepGetConvergedReason(step, &reason, &name));
  PetscCall(FetiFetiStepGetContact(step, &n, &rows));
  for (i = 0; i < n; i++) {
    if (!rows[i].inequality) continue;
    force += rows[i].multiplier;
    active += rows[i].active;
    least = PetscMin(least, rows[i].gap);
  }
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "step %d t %.17g energy %.17g reason %d %s iterations %d rows %d active %d "
                                          "force %.12g gap %.3g\n", (int)number, (double)t, (double)energy,
                        (int)reason, name, (int)its, (int)n, (int)active, (double)force, (double)least));
  PetscCall(FetiFetiStepGetBodies(step, &bodies));
  for (b = 0; b < bodies; b++) {
    PetscInt   nodes, components;
    PetscReal *u, *x, lowest = PETSC_MAX_REAL;
    PetscMPIInt rank;

    PetscCall(FetiFetiStepGetBody(step, b, &name, &nodes, &components));
    PetscCall(PetscMalloc2(nodes * components, &u, 3 * nodes, &x));
    PetscCall(FetiFetiStepGetDisplacements(step, b, nodes * components, u));
    PetscCall(FetiFetiStepGetCoordinates(step, b, 3 * nodes, x));
    /* the lowest place of all nodes, on the last rank: all of them have it */
    for (i = 0; i < nodes; i++) lowest = PetscMin(lowest, x[3 * i + 1] + u[components * i + components - 1]);
    PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &rank));
    PetscCallMPI(MPI_Bcast(&lowest, 1, MPIU_REAL, rank - 1, PETSC_COMM_WORLD));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "body %s nodes %d components %d lowest %.12g\n", name, (int)nodes,
                          (int)components, (double)lowest));
    PetscCall(PetscFree2(u, x));
  }
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  FetiFetiStep step = NULL;
  char         scene[NAME] = "", checkpoint[NAME] = "", resume[NAME] = "", wrong[32] = "";
  PetscBool    solved, is;
  PetscInt     n;
  PetscReal    u;

  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-scene", scene, sizeof(scene), NULL));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-checkpoint", checkpoint, sizeof(checkpoint), NULL));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-resume", resume, sizeof(resume), NULL));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-wrong", wrong, sizeof(wrong), NULL));
  PetscCall(PetscStrcmp(wrong, "null", &is));
  if (is) PetscCall(FetiFetiStepNext(step, &solved));
  PetscCall(FetiFetiStepCreate(PETSC_COMM_WORLD, scene, &step));
  PetscCall(PetscStrcmp(wrong, "order", &is));
  if (is) PetscCall(FetiFetiStepGetEnergy(step, &u));
  if (resume[0]) PetscCall(FetiFetiStepResume(step, resume));
  PetscCall(FetiFetiStepNext(step, &solved));
  while (solved) {
    PetscCall(Show(step));
    PetscCall(PetscStrcmp(wrong, "body", &is));
    if (is) PetscCall(FetiFetiStepGetBody(step, 2, NULL, &n, NULL));
    PetscCall(PetscStrcmp(wrong, "room", &is));
    if (is) PetscCall(FetiFetiStepGetDisplacements(step, 0, 1, &u));
    PetscCall(PetscStrcmp(wrong, "late", &is));
    if (is) PetscCall(FetiFetiStepResume(step, "file"));
    if (checkpoint[0]) PetscCall(FetiFetiStepCheckpoint(step, checkpoint));
    if (checkpoint[0]) break;
    PetscCall(FetiFetiStepNext(step, &solved));
  }
  PetscCall(FetiFetiStepDestroy(&step));
  /* the options of the scene were there during the calls alone */
  PetscCall(PetscOptionsHasName(NULL, NULL, "-fetifeti_ksp_rtol", &is));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, is || step ? "something is left\n" : "ok\n"));
  PetscCall(PetscFinalize());
  return 0;
}
