/*
   Plane elasticity on DMDAs. Without options: one block, held at its left (in x) and at its bottom (in y), pressed from
   above, solved by any KSP. With -contact: a second block with a curved lower side lies on the first one, and the press
   is on that. What contact adds to the program stands between "contact" and "end of contact".

     mpicc contact.c -o contact $(pkg-config --cflags --libs fetifeti) \
         -Wl,-rpath,$(pkg-config --variable=libdir fetifeti)
     mpirun -n 4 ./contact -contact -m 17
*/
static const char help[] = "An elastic block under a press, or two of them in contact.\n";

#include <petscdmda.h>
#include <petscksp.h>
#include "fetifeti.h" /* contact */

/* Stiffness of a bilinear square under plane stress, E = 1, nu = 0.3; nodes anticlockwise from the lower left. */
static void Stiffness(PetscScalar k[64])
{
  const PetscReal nu      = 0.3;
  const PetscReal d[3][3] = {
    {1 / (1 - nu * nu),  nu / (1 - nu * nu), 0             },
    {nu / (1 - nu * nu), 1 / (1 - nu * nu),  0             },
    {0,                  0,                  0.5 / (1 + nu)}
  };
  const PetscReal sx[4] = {-1, 1, 1, -1}, sy[4] = {-1, -1, 1, 1};
  PetscInt        q, i, j, r, s;

  for (i = 0; i < 64; i++) k[i] = 0;
  for (q = 0; q < 4; q++) {
    const PetscReal x = sx[q] / PetscSqrtReal(3.0), y = sy[q] / PetscSqrtReal(3.0);
    PetscReal       b[3][8] = {{0}};

    for (i = 0; i < 4; i++) {
      const PetscReal dx = sx[i] * (1 + sy[i] * y) / 4, dy = sy[i] * (1 + sx[i] * x) / 4;

      b[0][2 * i]     = dx;
      b[1][2 * i + 1] = dy;
      b[2][2 * i]     = dy;
      b[2][2 * i + 1] = dx;
    }
    for (i = 0; i < 8; i++)
      for (j = 0; j < 8; j++)
        for (r = 0; r < 3; r++)
          for (s = 0; s < 3; s++) k[8 * i + j] += b[r][i] * d[r][s] * b[s][j];
  }
}

/* A block of (m - 1) x (m - 1) squares; m nodes on a side. */
static PetscErrorCode Block(PetscInt m, DM *da)
{
  PetscFunctionBeginUser;
  PetscCall(DMDACreate2d(PETSC_COMM_WORLD, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, DMDA_STENCIL_BOX, m, m, PETSC_DECIDE,
                         PETSC_DECIDE, 2, 1, NULL, NULL, da));
  PetscCall(DMSetMatType(*da, MATIS));
  PetscCall(DMSetUp(*da));
  PetscCall(DMDASetElementType(*da, DMDA_ELEMENT_Q1));
  PetscCall(DMDASetUniformCoordinates(*da, 0, 1, 0, 1, 0, 0));
  PetscFunctionReturn(0);
}

