/*
   The load steps of a scene, for programs that run on PETSc: a scene is what `fetifeti solve` reads, bodies with loads,
   ties and contact in a file.

   Link with libfetifeti_step.so. libfetifeti.so is not needed; a program may be linked with both. All functions return
   a PETSc error code; errors go through PETSc's error handler as one sentence. All ranks of the communicator of
   FetiFetiStepCreate() must call a "Collective" function; each rank may call the others as often as it likes.
*/
#if !defined(FETIFETI_STEP_H)
#define FETIFETI_STEP_H

#include <petscksp.h>

/*S
   FetiFetiStep - The load steps of a scene, solved one after the other, each from the end of the one before

   Level: beginner

   Notes:
   A scene without [steps] has one step.

.vb
   FetiFetiStepCreate(comm, "press.toml", &step);
   FetiFetiStepNext(step, &solved);
   while (solved) {
     FetiFetiStepGetEnergy(step, &energy);
     FetiFetiStepNext(step, &solved);
   }
   FetiFetiStepDestroy(&step);
.ve

.seealso: `FetiFetiStepCreate()`, `FetiFetiStepNext()`, `FetiFetiStepGetDisplacements()`, `FetiFetiStepGetContact()`,
          `FetiFetiStepCheckpoint()`
S*/
typedef struct _p_FetiFetiStep *FetiFetiStep;

/*E
   FetiFetiRowState - The state of a row of contact after a solve, as in fetifeti.h

   Level: beginner

   Values:
+  FETIFETI_OPEN  - the sides are apart
.  FETIFETI_HOLDS - the row holds: an equation, or contact without a force of friction
.  FETIFETI_STICK - in contact, and the sides stick to each other
-  FETIFETI_SLIP  - the sides slide, with the largest force of friction that the law allows

.seealso: `FetiFetiStepRow`
E*/
#define FETIFETI_OPEN  0
#define FETIFETI_HOLDS 1
#define FETIFETI_STICK 2
#define FETIFETI_SLIP  3

/*S
   FetiFetiStepRow - A row between two bodies, or between a body and an obstacle, at the end of a load step

   Level: beginner

   Values:
+  body       - the two bodies, numbered as in FetiFetiStepGetBody(); -1 where there is none, as beside an obstacle
.  node       - their nodes; -1 where there is none, as beside a side whose nodes do not match
.  x          - the place of the node that carries the multiplier; the third coordinate is 0 in the plane
.  normal     - the unit vector along which the row takes differences, out of the first body; 0 if it is not known
.  multiplier - the force along the normal with which the first body presses on the other side
.  gap        - the remaining distance; negative where the sides overlap
.  area       - the area of the node, so that multiplier / area is the pressure; 0 if it has none
.  friction   - the force with which the first body drags the other side along; friction / area is the shear stress
.  slip       - how far the first body has slid on the other side in the load step, without the elastic part of a stick
                stiffness
.  inequality - 1 for sides that may touch, 0 for ties and equations
.  active     - 1 where the row holds
-  state      - FETIFETI_OPEN, FETIFETI_HOLDS, FETIFETI_STICK or FETIFETI_SLIP

   Note:
   Friction and slip are 0 where there is no friction. The first body itself gets minus the friction, as it gets minus
   the multiplier along the normal.

.seealso: `FetiFetiStepGetContact()`
S*/
typedef struct {
  PetscInt  body[2], node[2];
  PetscReal x[3], normal[3];
  PetscReal multiplier, gap, area;
  PetscReal friction[3], slip[3];
  PetscInt  inequality, active, state;
} FetiFetiStepRow;

