! Two elastic bars in contact, by raw arrays: each is cut into three subdomains, the left one is held at 0, the right
! one at -d, and the ends between may come as near as g. With springs of 1 the force is (d - g) / (2 n).
program bars
#include <petsc/finclude/petscvec.h>
  use petscvec
  use fetifeti
  implicit none
  integer(c_int), parameter :: length = 4, n = 3 * length
  real(c_double), parameter :: d = 1.0d0, g = 0.25d0
  type(c_ptr) :: ff
  Vec :: b, x, held
  IS :: dofs, first, second
  PetscErrorCode :: ierr
  PetscMPIInt :: rank, ranks
  PetscInt :: nall, none, ends(2), last(1), step
  PetscScalar :: value(1)
  integer(c_int) :: s, i, nnz, ia(length + 2), ja(3 * length + 1), global(length + 1), reason, rows
  real(c_double) :: a(3 * length + 1), lambda(2)

  PetscCallA(PetscInitialize(ierr))
  call MPI_Comm_rank(PETSC_COMM_WORLD, rank, ierr)
  call MPI_Comm_size(PETSC_COMM_WORLD, ranks, ierr)
  nall = 2 * n + 2
  ierr = FetiFetiCreateFortran(PETSC_COMM_WORLD, ff); CHKERRA(ierr)
  ierr = FetiFetiSetSizes(ff, PETSC_DECIDE, nall); CHKERRA(ierr)
  do s = 0, 5
    if (mod(s, ranks) /= rank) cycle
    nnz = 0
    do i = 0, length
      ia(i + 1) = nnz
      global(i + 1) = s * length + s / 3 + i
      if (i > 0) call entry(i - 1, -1.0d0)
      call entry(i, merge(2.0d0, 1.0d0, i > 0 .and. i < length))
      if (i < length) call entry(i + 1, -1.0d0)
    end do
    ia(length + 2) = nnz
    ierr = FetiFetiAddSubdomain(ff, s / 3, length + 1, ia, ja, a, global); CHKERRA(ierr)
  end do
  PetscCallA(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, nall, b, ierr))
  PetscCallA(VecDuplicate(b, x, ierr))
  PetscCallA(VecDuplicate(b, held, ierr))
  last = 2 * n + 1
  value = -d
  none = 1
  PetscCallA(VecSetValues(held, none, last, value, INSERT_VALUES, ierr))
  PetscCallA(VecAssemblyBegin(held, ierr))
  PetscCallA(VecAssemblyEnd(held, ierr))
  ends = [0, 2 * n + 1]
  none = merge(2, 0, rank == 0)
  PetscCallA(ISCreateGeneral(PETSC_COMM_WORLD, none, ends, PETSC_COPY_VALUES, dofs, ierr))
  ierr = FetiFetiSetDirichletBoundaries(ff, dofs%v, held%v); CHKERRA(ierr)
  rows = merge(1, 0, rank == 0)
  step = 1 ! u_n - u_{n+1} <= g, by the numbers of all unknowns
  PetscCallA(ISCreateStride(PETSC_COMM_WORLD, rows, n, step, first, ierr))
  PetscCallA(ISCreateStride(PETSC_COMM_WORLD, rows, n + 1, step, second, ierr))
  ierr = FetiFetiSetContactPairs(ff, PETSC_DECIDE, first%v, PETSC_DECIDE, second%v, [g], FETIFETI_INEQUALITY)
  CHKERRA(ierr)
  ! An obstacle that is never reached: -u_n <= d.
  ierr = FetiFetiSetContactRows(ff, rows, [0, 1], [n], [-1.0d0], [d], [FETIFETI_INEQUALITY]); CHKERRA(ierr)
  ierr = FetiFetiSolve(ff, b%v, x%v); CHKERRA(ierr)
  ierr = FetiFetiGetConvergedReason(ff, reason); CHKERRA(ierr)
  ierr = FetiFetiGetMultipliers(ff, 2 * rows, lambda); CHKERRA(ierr)
  if (rank == 0) print '(a,i3,3(a,f12.8))', 'reason', reason, ' force ', lambda(1), ' obstacle ', lambda(2), &
    ' exact ', (d - g) / (2 * n)
  ierr = FetiFetiDestroy(ff); CHKERRA(ierr)
  PetscCallA(VecDestroy(b, ierr))
  PetscCallA(VecDestroy(x, ierr))
  PetscCallA(VecDestroy(held, ierr))
  PetscCallA(ISDestroy(dofs, ierr))
  PetscCallA(ISDestroy(first, ierr))
  PetscCallA(ISDestroy(second, ierr))
  PetscCallA(PetscFinalize(ierr))
contains
  subroutine entry(column, v)
    integer(c_int), intent(in) :: column
    real(c_double), intent(in) :: v
    nnz = nnz + 1
    ja(nnz) = column
    a(nnz) = v
  end subroutine
end program
