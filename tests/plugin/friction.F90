! Two nodes on springs of stiffness 1 that are pressed on a rigid plane by 1 and pulled along it: friction by rows, and
! by FetiFetiAddMortar with a surface that does not move. Calls with and without what is optional.
program friction
#include <petsc/finclude/petscvec.h>
  use petscvec
  use fetifeti
  implicit none
  type(c_ptr) :: ff
  Vec :: b, x
  IS :: dofs
  PetscErrorCode :: ierr
  PetscMPIInt :: rank
  PetscInt :: nall, none, held(4)
  integer(c_int) :: n, surface(2), state(2), mortar
  real(c_double) :: force(4), slip(4), shear(4), lambda(2)
  real(c_double), parameter :: down(2) = [-1, -1], none_at(2) = 0

  PetscCallA(PetscInitialize(ierr))
  call MPI_Comm_rank(PETSC_COMM_WORLD, rank, ierr)
  nall = 8
  ierr = FetiFetiCreateFortran(PETSC_COMM_WORLD, ff); CHKERRA(ierr)
  ierr = FetiFetiSetSizes(ff, PETSC_DECIDE, nall); CHKERRA(ierr)
  ierr = FetiFetiSetBlockSize(ff, 2); CHKERRA(ierr)
  n = merge(1, 0, rank == 0)
  ! nodes 0 and 1 are held, 2 and 3 hang on them
  if (rank == 0) then
    call spring(0, [0, 1, 4, 5])
    call spring(1, [2, 3, 6, 7])
  end if
  held = [0, 1, 2, 3]
  none = 4 * n
  PetscCallA(ISCreateGeneral(PETSC_COMM_WORLD, none, held, PETSC_COPY_VALUES, dofs, ierr))
  ierr = FetiFetiSetDirichletBoundaries(ff, dofs%v, 0_c_intptr_t); CHKERRA(ierr)
  PetscCallA(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, nall, b, ierr))
  PetscCallA(VecDuplicate(b, x, ierr))

  ierr = FetiFetiSetContactRows(ff, 2 * n, [0, 1, 2], [5, 7], down, none_at, &
    [FETIFETI_INEQUALITY, FETIFETI_INEQUALITY])
  CHKERRA(ierr)
  ierr = FetiFetiSetContactLaw(ff, 2 * n, friction=[0.5d0, 0.5d0]); CHKERRA(ierr)
  call pull(0.9d0)
  ierr = FetiFetiGetContactFriction(ff, 2 * n, 2, force, slip, state); CHKERRA(ierr)
  if (rank == 0) print '(2(a,f13.9),a,i2)', 'slips: force ', force(1), ' slips: slip ', slip(3), ' slips: state ', &
    state(2)
  ierr = FetiFetiNextContactStep(ff); CHKERRA(ierr)
  call pull(0.2d0)
  ierr = FetiFetiGetContactFriction(ff, 2 * n, 2, force, slip, state); CHKERRA(ierr)
  if (rank == 0) print '(2(a,f13.9),a,i2)', 'sticks: force ', force(1), ' sticks: slip ', slip(1), ' sticks: state ', &
    state(1)
  ierr = FetiFetiSetContactSlip(ff, 2 * n, 2); CHKERRA(ierr)
  ierr = FetiFetiSetContactLaw(ff, 2 * n, tresca=[0.3d0, 0.3d0], limit=[FETIFETI_INFINITY, FETIFETI_INFINITY], &
    stick_stiffness=[2d0, 2d0])
  CHKERRA(ierr)
  call pull(0.4d0)
  ierr = FetiFetiGetContactFriction(ff, 2 * n, 2, force=force, state=state); CHKERRA(ierr)
  if (rank == 0) print '(a,f13.9,a,i2)', 'elastic: force ', force(1), ' elastic: state ', state(1)
  ierr = FetiFetiSetContactRows(ff, 0, [0], [0], down, none_at, [0]); CHKERRA(ierr)

  ! the lower side of the nodes from left to right, the upper side of what does not move from right to left
  ierr = FetiFetiAddSurface(ff, PETSC_DECIDE, 2, 2, 2 * n, [4, 5, 6, 7], [0d0, 0d0, 1d0, 0d0], n, [0, 2], [0, 1], &
    surface(1))
  CHKERRA(ierr)
  ierr = FetiFetiAddSurface(ff, PETSC_DECIDE, 2, 2, 2 * n, [-1, -1, -1, -1], [0d0, 0d0, 1d0, 0d0], n, [0, 2], [1, 0], &
    surface(2))
  CHKERRA(ierr)
  ierr = FetiFetiAddMortar(ff, surface(1), surface(2), FETIFETI_INEQUALITY, 0d0, 0d0, 0d0, mortar=mortar); CHKERRA(ierr)
  ierr = FetiFetiSetMortarLaw(ff, mortar, 0.5d0, FETIFETI_INFINITY, 0d0, FETIFETI_INFINITY, FETIFETI_INFINITY)
  CHKERRA(ierr)
  call pull(0.9d0)
  ierr = FetiFetiGetMortar(ff, mortar, 2 * n, lambda, state=state); CHKERRA(ierr)
  ierr = FetiFetiGetMortarFriction(ff, mortar, 2 * n, shear=shear, slip=slip); CHKERRA(ierr)
  if (rank == 0) print '(2(a,f13.9),a,2i2)', 'mortar: shear ', shear(1), ' mortar: slip ', slip(3), ' mortar: state ', &
    state
  ierr = FetiFetiDestroy(ff); CHKERRA(ierr)
  PetscCallA(VecDestroy(b, ierr))
  PetscCallA(VecDestroy(x, ierr))
  PetscCallA(ISDestroy(dofs, ierr))
  PetscCallA(PetscFinalize(ierr))
contains
  subroutine spring(body, numbers)
    integer(c_int), intent(in) :: body, numbers(4)
    ierr = FetiFetiAddSubdomain(ff, body, 4, [0, 2, 4, 6, 8], [0, 2, 1, 3, 0, 2, 1, 3], &
      [1d0, -1d0, 1d0, -1d0, -1d0, 1d0, -1d0, 1d0], numbers)
  end subroutine
  ! Solves with this force along the plane on both nodes.
  subroutine pull(along)
    real(c_double), intent(in) :: along
    PetscInt :: at(4)
    PetscScalar :: value(4)
    at = [4, 5, 6, 7]
    value = [along, -1d0, along, -1d0]
    PetscCallA(VecSetValues(b, none, at, value, INSERT_VALUES, ierr))
    PetscCallA(VecAssemblyBegin(b, ierr))
    PetscCallA(VecAssemblyEnd(b, ierr))
    ierr = FetiFetiSolve(ff, b%v, x%v)
    CHKERRA(ierr)
  end subroutine
end program