/*@C
   FetiFetiStepCreate - Reads a scene and sets a solver up for its load steps

   Collective

   Input Parameters:
+  comm  - the communicator
-  scene - the file of the scene; of a deck (.inp) the last step is taken

   Output Parameter:
.  step - the load steps, of which none is solved yet

   Level: beginner

   Notes:
   The communicator and PETSc must not end before the object is destroyed.

   Options of the solver are those of `fetifeti solve`, in PETSc's database. The scene's own options ([options]) hold
   where the database has none, during calls on this object alone.

   A mistake in the scene is PETSC_ERR_ARG_WRONG, a sentence with the file, the line and what was expected.

.seealso: `FetiFetiStepNext()`, `FetiFetiStepResume()`, `FetiFetiStepDestroy()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepCreate(MPI_Comm comm, const char scene[], FetiFetiStep *step);
/* The communicator is a number of Fortran, as petsc4py has it */
PETSC_EXTERN PetscErrorCode FetiFetiStepCreateFortran(int comm, const char scene[], FetiFetiStep *step);

/*@
   FetiFetiStepDestroy - Gives back the memory of the load steps

   Collective

   Input Parameter:
.  step - the load steps, set to NULL; nothing happens if they are NULL

   Level: beginner

.seealso: `FetiFetiStepCreate()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepDestroy(FetiFetiStep *step);

/*@
   FetiFetiStepNext - Solves the next load step

   Collective

   Input Parameter:
.  step - the load steps

   Output Parameter:
.  solved - PETSC_TRUE if there was a step, PETSC_FALSE after the last one

   Level: beginner

   Notes:
   The functions below return the results of the step that was solved last, also after the last one.

   A step that does not converge is the error PETSC_ERR_NOT_CONVERGED, and no step follows. It can be asked for like
   others: FetiFetiStepGetConvergedReason() is then negative.

.seealso: `FetiFetiStepCreate()`, `FetiFetiStepGetNumber()`, `FetiFetiStepGetEnergy()`, `FetiFetiStepCheckpoint()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepNext(FetiFetiStep step, PetscBool *solved);

/*@
   FetiFetiStepGetNumber - Gets the number of the load step that was solved last

   Not Collective

   Input Parameter:
.  step - the load steps

   Output Parameter:
.  number - its number, from 0

   Level: beginner

.seealso: `FetiFetiStepNext()`, `FetiFetiStepGetTime()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepGetNumber(FetiFetiStep step, PetscInt *number);

/*@
   FetiFetiStepGetTime - Gets the time t of the load step that was solved last

   Not Collective

   Input Parameter:
.  step - the load steps

   Output Parameter:
.  time - its time; 1 for a scene without [steps]

   Level: beginner

.seealso: `FetiFetiStepNext()`, `FetiFetiStepGetNumber()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepGetTime(FetiFetiStep step, PetscReal *time);

/*@
   FetiFetiStepGetEnergy - Gets the potential energy of all bodies at the end of the load step that was solved last

   Not Collective

   Input Parameter:
.  step - the load steps

   Output Parameter:
.  energy - 1/2 u'Ku - f'u with given displacements, over all ranks: the energy of the program's report

   Level: beginner

.seealso: `FetiFetiStepNext()`, `FetiFetiStepGetDisplacements()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepGetEnergy(FetiFetiStep step, PetscReal *energy);

/*@
   FetiFetiStepGetIterations - Gets the Krylov iterations of the load step that was solved last

   Not Collective

   Input Parameter:
.  step - the load steps

   Output Parameter:
.  its - the iterations, with contact those of all steps of the contact loop

   Level: beginner

.seealso: `FetiFetiStepNext()`, `FetiFetiStepGetConvergedReason()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepGetIterations(FetiFetiStep step, PetscInt *its);

/*@C
   FetiFetiStepGetConvergedReason - Gets why the solve of the load step ended that was solved last

   Not Collective

   Input Parameter:
.  step - the load steps

   Output Parameters:
+  reason - PETSc's reason, or the nearest one; negative if the step has not converged
-  name   - the name of the exact reason, such as DIVERGED_CONTACT_ITS, valid until the next step; may be NULL

   Level: beginner

.seealso: `FetiFetiStepNext()`, `FetiFetiStepGetIterations()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepGetConvergedReason(FetiFetiStep step, KSPConvergedReason *reason,
                                                           const char *name[]);

/*@
   FetiFetiStepGetBodies - Gets the number of bodies of the scene

   Not Collective

   Input Parameter:
.  step - the load steps

   Output Parameter:
.  n - the number of bodies

   Level: beginner

.seealso: `FetiFetiStepGetBody()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepGetBodies(FetiFetiStep step, PetscInt *n);

/*@C
   FetiFetiStepGetBody - Gets the name and the size of a body

   Not Collective

   Input Parameters:
+  step - the load steps
-  body - number of the body, from 0

   Output Parameters:
+  name       - its name in the scene, valid as long as step; each of the three may be NULL
.  nodes      - its nodes
-  components - unknowns of a node: 1 for a scalar, 2 for elasticity in the plane, 3 in space

   Level: beginner

.seealso: `FetiFetiStepGetBodies()`, `FetiFetiStepGetCoordinates()`, `FetiFetiStepGetDisplacements()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepGetBody(FetiFetiStep step, PetscInt body, const char *name[],
                                                PetscInt *nodes, PetscInt *components);

/*@
   FetiFetiStepGetCoordinates - Gets the coordinates of the nodes of a body, before it is deformed

   Not Collective

   Input Parameters:
+  step - the load steps
.  body - number of the body, from 0
-  n    - length of x: 3 numbers for each node

   Output Parameter:
.  x - the coordinates, node by node; the third is 0 in the plane

   Level: beginner

.seealso: `FetiFetiStepGetBody()`, `FetiFetiStepGetDisplacements()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepGetCoordinates(FetiFetiStep step, PetscInt body, PetscInt n, PetscReal x[]);

/*@
   FetiFetiStepGetDisplacements - Gets the displacements of a body at the end of the load step that was solved last

   Collective

   Input Parameters:
+  step - the load steps
.  body - number of the body, from 0; the same on all ranks
-  n    - length of u: nodes times components of FetiFetiStepGetBody()

   Output Parameter:
.  u - the displacements, node by node, on all ranks; given ones are included

   Level: beginner

.seealso: `FetiFetiStepGetBody()`, `FetiFetiStepGetCoordinates()`, `FetiFetiStepGetContact()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepGetDisplacements(FetiFetiStep step, PetscInt body, PetscInt n,
                                                         PetscReal u[]);

/*@C
   FetiFetiStepGetContact - Gets the rows between bodies at the end of the load step that was solved last: forces and
   gaps of contacts, friction, forces of ties

   Collective

   Input Parameter:
.  step - the load steps

   Output Parameters:
+  n    - the number of rows
-  rows - the rows of all ranks, on all ranks: interface by interface, then obstacles, then equations, whose body
          is -1; valid until the next step

   Level: beginner

.seealso: `FetiFetiStepRow`, `FetiFetiStepGetDisplacements()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepGetContact(FetiFetiStep step, PetscInt *n, const FetiFetiStepRow *rows[]);

/*@C
   FetiFetiStepCheckpoint - Writes where the load steps stand to a file, from which they resume

   Collective

   Input Parameters:
+  step - the load steps
-  file - the file; it is replaced as a whole or not at all

   Level: intermediate

   Notes:
   The next step is made ready for that: an error in it is returned here, and no step follows. No file is written before
   anything is known, and where no step follows: there is nothing to resume.

   `fetifeti solve --resume` reads the file, too. The report of such a run begins with the step in which it resumes.

.seealso: `FetiFetiStepResume()`, `FetiFetiStepNext()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepCheckpoint(FetiFetiStep step, const char file[]);

/*@C
   FetiFetiStepResume - Goes to the load step of a checkpoint, before any step is solved

   Collective

   Input Parameters:
+  step - the load steps
-  file - a file of FetiFetiStepCheckpoint() or of `fetifeti solve --checkpoint`, for the same scene

   Level: intermediate

   Note:
   The number of ranks and the options may be others.

.seealso: `FetiFetiStepCheckpoint()`, `FetiFetiStepCreate()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiStepResume(FetiFetiStep step, const char file[]);

#endif
