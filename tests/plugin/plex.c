/*
   A DMPlex of squares whose cells have a label: bodies by this label, or by an index set over the rows. Its stiffness
   is that of springs between all nodes of a square, which does not depend on their order. The solution is compared with
   that of the assembled matrix.

     -by label|is|option|none   how bodies are named (option: the host names none, -fetifeti_body_label may)
*/
static const char help[] = "Bodies of a DMPlex.\n";

#include <petscdmplex.h>
#include <petscksp.h>

static PetscErrorCode Mesh(DM *dm)
{
  const PetscInt faces[2] = {8, 8};
  PetscInt       first, last, c, k;
  PetscInt       counts[3] = {1, 0, 0};
  DM             spread;
  PetscSection   section;
  DMLabel        label;

  PetscFunctionBeginUser;
#if PETSC_VERSION_GE(3, 22, 0)
  PetscCall(DMPlexCreateBoxMesh(PETSC_COMM_WORLD, 2, PETSC_FALSE, faces, NULL, NULL, NULL, PETSC_TRUE, 0, PETSC_TRUE,
                                dm));
#else
  PetscCall(DMPlexCreateBoxMesh(PETSC_COMM_WORLD, 2, PETSC_FALSE, faces, NULL, NULL, NULL, PETSC_TRUE, dm));
#endif
  PetscCall(DMCreateLabel(*dm, "material"));
  PetscCall(DMGetLabel(*dm, "material", &label));
  PetscCall(DMPlexGetHeightStratum(*dm, 0, &first, &last));
  for (c = first; c < last; c++) {
    PetscReal centre[3];

    PetscCall(DMPlexComputeCellGeometryFVM(*dm, c, NULL, centre, NULL));
    PetscCall(DMLabelSetValue(label, c, centre[1] < 0.5 ? 3 : 8));
  }
  PetscCall(DMPlexDistribute(*dm, 0, NULL, &spread));
  if (spread) {
    PetscCall(DMDestroy(dm));
    *dm = spread;
  }
  PetscCall(DMSetNumFields(*dm, 1));
  PetscCall(DMPlexCreateSection(*dm, NULL, &(const PetscInt){1}, counts, 0, NULL, NULL, NULL, NULL, &section));
  PetscCall(DMSetLocalSection(*dm, section));
  PetscCall(PetscSectionDestroy(&section));
  k = 0;
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-without_label", &k, NULL));
  if (k) PetscCall(DMRemoveLabel(*dm, "material", NULL));
  PetscFunctionReturn(0);
}

static PetscErrorCode Assemble(DM dm, MatType type, Mat *A)
{
  PetscInt    first, last, c, i;
  PetscScalar k[16];

  PetscFunctionBeginUser;
  for (i = 0; i < 16; i++) k[i] = i % 5 ? -1 : 3;
  PetscCall(DMSetMatType(dm, type));
  PetscCall(DMCreateMatrix(dm, A));
  PetscCall(DMPlexGetHeightStratum(dm, 0, &first, &last));
  for (c = first; c < last; c++) PetscCall(DMPlexMatSetClosure(dm, NULL, NULL, *A, c, k, ADD_VALUES));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

int main(int argc, char **argv)
{
  DM          dm;
  Mat         A, assembled;
  Vec         b, x, r;
  KSP         ksp;
  IS          is;
  char        by[16] = "none";
  PetscInt    n, first, k, *numbers, short_by = 0;
  PetscMPIInt rank, size;
  PetscReal   norm, load;
  PetscErrorCode (*set)(void) = NULL;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, help));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-by", by, sizeof(by), NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-short_by", &short_by, NULL));
  PetscCall(Mesh(&dm));
  PetscCall(Assemble(dm, MATAIJ, &assembled));
  PetscCall(Assemble(dm, MATIS, &A));
  PetscCall(DMCreateGlobalVector(dm, &b));
  PetscCall(VecDuplicate(b, &x));
  PetscCall(VecDuplicate(b, &r));
  PetscCall(VecGetOwnershipRange(b, &first, NULL));
  PetscCall(VecGetLocalSize(b, &n));
  for (k = 0; k < n; k++) PetscCall(VecSetValue(b, first + k, (first + k) % 7 - 2.5, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(b));
  PetscCall(VecAssemblyEnd(b));
  /* The first unknown is held. */
  PetscCall(MatZeroRowsColumns(A, rank ? 0 : 1, &(const PetscInt){0}, 1.0, NULL, NULL));
  PetscCall(MatZeroRowsColumns(assembled, rank ? 0 : 1, &(const PetscInt){0}, 1.0, NULL, NULL));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetOperators(ksp, A, A));
  PetscCall(KSPSetFromOptions(ksp));
  if (by[0] == 'l') {
    PetscErrorCode (*name)(KSP, const char[]) = NULL;

    PetscCall(PetscObjectQueryFunction((PetscObject)ksp, "KSPFETIFETISetBodyLabel_C", &set));
    name = (PetscErrorCode(*)(KSP, const char[]))set;
    PetscCall((*name)(ksp, "material"));
  }
  if (by[0] == 'i') {
    PetscErrorCode (*rows)(KSP, IS) = NULL;

    /* The lower half of the ranks and the upper one. */
    PetscCall(PetscMalloc1(n, &numbers));
    for (k = 0; k < n; k++) numbers[k] = 2 * rank < size ? 70 : 20;
    PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, n - short_by, numbers, PETSC_OWN_POINTER, &is));
    PetscCall(PetscObjectQueryFunction((PetscObject)ksp, "KSPFETIFETISetBodyIS_C", &set));
    rows = (PetscErrorCode(*)(KSP, IS))set;
    PetscCall((*rows)(ksp, is));
    PetscCall(ISDestroy(&is));
  }
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(MatMult(assembled, x, r));
  PetscCall(VecAXPY(r, -1.0, b));
  PetscCall(VecNorm(r, NORM_2, &norm));
  PetscCall(VecNorm(b, NORM_2, &load));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "residual %.2e\n", (double)(norm / load)));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(MatDestroy(&A));
  PetscCall(MatDestroy(&assembled));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&r));
  PetscCall(DMDestroy(&dm));
  PetscCall(PetscFinalize());
  return 0;
}
