/*
   Plane elasticity on DMDAs. Without options: one block, held at its left (in x) and at its bottom (in y), pressed from above, solved by any KSP. With
   -contact: a second block with a curved lower side lies on the first one, and the press is on that. What contact adds to the program stands between
   "contact" and "end of contact".

     mpicc contact.c -o contact $(pkg-config --cflags --libs PETSc) -I../../wrappers -L../../target/release -lfetifeti -Wl,-rpath,$PWD/../../target/release
     mpirun -n 4 ./contact -contact -m 17
*/
static const char help[] = "An elastic block under a press, or two of them in contact.\n";

#include <petscdmda.h>
#include <petscksp.h>
#include <petscdmcomposite.h> /* contact */
#include "fetifeti.h"         /* contact */

/* Stiffness of a bilinear square under plane stress, E = 1, nu = 0.3; nodes anticlockwise from the lower left. */
static void Stiffness(PetscScalar k[64])
{
  const PetscReal nu = 0.3, d[3][3] = {{1 / (1 - nu * nu), nu / (1 - nu * nu), 0}, {nu / (1 - nu * nu), 1 / (1 - nu * nu), 0}, {0, 0, 0.5 / (1 + nu)}};
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
  PetscCall(DMDACreate2d(PETSC_COMM_WORLD, DM_BOUNDARY_NONE, DM_BOUNDARY_NONE, DMDA_STENCIL_BOX, m, m, PETSC_DECIDE, PETSC_DECIDE, 2, 1, NULL, NULL, da));
  PetscCall(DMSetMatType(*da, MATIS));
  PetscCall(DMSetUp(*da));
  PetscCall(DMDASetElementType(*da, DMDA_ELEMENT_Q1));
  PetscCall(DMDASetUniformCoordinates(*da, 0, 1, 0, 1, 0, 0));
  PetscFunctionReturn(0);
}