/* Its matrix and load; the bottom is held and the top pressed where that is wanted. */
static PetscErrorCode Assemble(DM da, PetscInt m, PetscBool hold, PetscBool press, Mat *A, Vec *b)
{
  Vec             places;
  MatNullSpace    motions;
  PetscScalar     ke[64], ***load;
  const PetscInt *e;
  PetscInt        n, nodes, i, j, k, xs, ys, xm, ym, held = 0;
  MatStencil     *rows;

  PetscFunctionBeginUser;
  PetscCall(DMCreateMatrix(da, A));
  Stiffness(ke);
  PetscCall(DMDAGetElements(da, &n, &nodes, &e));
  for (i = 0; i < n; i++) {
    PetscInt dofs[8];

    for (k = 0; k < 8; k++) dofs[k] = 2 * e[4 * i + k / 2] + k % 2;
    PetscCall(MatSetValuesLocal(*A, 8, dofs, 8, dofs, ke, ADD_VALUES));
  }
  PetscCall(DMDARestoreElements(da, &n, &nodes, &e));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(DMGetCoordinates(da, &places));
  PetscCall(MatNullSpaceCreateRigidBody(places, &motions));
  PetscCall(MatSetNearNullSpace(*A, motions));
  PetscCall(MatNullSpaceDestroy(&motions));
  PetscCall(DMCreateGlobalVector(da, b));
  PetscCall(DMDAGetCorners(da, &xs, &ys, NULL, &xm, &ym, NULL));
  PetscCall(PetscMalloc1(xm + ym, &rows));
  PetscCall(DMDAVecGetArrayDOF(da, *b, &load));
  for (j = ys; j < ys + ym; j++) {
    for (i = xs; i < xs + xm; i++) {
      if (press && j == m - 1) load[j][i][1] = -(i == 0 || i == m - 1 ? 0.05 : 0.1) / (m - 1);
      if (i == 0) rows[held++] = (MatStencil){0, j, i, 0};
      if (hold && j == 0) rows[held++] = (MatStencil){0, j, i, 1};
    }
  }
  PetscCall(DMDAVecRestoreArrayDOF(da, *b, &load));
  PetscCall(MatZeroRowsColumnsStencil(*A, held, rows, 1.0, NULL, NULL));
  PetscCall(PetscFree(rows));
  PetscFunctionReturn(0);
}

/* How far u and the multipliers of the pairs are from the solution, by the host's own matrices: this proves that it is
   one, as the problem is convex. */
