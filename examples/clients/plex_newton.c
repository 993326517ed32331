/*
   Newton's method on a DMPlex, a program that knows nothing of fetifeti: a cantilever of the material of
   St. Venant and Kirchhoff bends by a dead load. Options make the Jacobians of type MATIS and choose the linear solver:

     mpicc plex_newton.c -o plex_newton $(pkg-config --cflags --libs PETSc) -lm
     mpirun -n 4 ./plex_newton -snes_linesearch_type basic \
         -dm_mat_type is -dll_append $(pkg-config --variable=plugin fetifeti) -ksp_type fetifeti
     mpirun -n 4 ./plex_newton -snes_linesearch_type basic \
         -ksp_type preonly -pc_type lu -pc_factor_mat_solver_type mumps                     # to compare
*/
#include <petscdmplex.h>
#include <petscds.h>
#include <petscsnes.h>

#define PLACE \
  PetscInt dim, PetscInt Nf, PetscInt NfAux, const PetscInt uOff[], const PetscInt uOff_x[], const PetscScalar u[], \
    const PetscScalar u_t[], const PetscScalar u_x[], const PetscInt aOff[], const PetscInt aOff_x[], \
    const PetscScalar a[], const PetscScalar a_t[], const PetscScalar a_x[], PetscReal t

/* F = 1 + grad u and S = tr(E) + 2 E with E = (F'F - 1) / 2: both of Lame's constants are 1. */
static void Stress(const PetscScalar u_x[], PetscScalar F[2][2], PetscScalar S[2][2])
{
  PetscScalar C[2][2];

  for (int i = 0; i < 4; i++) F[i / 2][i % 2] = u_x[i] + (i % 3 == 0);
  for (int i = 0; i < 4; i++) C[i / 2][i % 2] = F[0][i / 2] * F[0][i % 2] + F[1][i / 2] * F[1][i % 2];
  for (int i = 0; i < 4; i++) S[i / 2][i % 2] = C[i / 2][i % 2] + (i % 3 == 0) * ((C[0][0] + C[1][1]) / 2 - 2);
}

static void Load(PLACE, const PetscReal x[], PetscInt numC, const PetscScalar constants[], PetscScalar f0[])
{ f0[1] = constants[0]; }

static void Internal(PLACE, const PetscReal x[], PetscInt numC, const PetscScalar constants[], PetscScalar f1[])
{
  PetscScalar F[2][2], S[2][2];

  Stress(u_x, F, S);
  for (int i = 0; i < 4; i++) f1[i] = F[i / 2][0] * S[0][i % 2] + F[i / 2][1] * S[1][i % 2];
}

static void Tangent(PLACE, PetscReal shift, const PetscReal x[], PetscInt numC, const PetscScalar constants[],
                    PetscScalar g3[])
{
  PetscScalar F[2][2], S[2][2];

  Stress(u_x, F, S);
  for (int n = 0; n < 16; n++) {
    const int i = n / 8, k = n / 4 % 2, j = n / 2 % 2, l = n % 2;

    g3[n] = (i == k) * S[j][l] + F[i][j] * F[k][l] + F[i][l] * F[k][j] +
            (j == l) * (F[i][0] * F[k][0] + F[i][1] * F[k][1]);
  }
}

static PetscErrorCode Motions(DM dm, PetscInt from, PetscInt to, MatNullSpace *space)
{ return DMPlexCreateRigidBody(dm, from, space); }

int main(int argc, char **argv)
{
  DM             dm;
  PetscFE        fe;
  PetscDS        ds;
  DMLabel        sides;
  SNES           snes;
  Vec            u;
  PetscInt       left = 4;
  PetscReal      size;
  PetscScalar    load = 0.002;

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(PetscOptionsInsertString(NULL, "-dm_plex_simplex 0 -dm_plex_box_faces 24,6 -dm_plex_box_upper 4,1"));
  PetscCall(DMCreate(PETSC_COMM_WORLD, &dm));
  PetscCall(DMSetType(dm, DMPLEX));
  PetscCall(DMSetFromOptions(dm));
  PetscCall(PetscFECreateLagrange(PETSC_COMM_WORLD, 2, 2, PETSC_FALSE, 1, PETSC_DEFAULT, &fe));
  PetscCall(DMAddField(dm, NULL, (PetscObject)fe));
  PetscCall(DMCreateDS(dm));
  PetscCall(DMGetDS(dm, &ds));
  PetscCall(PetscDSSetConstants(ds, 1, &load));
  PetscCall(PetscDSSetResidual(ds, 0, Load, Internal));
  PetscCall(PetscDSSetJacobian(ds, 0, 0, NULL, NULL, NULL, Tangent));
  PetscCall(DMGetLabel(dm, "Face Sets", &sides));
  PetscCall(DMAddBoundary(dm, DM_BC_ESSENTIAL, "left", sides, 1, &left, 0, 0, NULL, NULL, NULL, NULL, NULL));
  PetscCall(DMSetNearNullSpaceConstructor(dm, 0, Motions));
#if PETSC_VERSION_LT(3, 21, 0)
  PetscCall(DMPlexSetSNESLocalFEM(dm, NULL, NULL, NULL));
#else
  PetscCall(DMPlexSetSNESLocalFEM(dm, PETSC_FALSE, NULL));
#endif
  PetscCall(SNESCreate(PETSC_COMM_WORLD, &snes));
  PetscCall(SNESSetDM(snes, dm));
  PetscCall(SNESSetFromOptions(snes));
  PetscCall(DMCreateGlobalVector(dm, &u));
  PetscCall(SNESSolve(snes, NULL, u));
  PetscCall(VecNorm(u, NORM_INFINITY, &size));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "deflection %.9f\n", (double)size));
  PetscCall(VecDestroy(&u));
  PetscCall(SNESDestroy(&snes));
  PetscCall(PetscFEDestroy(&fe));
  PetscCall(DMDestroy(&dm));
  PetscCall(PetscFinalize());
  return 0;
}
