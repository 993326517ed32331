! Two squares of -u'' with one and with two elements on their common side, in contact by FetiFetiAddMortar: u falls from
! 0 to -1 through both, so the flux between them is 1/2. Calls with and without what is optional.
program mortars
#include <petsc/finclude/petscvec.h>
  use petscvec
  use fetifeti
  implicit none
  type(c_ptr) :: ff
  Vec :: b, x, held
  IS :: dofs
  PetscErrorCode :: ierr
  PetscMPIInt :: rank
  PetscInt :: nall, none, at(5)
  PetscScalar :: value(5)
  integer(c_int) :: i, surface(2), mortar, state(3), n
  real(c_double) :: lambda(3), pressure(3), gap(3)
  real(c_double), parameter :: square(16) = [4, -1, -1, -2, -1, 4, -2, -1, -1, -2, 4, -1, -2, -1, -1, 4] / 6d0
  ! the same of a half, 1/2 wide and 1 high: nodes from left to right, the lower ones first
  real(c_double), parameter :: half(16) = [10, -7, 2, -5, -7, 10, -5, 2, 2, -5, 10, -7, -5, 2, -7, 10] / 12d0

  PetscCallA(PetscInitialize(ierr))
  call MPI_Comm_rank(PETSC_COMM_WORLD, rank, ierr)
  nall = 10
  ierr = FetiFetiCreateFortran(PETSC_COMM_WORLD, ff); CHKERRA(ierr)
  ierr = FetiFetiSetSizes(ff, PETSC_DECIDE, nall); CHKERRA(ierr)
  if (rank == 0) then
    call add(0, square, [0, 1, 2, 3])
    call add(1, half, [4, 5, 7, 8])
    call add(1, half, [5, 6, 8, 9])
  end if
  ! faces on one rank: the lower side from right to left, the upper one's from left to right
  n = merge(1, 0, rank == 0)
  ierr = FetiFetiAddSurface(ff, PETSC_DECIDE, 2, 1, 2 * n, [2, 3], [0d0, 1d0, 1d0, 1d0], n, [0, 2], [1, 0], surface(1))
  CHKERRA(ierr)
  ierr = FetiFetiAddSurface(ff, PETSC_DECIDE, 2, 1, 3 * n, [4, 5, 6], [0d0, 1d0, 0.5d0, 1d0, 1d0, 1d0], 2 * n, &
    [0, 2, 4], [0, 1, 1, 2], surface(2))
  CHKERRA(ierr)
  ierr = FetiFetiAddMortar(ff, surface(2), surface(1), FETIFETI_EQUALITY, 0d0, 0d0, 0d0, mortar=mortar); CHKERRA(ierr)
  ierr = FetiFetiResetMortar(ff); CHKERRA(ierr)
  ierr = FetiFetiAddSurface(ff, PETSC_DECIDE, 2, 1, 2 * n, [2, 3], [0d0, 1d0, 1d0, 1d0], n, [0, 2], [1, 0], surface(1))
  CHKERRA(ierr)
  ierr = FetiFetiAddSurface(ff, PETSC_DECIDE, 2, 1, 3 * n, [4, 5, 6], [0d0, 1d0, 0.5d0, 1d0, 1d0, 1d0], 2 * n, &
    [0, 2, 4], [0, 1, 1, 2], surface(2))
  CHKERRA(ierr)
  ierr = FetiFetiAddMortar(ff, surface(1), surface(2), FETIFETI_INEQUALITY, 0d0, 0d0, -0.5d0, [0.5d0, 0.5d0], [0, 0], &
    mortar)
  CHKERRA(ierr)
  PetscCallA(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, nall, b, ierr))
  PetscCallA(VecDuplicate(b, x, ierr))
  PetscCallA(VecDuplicate(b, held, ierr))
  at = [0, 1, 7, 8, 9]
  value = [0, 0, -1, -1, -1]
  none = merge(5, 0, rank == 0)
  PetscCallA(VecSetValues(held, none, at, value, INSERT_VALUES, ierr))
  PetscCallA(VecAssemblyBegin(held, ierr))
  PetscCallA(VecAssemblyEnd(held, ierr))
  PetscCallA(ISCreateGeneral(PETSC_COMM_WORLD, none, at, PETSC_COPY_VALUES, dofs, ierr))
  ierr = FetiFetiSetDirichletBoundaries(ff, dofs%v, held%v); CHKERRA(ierr)
  ierr = FetiFetiSolve(ff, b%v, x%v); CHKERRA(ierr)
  ierr = FetiFetiGetMortar(ff, mortar, 2 * n, lambda, pressure, gap, state); CHKERRA(ierr)
  if (rank == 0) print '(2(a,2f13.9),a,2i3,a)', 'lambda ', lambda(:2), ' pressure ', pressure(:2), ' state', &
    state(:2), ' end'
  ierr = FetiFetiGetMortar(ff, mortar, 2 * n, pressure=pressure); CHKERRA(ierr)
  if (rank == 0) print '(a,2f13.9)', 'pressure alone ', pressure(:2)
  ierr = FetiFetiDestroy(ff); CHKERRA(ierr)
  PetscCallA(VecDestroy(b, ierr))
  PetscCallA(VecDestroy(x, ierr))
  PetscCallA(VecDestroy(held, ierr))
  PetscCallA(ISDestroy(dofs, ierr))
  PetscCallA(PetscFinalize(ierr))
contains
  subroutine add(body, k, numbers)
    integer(c_int), intent(in) :: body, numbers(4)
    real(c_double), intent(in) :: k(16)
    ierr = FetiFetiAddSubdomain(ff, body, 4, [0, 4, 8, 12, 16], [(mod(i, 4), i = 0, 15)], k, numbers)
  end subroutine
end program
