! The functions of fetifeti.h for Fortran; their manual pages are there. PETSc objects are passed by their
! %v, NULL is 0:
!
!   type(c_ptr) :: ff
!   ierr = FetiFetiCreateFortran(PETSC_COMM_WORLD, ff)
!   ierr = FetiFetiSolve(ff, b%v, x%v)
module fetifeti
  use, intrinsic :: iso_c_binding
  implicit none

  integer(c_int), parameter :: FETIFETI_EQUALITY = 0, FETIFETI_INEQUALITY = 1
  integer(c_int), parameter :: FETIFETI_OPEN = 0, FETIFETI_HOLDS = 1, FETIFETI_STICK = 2, FETIFETI_SLIP = 3
  ! PETSC_INFINITY
  real(c_double), parameter :: FETIFETI_INFINITY = huge(1d0) / 4

  type, bind(C) :: FetiFetiContactStep
    integer(c_int) :: step, active, entered, left, wrong, iterations
    real(c_double) :: residual, tolerance
  end type

  interface
    function FetiFetiCreateFortran(comm, ff) bind(C, name="FetiFetiCreateFortran") result(ierr)
      import :: c_int, c_ptr
      integer(c_int), value :: comm
      type(c_ptr) :: ff
      integer(c_int) :: ierr
    end function
    function FetiFetiDestroy(ff) bind(C, name="FetiFetiDestroy") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr) :: ff
      integer(c_int) :: ierr
    end function
    function FetiFetiReset(ff) bind(C, name="FetiFetiReset") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr), value :: ff
      integer(c_int) :: ierr
    end function
    ! prefix ends with c_null_char.
    function FetiFetiSetOptionsPrefix(ff, prefix) bind(C, name="FetiFetiSetOptionsPrefix") result(ierr)
      import :: c_int, c_ptr, c_char
      type(c_ptr), value :: ff
      character(c_char) :: prefix(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiSetFromOptions(ff) bind(C, name="FetiFetiSetFromOptions") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr), value :: ff
      integer(c_int) :: ierr
    end function
    function FetiFetiView(ff, viewer) bind(C, name="FetiFetiView") result(ierr)
      import :: c_int, c_ptr, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_intptr_t), value :: viewer
      integer(c_int) :: ierr
    end function
    function FetiFetiSetSizes(ff, n, nall) bind(C, name="FetiFetiSetSizes") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr), value :: ff
      integer(c_int), value :: n, nall
      integer(c_int) :: ierr
    end function
    function FetiFetiSetBlockSize(ff, bs) bind(C, name="FetiFetiSetBlockSize") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr), value :: ff
      integer(c_int), value :: bs
      integer(c_int) :: ierr
    end function
    function FetiFetiAddSubdomain(ff, body, n, ia, ja, a, dofs) bind(C, name="FetiFetiAddSubdomain") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: body, n
      integer(c_int), intent(in) :: ia(*), ja(*), dofs(*)
      real(c_double), intent(in) :: a(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiSetMatIS(ff, mat, body) bind(C, name="FetiFetiSetMatIS") result(ierr)
      import :: c_int, c_ptr, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_intptr_t), value :: mat
      integer(c_int), value :: body
      integer(c_int) :: ierr
    end function
    function FetiFetiAddMatIS(ff, mat, numbers, body) bind(C, name="FetiFetiAddMatIS") result(ierr)
      import :: c_int, c_ptr, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_intptr_t), value :: mat, numbers
      integer(c_int), value :: body
      integer(c_int) :: ierr
    end function
    function FetiFetiUpdateMatrices(ff, n, mats) bind(C, name="FetiFetiUpdateMatrices") result(ierr)
      import :: c_int, c_ptr, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_int), value :: n
      integer(c_intptr_t), intent(in) :: mats(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiUpdateSubdomain(ff, s, n, ia, ja, a) bind(C, name="FetiFetiUpdateSubdomain") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: s, n
      integer(c_int), intent(in) :: ia(*), ja(*)
      real(c_double), intent(in) :: a(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiSetNearNullSpace(ff, space) bind(C, name="FetiFetiSetNearNullSpace") result(ierr)
      import :: c_int, c_ptr, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_intptr_t), value :: space
      integer(c_int) :: ierr
    end function
    function FetiFetiSetCoordinates(ff, dim, n, coords) bind(C, name="FetiFetiSetCoordinates") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: dim, n
      real(c_double), intent(in) :: coords(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiSetDirichletBoundaries(ff, dofs, values) &
        bind(C, name="FetiFetiSetDirichletBoundaries") result(ierr)
      import :: c_int, c_ptr, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_intptr_t), value :: dofs, values
      integer(c_int) :: ierr
    end function
    function FetiFetiSetNeumannBoundaries(ff, dofs) bind(C, name="FetiFetiSetNeumannBoundaries") result(ierr)
      import :: c_int, c_ptr, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_intptr_t), value :: dofs
      integer(c_int) :: ierr
    end function
    function FetiFetiSetPrimalDofs(ff, dofs) bind(C, name="FetiFetiSetPrimalDofs") result(ierr)
      import :: c_int, c_ptr, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_intptr_t), value :: dofs
      integer(c_int) :: ierr
    end function
    function FetiFetiSetContactRows(ff, n, ia, ja, b, gap, kind) bind(C, name="FetiFetiSetContactRows") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: n
      integer(c_int), intent(in) :: ia(*), ja(*), kind(*)
      real(c_double), intent(in) :: b(*), gap(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiSetContactRowsByMatrix(ff, n, ia, matrix, ja, b, gap, kind) &
        bind(C, name="FetiFetiSetContactRowsByMatrix") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: n
      integer(c_int), intent(in) :: ia(*), matrix(*), ja(*), kind(*)
      real(c_double), intent(in) :: b(*), gap(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiSetContactGaps(ff, n, gap) bind(C, name="FetiFetiSetContactGaps") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: n
      real(c_double), intent(in) :: gap(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiSetContactPairs(ff, a, first, b, second, gap, kind) &
        bind(C, name="FetiFetiSetContactPairs") result(ierr)
      import :: c_int, c_ptr, c_double, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_int), value :: a, b, kind
      integer(c_intptr_t), value :: first, second
      real(c_double), intent(in), optional :: gap(*)
      integer(c_int) :: ierr
    end function
    ! Arrays that are left out: no row has that part of a law.
    function FetiFetiSetContactLaw(ff, n, friction, limit, tresca, stiffness, stick_stiffness) &
        bind(C, name="FetiFetiSetContactLaw") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: n
      real(c_double), intent(in), optional :: friction(*), limit(*), tresca(*), stiffness(*), stick_stiffness(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiSetContactSlip(ff, n, dim, slip) bind(C, name="FetiFetiSetContactSlip") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: n, dim
      real(c_double), intent(in), optional :: slip(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiNextContactStep(ff) bind(C, name="FetiFetiNextContactStep") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr), value :: ff
      integer(c_int) :: ierr
    end function
    function FetiFetiGetContactFriction(ff, n, dim, force, slip, state) &
        bind(C, name="FetiFetiGetContactFriction") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: n, dim
      real(c_double), optional :: force(*), slip(*)
      integer(c_int), optional :: state(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiAddSurface(ff, matrix, dim, components, n, dofs, coords, nfaces, start, nodes, surface) &
        bind(C, name="FetiFetiAddSurface") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: matrix, dim, components, n, nfaces
      integer(c_int), intent(in) :: dofs(*), start(*), nodes(*)
      real(c_double), intent(in) :: coords(*)
      integer(c_int), intent(out) :: surface
      integer(c_int) :: ierr
    end function
    function FetiFetiAddMortar(ff, first, second, kind, reach, adjust, gap, gaps, without, mortar) &
        bind(C, name="FetiFetiAddMortar") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: first, second, kind
      real(c_double), value :: reach, adjust, gap
      real(c_double), intent(in), optional :: gaps(*)
      integer(c_int), intent(in), optional :: without(*)
      integer(c_int), intent(out) :: mortar
      integer(c_int) :: ierr
    end function
    function FetiFetiSetMortarLaw(ff, mortar, friction, limit, tresca, stiffness, stick_stiffness) &
        bind(C, name="FetiFetiSetMortarLaw") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: mortar
      real(c_double), value :: friction, limit, tresca, stiffness, stick_stiffness
      integer(c_int) :: ierr
    end function
    function FetiFetiSetMortarSlip(ff, mortar, n, slip) bind(C, name="FetiFetiSetMortarSlip") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: mortar, n
      real(c_double), intent(in), optional :: slip(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiGetMortar(ff, mortar, n, lambda, pressure, gap, state) &
        bind(C, name="FetiFetiGetMortar") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: mortar, n
      real(c_double), optional :: lambda(*), pressure(*), gap(*)
      integer(c_int), optional :: state(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiGetMortarFriction(ff, mortar, n, force, shear, slip) &
        bind(C, name="FetiFetiGetMortarFriction") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: mortar, n
      real(c_double), optional :: force(*), shear(*), slip(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiResetMortar(ff) bind(C, name="FetiFetiResetMortar") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr), value :: ff
      integer(c_int) :: ierr
    end function
    ! monitor is c_funloc of a function with bind(C) of a FetiFetiContactStep and a type(c_ptr), value.
    function FetiFetiContactMonitorSet(ff, monitor, ctx) bind(C, name="FetiFetiContactMonitorSet") result(ierr)
      import :: c_int, c_ptr, c_funptr
      type(c_ptr), value :: ff, ctx
      type(c_funptr), value :: monitor
      integer(c_int) :: ierr
    end function
    function FetiFetiSetUp(ff) bind(C, name="FetiFetiSetUp") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr), value :: ff
      integer(c_int) :: ierr
    end function
    function FetiFetiSolve(ff, b, x) bind(C, name="FetiFetiSolve") result(ierr)
      import :: c_int, c_ptr, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_intptr_t), value :: b, x
      integer(c_int) :: ierr
    end function
    function FetiFetiGetIterations(ff, its) bind(C, name="FetiFetiGetIterations") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr), value :: ff
      integer(c_int) :: its, ierr
    end function
    function FetiFetiGetContactSteps(ff, steps) bind(C, name="FetiFetiGetContactSteps") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr), value :: ff
      integer(c_int) :: steps, ierr
    end function
    function FetiFetiGetConvergedReason(ff, reason) bind(C, name="FetiFetiGetConvergedReason") result(ierr)
      import :: c_int, c_ptr
      type(c_ptr), value :: ff
      integer(c_int) :: reason, ierr
    end function
    function FetiFetiGetSpectrum(ff, least, most) bind(C, name="FetiFetiGetSpectrum") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      real(c_double) :: least, most
      integer(c_int) :: ierr
    end function
    function FetiFetiGetKKT(ff, kkt) bind(C, name="FetiFetiGetKKT") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      real(c_double) :: kkt(4)
      integer(c_int) :: ierr
    end function
    function FetiFetiGetMultipliers(ff, n, lambda) bind(C, name="FetiFetiGetMultipliers") result(ierr)
      import :: c_int, c_ptr, c_double
      type(c_ptr), value :: ff
      integer(c_int), value :: n
      real(c_double) :: lambda(*)
      integer(c_int) :: ierr
    end function
    function FetiFetiGetInnerKSP(ff, ksp) bind(C, name="FetiFetiGetInnerKSP") result(ierr)
      import :: c_int, c_ptr, c_intptr_t
      type(c_ptr), value :: ff
      integer(c_intptr_t) :: ksp
      integer(c_int) :: ierr
    end function
  end interface
end module fetifeti
