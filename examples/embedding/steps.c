/*
   The load steps of a scene in a program on PETSc: energy and contact force of each.

     mpicc steps.c -o steps $(pkg-config --cflags --libs fetifeti_step)
     mpirun -n 2 ./steps -scene ../scenes/press_ramp.toml
*/
static const char help[] = "Load steps of a scene.\n";

#include "fetifeti_step.h"

int main(int argc, char **argv)
{
  FetiFetiStep           step;
  const FetiFetiStepRow *rows;
  char                   scene[PETSC_MAX_PATH_LEN] = "../scenes/press_ramp.toml";
  PetscBool              solved;
  PetscInt               n, i;
  PetscReal              t, energy, force;

  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-scene", scene, sizeof(scene), NULL));
  PetscCall(FetiFetiStepCreate(PETSC_COMM_WORLD, scene, &step));
  PetscCall(FetiFetiStepNext(step, &solved));
  while (solved) {
    PetscCall(FetiFetiStepGetTime(step, &t));
    PetscCall(FetiFetiStepGetEnergy(step, &energy));
    PetscCall(FetiFetiStepGetContact(step, &n, &rows));
    for (i = 0, force = 0; i < n; i++) force += rows[i].inequality ? rows[i].multiplier : 0;
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "t %g energy %.6g force %.6g\n", (double)t, (double)energy,
                          (double)force));
    PetscCall(FetiFetiStepNext(step, &solved));
  }
  PetscCall(FetiFetiStepDestroy(&step));
  PetscCall(PetscFinalize());
  return 0;
}
