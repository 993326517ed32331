/*
   The load steps of a scene with friction in a program on PETSc: normal force, friction and states of each, the largest
   slip and the largest ratio of shear to pressure.

     mpicc friction.c -o friction $(pkg-config --cflags --libs fetifeti_step)
     mpirun -n 2 ./friction -scene slipping_block.toml
*/
static const char help[] = "Friction in the load steps of a scene.\n";

#include "fetifeti_step.h"

static PetscReal Length(const PetscReal v[3])
{
  return PetscSqrtReal(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

int main(int argc, char **argv)
{
  FetiFetiStep           step;
  const FetiFetiStepRow *row;
  char                   scene[PETSC_MAX_PATH_LEN] = "slipping_block.toml";
  PetscBool              solved;
  PetscInt               n, i, c, stick, slip;
  PetscReal              t, normal, friction[3], slid, ratio;

  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-scene", scene, sizeof(scene), NULL));
  PetscCall(FetiFetiStepCreate(PETSC_COMM_WORLD, scene, &step));
  PetscCall(FetiFetiStepNext(step, &solved));
  while (solved) {
    PetscCall(FetiFetiStepGetTime(step, &t));
    PetscCall(FetiFetiStepGetContact(step, &n, &row));
    normal = slid = ratio = friction[0] = friction[1] = friction[2] = 0;
    for (i = stick = slip = 0; i < n; i++) {
      if (!row[i].inequality) continue;
      normal += row[i].multiplier;
      /* on the first body: minus the force with which it drags the other side along */
      for (c = 0; c < 3; c++) friction[c] -= row[i].friction[c];
      stick += row[i].state == FETIFETI_STICK;
      slip += row[i].state == FETIFETI_SLIP;
      slid = PetscMax(slid, Length(row[i].slip));
      if (row[i].multiplier > 0) ratio = PetscMax(ratio, Length(row[i].friction) / row[i].multiplier);
    }
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "t %g normal %.8f friction %.8f stick %d slip %d slid %.6f ratio %.6f\n",
                          (double)t, (double)normal, (double)Length(friction), (int)stick, (int)slip, (double)slid,
                          (double)ratio));
    PetscCall(FetiFetiStepNext(step, &solved));
  }
  PetscCall(FetiFetiStepDestroy(&step));
  PetscCall(PetscFinalize());
  return 0;
}
