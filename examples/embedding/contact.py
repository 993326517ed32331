"""Plane elasticity on DMDAs from petsc4py, and two blocks in contact: fetifeti.h by ctypes.

    LD_LIBRARY_PATH=target/release mpirun -n 2 python3 examples/embedding/contact.py [-contact] [-m 17]

The same problems as in contact.c. Without -contact: one block, held at its left (in x) and at its bottom (in y),
pressed from above, solved by any KSP. With it a second block with a curved lower side lies on the first one, and the
press is on that.
"""
import ctypes
import sys

import numpy as np
import petsc4py

petsc4py.init(sys.argv)
from petsc4py import PETSc  # noqa: E402

comm, options = PETSc.COMM_WORLD, PETSc.Options()
m, contact = options.getInt("m", 17), options.getBool("contact", False)


def stiffness():
    """Of a bilinear square under plane stress, E = 1, nu = 0.3; nodes anticlockwise from the lower left."""
    nu, sx, sy = 0.3, np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
    d = np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]]) / (1 - nu**2)
    k = np.zeros((8, 8))
    for x, y in zip(sx / np.sqrt(3), sy / np.sqrt(3)):
        b = np.zeros((3, 8))
        b[0, 0::2] = b[2, 1::2] = sx * (1 + sy * y) / 4
        b[1, 1::2] = b[2, 0::2] = sy * (1 + sx * x) / 4
        k += b.T @ d @ b
    return k


def unknowns(da, n, first, step):
    """n unknowns of the first rank: their numbers in the grid are first, first + step, ..."""
    return da.getAO().app2petsc(PETSc.IS().createStride(0 if comm.rank else n, first, step, comm=comm))


def block(hold, press):
    """A block of m x m nodes: grid, matrix and load; the bottom is held and the top pressed where that is wanted."""
    da = PETSc.DMDA().create([m, m], dof=2, stencil_width=1, stencil_type="box", comm=comm)
    da.setMatType("is")
    da.setUniformCoordinates(0, 1, 0, 1)
    A, b, k = da.createMat(), da.createGlobalVec(), stiffness()
    for e in da.getElements():
        dofs = np.array([[2 * i, 2 * i + 1] for i in e], "i4").ravel()
        A.setValuesLocal(dofs, dofs, k, addv=True)
    A.assemble()
    A.setNearNullSpace(PETSc.NullSpace().createRigidBody(da.getCoordinates()))
    left, bottom, top = unknowns(da, m, 0, 2 * m), unknowns(da, m, 1, 2), unknowns(da, m, 2 * m * (m - 1) + 1, 2)
    weight = np.full(top.getLocalSize(), 0.1 / (m - 1))
    weight[[0, -1] if len(weight) else []] /= 2
    b.setValues(top.getIndices(), -weight * press)
    b.assemble()
    A.zeroRowsColumns(np.concatenate([left.getIndices(), bottom.getIndices()[: m * hold]]), diag=1.0)
    return da, A, b, bottom, top


if not contact:
    da, A, b, *_ = block(hold=True, press=True)
    ctypes.CDLL("libfetifeti.so").FetiFetiInitializePackage()  # for -ksp_type fetifeti
    ksp, u = PETSc.KSP().create(comm), b.duplicate()
    ksp.setOperators(A)
    ksp.setFromOptions()
    ksp.solve(b, u)
    PETSc.Sys.Print(f"{ksp.getIterationNumber()} iterations, energy {-b.dot(u) / 2:.9f}")
    sys.exit()

# the recipe: how functions of fetifeti.h are called, for any program
lib = ctypes.CDLL("libfetifeti.so")
DECIDE, EQUALITY, INEQUALITY = -1, 0, 1


def call(name, *args):
    """Calls a function: PETSc objects (None is NULL), integers, NumPy arrays of float64 and int32, ctypes.byref of a
    handle. An error is PETSc's."""
    code = getattr(lib, name)(*[argument(a) for a in args])
    if code:
        raise PETSc.Error(code)


def argument(a):
    """What ctypes can pass; an array is passed by its place, so that results can be written to it."""
    if isinstance(a, PETSc.Object):
        return ctypes.c_void_p(a.handle)
    if isinstance(a, np.ndarray):
        assert a.dtype in ("f8", "i4") and a.flags.c_contiguous, "expected float64 or int32 without gaps"
        return ctypes.c_void_p(a.ctypes.data)
    return ctypes.c_int(a) if isinstance(a, int) else a


# contact
lower = block(hold=True, press=False)
upper = block(hold=False, press=True)
load = PETSc.Vec().createNest([lower[2], upper[2]], comm=comm)
u = load.duplicate()
n = 0 if comm.rank else m  # the first rank gives the rows
gap, force = 0.05 + 0.4 * (np.arange(n) / (m - 1)) ** 2, np.zeros(n)
ff = ctypes.c_void_p()
call("FetiFetiCreateFortran", comm.fortran, ctypes.byref(ff))
call("FetiFetiSetFromOptions", ff)
call("FetiFetiAddMatIS", ff, lower[1], None, 0)
call("FetiFetiAddMatIS", ff, upper[1], None, 1)
call("FetiFetiSetContactPairs", ff, 0, lower[4], 1, upper[3], gap, INEQUALITY)  # top of the one, bottom of the other
call("FetiFetiSolve", ff, load, u)
call("FetiFetiGetMultipliers", ff, n, force)
reason = np.zeros(1, "i4")
call("FetiFetiGetConvergedReason", ff, reason)
call("FetiFetiDestroy", ctypes.byref(ff))
# end of contact

PETSc.Sys.Print(f"reason {reason[0]}, work {-load.dot(u):.9f}")
PETSc.Sys.Print(f"{np.sum(force > 1e-10)} of {m} nodes touch, force {force.sum():.9f}")
