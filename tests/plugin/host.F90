! A Laplacian on a line of elements, one stretch per rank, as a MATIS: the solver is chosen by the options.
program host
#include <petsc/finclude/petscksp.h>
  use petscksp
  implicit none
  PetscErrorCode :: ierr
  PetscMPIInt :: rank, ranks
  PetscInt :: n, first, last, count, i, one, two, three, n1
  PetscInt, allocatable :: global(:), room(:)
  PetscInt :: pair(2), row(1)
  PetscScalar :: ke(4), sum
  PetscReal :: norm, zero
  ISLocalToGlobalMapping :: map
  Mat :: A
  Vec :: b, x, r
  KSP :: ksp
  KSPConvergedReason :: reason

  PetscCallA(PetscInitialize(ierr))
  call MPI_Comm_rank(PETSC_COMM_WORLD, rank, ierr)
  call MPI_Comm_size(PETSC_COMM_WORLD, ranks, ierr)
  n = 40
  n1 = n + 1
  one = 1
  two = 2
  three = 3
  zero = 0.0
  first = n * rank / ranks
  last = n * (rank + 1) / ranks
  count = last - first + 1
  allocate (global(count), room(n + 1))
  room = 3
  do i = 1, count
    global(i) = first + i - 1
  end do
  PetscCallA(ISLocalToGlobalMappingCreate(PETSC_COMM_WORLD, one, count, global, PETSC_COPY_VALUES, map, ierr))
  PetscCallA(MatCreateIS(PETSC_COMM_WORLD, one, PETSC_DECIDE, PETSC_DECIDE, n1, n1, map, map, A, ierr))
  PetscCallA(MatISSetPreallocation(A, three, room, three, room, ierr))
  ke = (/1.0, -1.0, -1.0, 1.0/)
  do i = 0, count - 2
    pair = (/i, i + 1/)
    PetscCallA(MatSetValuesLocal(A, two, pair, two, pair, ke, ADD_VALUES, ierr))
  end do
  PetscCallA(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY, ierr))
  PetscCallA(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY, ierr))
  row(1) = 0
  count = 0
  if (rank == 0) count = 1
  sum = 1.0
  PetscCallA(MatZeroRowsColumns(A, count, row, sum, PETSC_NULL_VEC, PETSC_NULL_VEC, ierr))
  PetscCallA(MatCreateVecs(A, x, b, ierr))
  PetscCallA(VecDuplicate(b, r, ierr))
  PetscCallA(VecSet(b, sum, ierr))
  PetscCallA(KSPCreate(PETSC_COMM_WORLD, ksp, ierr))
  PetscCallA(KSPSetOperators(ksp, A, A, ierr))
  PetscCallA(KSPSetFromOptions(ksp, ierr))
  PetscCallA(KSPSolve(ksp, b, x, ierr))
  PetscCallA(KSPGetConvergedReason(ksp, reason, ierr))
  PetscCallA(MatMult(A, x, r, ierr))
  sum = -1.0
  PetscCallA(VecAXPY(r, sum, b, ierr))
  PetscCallA(VecNorm(r, NORM_2, norm, ierr))
  if (rank == 0) print '(a,i3,a,es9.2)', 'reason', reason, ' residual ', norm
  PetscCallA(KSPDestroy(ksp, ierr))
  PetscCallA(MatDestroy(A, ierr))
  PetscCallA(VecDestroy(b, ierr))
  PetscCallA(VecDestroy(x, ierr))
  PetscCallA(VecDestroy(r, ierr))
  PetscCallA(ISLocalToGlobalMappingDestroy(map, ierr))
  PetscCallA(PetscFinalize(ierr))
end program