static PetscErrorCode Judge(Mat A[2], Vec b[2], Vec u[2], IS side[2], PetscInt n, const PetscReal gap[],
                            const PetscReal lambda[])
{
  Vec                r, local[2];
  VecScatter         scatter;
  PetscReal          norm, size, equilibrium = 0, load = 0, pull = 0, open = 0, product = 0, force = 0;
  const PetscScalar *v[2];
  const PetscInt    *dof[2];
  PetscInt           k, i, active = 0;

  PetscFunctionBeginUser;
  for (k = 0; k < 2; k++) {
    PetscCall(ISGetIndices(side[k], &dof[k]));
    PetscCall(VecDuplicate(b[k], &r));
    PetscCall(MatMult(A[k], u[k], r));
    PetscCall(VecAXPY(r, -1.0, b[k]));
    for (i = 0; i < n; i++) PetscCall(VecSetValue(r, dof[k][i], k ? -lambda[i] : lambda[i], ADD_VALUES));
    PetscCall(VecAssemblyBegin(r));
    PetscCall(VecAssemblyEnd(r));
    PetscCall(VecNorm(r, NORM_2, &norm));
    PetscCall(VecNorm(b[k], NORM_2, &size));
    equilibrium += norm * norm;
    load += size * size;
    PetscCall(VecDestroy(&r));
    PetscCall(VecScatterCreateToZero(u[k], &scatter, &local[k]));
    PetscCall(VecScatterBegin(scatter, u[k], local[k], INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecScatterEnd(scatter, u[k], local[k], INSERT_VALUES, SCATTER_FORWARD));
    PetscCall(VecScatterDestroy(&scatter));
    PetscCall(VecGetArrayRead(local[k], &v[k]));
  }
  for (i = 0; i < n; i++) {
    const PetscReal over = v[0][dof[0][i]] - v[1][dof[1][i]] - gap[i];

    pull    = PetscMax(pull, -lambda[i]);
    open    = PetscMax(open, over);
    product = PetscMax(product, PetscAbsReal(over * lambda[i]));
    force += lambda[i];
    active += lambda[i] > 1e-10;
  }
  for (k = 0; k < 2; k++) {
    PetscCall(VecRestoreArrayRead(local[k], &v[k]));
    PetscCall(ISRestoreIndices(side[k], &dof[k]));
    PetscCall(VecDestroy(&local[k]));
  }
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "equilibrium %.2e overlap %.2e pull %.2e product %.2e\n",
                        (double)PetscSqrtReal(equilibrium / load), (double)open, (double)pull, (double)product));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%" PetscInt_FMT " of %" PetscInt_FMT " nodes touch, force %.9f\n", active, n,
                        (double)force));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscInt           m = 17, its;
  PetscBool          contact = PETSC_FALSE;
  PetscMPIInt        rank;
  DM                 da[2];
  Mat                A[2];
  Vec                b[2], u, *parts;
  KSP                ksp;
  PetscReal          energy;
  KSPConvergedReason reason;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-m", &m, NULL));
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-contact", &contact, NULL));
  PetscCall(Block(m, &da[0]));
  PetscCall(Assemble(da[0], m, PETSC_TRUE, (PetscBool)!contact, &A[0], &b[0]));
  if (!contact) {
    PetscCall(FetiFetiInitializePackage());
    PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
    PetscCall(KSPSetOperators(ksp, A[0], A[0]));
    PetscCall(KSPSetFromOptions(ksp));
    PetscCall(VecDuplicate(b[0], &u));
    PetscCall(KSPSolve(ksp, b[0], u));
    PetscCall(KSPGetIterationNumber(ksp, &its));
    PetscCall(VecDot(b[0], u, &energy));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%" PetscInt_FMT " iterations, energy %.9f\n", its, (double)(-energy / 2)));
    PetscCall(KSPDestroy(&ksp));
  } else {
    /* contact */
    PetscInt   k, n = rank ? 0 : m; /* the first rank gives the rows */
    PetscReal *gap, *force;
    Vec        load;
    IS         side[2];
    AO         ao;
    FetiFeti   ff;

    PetscCall(Block(m, &da[1]));
    PetscCall(Assemble(da[1], m, PETSC_FALSE, PETSC_TRUE, &A[1], &b[1]));
    PetscCall(VecCreateNest(PETSC_COMM_WORLD, 2, NULL, b, &load));
    PetscCall(VecDuplicate(load, &u));
    /* vertical displacements of the upper side of block 0, and of the lower side of block 1 */
    for (k = 0; k < 2; k++) {
      PetscCall(ISCreateStride(PETSC_COMM_WORLD, n, k ? 1 : 2 * m * (m - 1) + 1, 2, &side[k]));
      PetscCall(DMDAGetAO(da[k], &ao));
      PetscCall(AOApplicationToPetscIS(ao, side[k]));
    }
    PetscCall(PetscMalloc2(n, &gap, n, &force));
    for (k = 0; k < n; k++) gap[k] = 0.05 + 0.4 * PetscSqr((PetscReal)k / (m - 1));
    PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
    PetscCall(FetiFetiSetFromOptions(ff));
    for (k = 0; k < 2; k++) PetscCall(FetiFetiAddMatIS(ff, A[k], NULL, k));
    PetscCall(FetiFetiSetContactPairs(ff, 0, side[0], 1, side[1], gap, FETIFETI_INEQUALITY));
    PetscCall(FetiFetiSolve(ff, load, u));
    PetscCall(FetiFetiGetMultipliers(ff, n, force));
    /* end of contact */
    PetscCall(FetiFetiGetConvergedReason(ff, &reason));
    PetscCall(FetiFetiGetIterations(ff, &its));
    PetscCall(VecDot(load, u, &energy));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "reason %d, %" PetscInt_FMT " iterations, work %.9f\n", (int)reason, its,
                          (double)-energy));
    PetscCall(VecNestGetSubVecs(u, NULL, &parts));
    PetscCall(Judge(A, b, parts, side, n, gap, force));
    /* contact */
    PetscCall(FetiFetiDestroy(&ff));
    PetscCall(PetscFree2(gap, force));
    for (k = 0; k < 2; k++) PetscCall(ISDestroy(&side[k]));
    PetscCall(VecDestroy(&load));
    PetscCall(VecDestroy(&b[1]));
    PetscCall(MatDestroy(&A[1]));
    PetscCall(DMDestroy(&da[1]));
    /* end of contact */
  }
  PetscCall(VecDestroy(&u));
  PetscCall(VecDestroy(&b[0]));
  PetscCall(MatDestroy(&A[0]));
  PetscCall(DMDestroy(&da[0]));
  PetscCall(PetscFinalize());
  return 0;
}
