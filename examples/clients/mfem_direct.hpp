/*
   The direct solution that mfem_contact.cpp compares itself with. None of this is needed to use fetifeti.
*/
#include <mfem.hpp>
#include <petscvec.h>

using namespace mfem;

/* The same by a dense factorisation, with the rows that the solver says hold: they have to pull nowhere, and the others
   must not overlap, which proves the solution. */
static PetscErrorCode Compare(const SparseMatrix stiffness[2], Vec u, const Array<int> &fixed, const Array<int> &lower,
                              const Array<int> &upper, const Vector &gap, const Vector &force, const Vector &load)
{
  const PetscScalar *v;
  Vec                all;
  VecScatter         scatter;
  PetscMPIInt        rank;
  const int          size = load.Size(), rows = gap.Size();
  DenseMatrix        K(size + rows);
  Vector             f(size + rows), x(size + rows);
  double             error = 0, wrong = 0;
  int                closed = 0;

  PetscFunctionBeginUser;
  PetscCall(VecScatterCreateToZero(u, &scatter, &all));
  PetscCall(VecScatterBegin(scatter, u, all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(scatter, u, all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterDestroy(&scatter));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank) {
    PetscCall(VecDestroy(&all));
    PetscFunctionReturn(0);
  }
  f = 0.0;
  f.SetVector(load, 0);
  for (int b = 0; b < 2; b++) {
    DenseMatrix k;
    stiffness[b].ToDenseMatrix(k);
    K.CopyMN(k, size / 2 * b, size / 2 * b);
  }
  for (int d : fixed) {
    for (int j = 0; j < size; j++) K(d, j) = K(j, d) = 0;
    K(d, d) = 1, f[d] = 0;
  }
  for (int r = 0; r < rows; r++) {
    const bool holds = force[r] > 0;
    closed += holds;
    K(size + r, lower[r]) = K(lower[r], size + r) = holds;
    K(size + r, upper[r]) = K(upper[r], size + r) = -holds;
    K(size + r, size + r) = !holds;
    f[size + r]           = holds * gap[r];
  }
  DenseMatrixInverse(K).Mult(f, x);
  PetscCall(VecGetArrayRead(all, &v));
  for (int i = 0; i < size; i++) error = std::max(error, std::abs(v[i] - x[i]));
  PetscCall(VecRestoreArrayRead(all, &v));
  PetscCall(VecDestroy(&all));
  for (int r = 0; r < rows; r++) wrong = std::max({wrong, -force[r], x[lower[r]] - x[upper[r]] - gap[r]});
  PetscCall(PetscPrintf(PETSC_COMM_SELF, "%d unknowns, %d of %d nodes touch, force %.9f\n", size, closed, rows,
                        force.Sum()));
  PetscCall(PetscPrintf(PETSC_COMM_SELF, "error %.1e, overlap or pull %.1e\n", error / x.Normlinf(), wrong));
  PetscCheck(error < 1e-8 * x.Normlinf() && wrong < 1e-12, PETSC_COMM_SELF, PETSC_ERR_PLIB, "not the solution");
  PetscFunctionReturn(0);
}