/* Its matrix and load; the bottom is held and the top pressed where that is wanted. */
static PetscErrorCode Assemble(DM da, PetscInt m, PetscBool hold, PetscBool press, Mat *A, Vec *b)
{
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

/* contact */
/* The number of node (i, j)'s vertical displacement of body k among the unknowns of both. */
static PetscErrorCode Number(AO ao[2], Vec part[2], Vec all, PetscInt k, PetscInt m, PetscInt i, PetscInt j, PetscInt *dof)
{
  const PetscInt *first[2], *whole;
  PetscLayout     layout;
  PetscMPIInt     rank;

  PetscFunctionBeginUser;
  *dof = 2 * (j * m + i) + 1;
  PetscCall(AOApplicationToPetsc(ao[k], 1, dof));
  PetscCall(VecGetLayout(part[k], &layout));
  PetscCall(PetscLayoutFindOwner(layout, *dof, &rank));
  PetscCall(VecGetOwnershipRanges(part[0], &first[0]));
  PetscCall(VecGetOwnershipRanges(part[1], &first[1]));
  PetscCall(VecGetOwnershipRanges(all, &whole));
  *dof += whole[rank] - first[k][rank] + (k ? first[0][rank + 1] - first[0][rank] : 0);
  PetscFunctionReturn(0);
}
/* end of contact */

/* How far u and the multipliers of the rows are from the solution, by the host's own matrices: this proves that it is one, as the problem is convex. */
static PetscErrorCode Judge(DM pack, Mat A[2], Vec b, Vec u, PetscInt n, const PetscInt ja[], const PetscReal gap[], const PetscReal lambda[])
{
  Vec                r, ub[2], rb[2], local;
  VecScatter         scatter;
  PetscReal          norm, size, pull = 0, open = 0, product = 0, force = 0;
  const PetscScalar *v;
  PetscInt           k, active = 0;

  PetscFunctionBeginUser;
  PetscCall(VecDuplicate(b, &r));
  PetscCall(DMCompositeGetAccess(pack, u, &ub[0], &ub[1]));
  PetscCall(DMCompositeGetAccess(pack, r, &rb[0], &rb[1]));
  for (k = 0; k < 2; k++) PetscCall(MatMult(A[k], ub[k], rb[k]));
  PetscCall(DMCompositeRestoreAccess(pack, u, &ub[0], &ub[1]));
  PetscCall(DMCompositeRestoreAccess(pack, r, &rb[0], &rb[1]));
  PetscCall(VecAXPY(r, -1.0, b));
  for (k = 0; k < n; k++) {
    PetscCall(VecSetValue(r, ja[2 * k], lambda[k], ADD_VALUES));
    PetscCall(VecSetValue(r, ja[2 * k + 1], -lambda[k], ADD_VALUES));
  }
  PetscCall(VecAssemblyBegin(r));
  PetscCall(VecAssemblyEnd(r));
  PetscCall(VecNorm(r, NORM_2, &norm));
  PetscCall(VecNorm(b, NORM_2, &size));
  PetscCall(VecScatterCreateToZero(u, &scatter, &local));
  PetscCall(VecScatterBegin(scatter, u, local, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(scatter, u, local, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArrayRead(local, &v));
  for (k = 0; k < n; k++) {
    const PetscReal over = v[ja[2 * k]] - v[ja[2 * k + 1]] - gap[k];

    pull    = PetscMax(pull, -lambda[k]);
    open    = PetscMax(open, over);
    product = PetscMax(product, PetscAbsReal(over * lambda[k]));
    force += lambda[k];
    active += lambda[k] > 1e-10;
  }
  PetscCall(VecRestoreArrayRead(local, &v));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "equilibrium %.2e overlap %.2e pull %.2e product %.2e\n", (double)(norm / size), (double)open, (double)pull, (double)product));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%" PetscInt_FMT " of %" PetscInt_FMT " nodes touch, force %.9f\n", active, n, (double)force));
  PetscCall(VecScatterDestroy(&scatter));
  PetscCall(VecDestroy(&local));
  PetscCall(VecDestroy(&r));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  PetscInt    m = 17, its;
  PetscBool   contact = PETSC_FALSE;
  PetscMPIInt rank;
  DM          da[2];
  Mat         A[2];
  Vec         b[2], u;
  KSP         ksp;
  PetscReal   energy;

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
    DM                      pack;
    FetiFeti                ff;
    AO                      ao[2];
    Vec                     load, where, from, to[2];
    IS                     *numbers;
    const PetscScalar      *xy;
    KSPConvergedReason      reason;
    PetscInt                n, k, r, rows = rank == 0 ? m : 0, *ia, *ja, *kind;
    PetscReal              *gap, *lambda, kkt[4];
    PetscScalar            *coefficient;

    PetscCall(Block(m, &da[1]));
    PetscCall(Assemble(da[1], m, PETSC_FALSE, PETSC_TRUE, &A[1], &b[1]));
    PetscCall(DMCompositeCreate(PETSC_COMM_WORLD, &pack)); /* one numbering for both bodies */
    for (k = 0; k < 2; k++) PetscCall(DMCompositeAddDM(pack, da[k]));
    PetscCall(DMCreateGlobalVector(pack, &load));
    PetscCall(VecDuplicate(load, &where));
    PetscCall(VecDuplicate(load, &u));
    PetscCall(DMCompositeGetAccess(pack, load, &to[0], &to[1]));
    for (k = 0; k < 2; k++) PetscCall(VecCopy(b[k], to[k]));
    PetscCall(DMCompositeRestoreAccess(pack, load, &to[0], &to[1]));
    PetscCall(DMCompositeGetAccess(pack, where, &to[0], &to[1]));
    for (k = 0; k < 2; k++) {
      PetscCall(DMGetCoordinates(da[k], &from));
      PetscCall(VecCopy(from, to[k]));
    }
    PetscCall(DMCompositeRestoreAccess(pack, where, &to[0], &to[1]));
    PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff)); /* the bodies */
    PetscCall(FetiFetiSetFromOptions(ff));
    PetscCall(VecGetLocalSize(load, &n));
    PetscCall(FetiFetiSetSizes(ff, n, PETSC_DETERMINE));
    PetscCall(FetiFetiSetBlockSize(ff, 2));
    PetscCall(VecGetArrayRead(where, &xy));
    PetscCall(FetiFetiSetCoordinates(ff, 2, n / 2, xy));
    PetscCall(VecRestoreArrayRead(where, &xy));
    PetscCall(DMCompositeGetGlobalISs(pack, &numbers));
    for (k = 0; k < 2; k++) PetscCall(FetiFetiAddMatIS(ff, A[k], numbers[k], k));
    PetscCall(PetscMalloc6(rows + 1, &ia, 2 * rows, &ja, rows, &gap, rows, &kind, 2 * rows, &coefficient, rows, &lambda)); /* the rows: u_y(below) - u_y(above) <= gap */
    for (k = 0; k < 2; k++) PetscCall(DMDAGetAO(da[k], &ao[k]));
    for (r = 0; r < rows; r++) {
      PetscCall(Number(ao, b, load, 0, m, r, m - 1, &ja[2 * r]));
      PetscCall(Number(ao, b, load, 1, m, r, 0, &ja[2 * r + 1]));
      coefficient[2 * r]     = 1;
      coefficient[2 * r + 1] = -1;
      gap[r]                 = 0.05 + 0.4 * PetscSqr((PetscReal)r / (m - 1));
      kind[r]                = FETIFETI_INEQUALITY;
    }
    for (r = 0; r <= rows; r++) ia[r] = 2 * r;
    PetscCall(FetiFetiSetContactRows(ff, rows, ia, ja, coefficient, gap, kind));
    PetscCall(FetiFetiSolve(ff, load, u));
    PetscCall(FetiFetiGetMultipliers(ff, rows, lambda));
    PetscCall(FetiFetiGetConvergedReason(ff, &reason));
    PetscCall(FetiFetiGetIterations(ff, &its));
    PetscCall(FetiFetiGetKKT(ff, kkt));
    PetscCall(VecDot(load, u, &energy));
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "reason %d, %" PetscInt_FMT " iterations, work %.9f, kkt %.1e\n", (int)reason, its, (double)-energy, (double)kkt[0]));
    /* end of contact */
    PetscCall(Judge(pack, A, load, u, rows, ja, gap, lambda));
    PetscCall(FetiFetiDestroy(&ff));
    for (k = 0; k < 2; k++) PetscCall(ISDestroy(&numbers[k]));
    PetscCall(PetscFree(numbers));
    PetscCall(PetscFree6(ia, ja, gap, kind, coefficient, lambda));
    PetscCall(VecDestroy(&load));
    PetscCall(VecDestroy(&where));
    PetscCall(VecDestroy(&b[1]));
    PetscCall(MatDestroy(&A[1]));
    PetscCall(DMDestroy(&da[1]));
    PetscCall(DMDestroy(&pack));
  }
  PetscCall(VecDestroy(&u));
  PetscCall(VecDestroy(&b[0]));
  PetscCall(MatDestroy(&A[0]));
  PetscCall(DMDestroy(&da[0]));
  PetscCall(PetscFinalize());
  return 0;
}
