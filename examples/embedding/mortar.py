"""Two elastic blocks in space with different meshes in contact, from petsc4py: FetiFetiAddMortar joins them.

    LD_LIBRARY_PATH=target/release mpirun -n 2 python3 examples/embedding/mortar.py -fetifeti_ksp_rtol 1e-12

The upper block is pressed on the lower one by a constant load, so that the pressure between them is that load
everywhere. The functions `call` and `argument` are those of contact.py.
"""
import ctypes
import itertools
import sys

import numpy as np
import petsc4py

petsc4py.init(sys.argv)
from petsc4py import PETSc  # noqa: E402

comm, lib, INEQUALITY = PETSc.COMM_WORLD, ctypes.CDLL("libfetifeti.so"), 1
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])


def call(name, *args):
    """Calls a function of fetifeti.h."""
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
    return ctypes.c_double(a) if isinstance(a, float) else ctypes.c_int(a) if isinstance(a, int) else a


def stiffness(h):
    """Of a trilinear box with the edges h, lambda = mu = 1."""
    k, points = np.zeros((8, 3, 8, 3)), 0.5 + np.array([-1, 1]) / np.sqrt(12)
    for p in itertools.product(points, repeat=3):
        factors, signs = np.where(CORNERS, p, 1 - np.array(p)), 2 * CORNERS - 1
        g = np.stack([signs[:, d] * np.prod(np.delete(factors, d, 1), 1) / h[d] for d in range(3)], 1)
        for i, j in itertools.product(range(3), repeat=2):
            k[:, i, :, j] += np.outer(g[:, i], g[:, j]) + np.outer(g[:, j], g[:, i]) + (i == j) * g @ g.T
    return k.reshape(24, 24) * np.prod(h) / 8


def block(ff, counts, low):
    """A block on [0, 1] x [0, 1] x [low, low + 1], held at x = 0 in x and at y = 0 in y; the lower one is held at its
    bottom, the upper one pressed from above. The solver gets its matrix, and its side towards the other block."""
    da = PETSc.DMDA().create([n + 1 for n in counts], dof=3, stencil_width=1, stencil_type="box", comm=comm)
    da.setMatType("is")
    da.setUniformCoordinates(0, 1, 0, 1, low, low + 1)
    A, b, h = da.createMat(), da.createGlobalVec(), 1.0 / np.array(counts)
    k, elements = stiffness(h), da.getElements().reshape(-1, 8)
    for e in elements:
        dofs = (3 * e[:, None] + np.arange(3)).ravel().astype("i4")
        A.setValuesLocal(dofs, dofs, k, addv=True)
    A.assemble()
    A.setNearNullSpace(PETSc.NullSpace().createRigidBody(da.getCoordinates()))
    places = da.getCoordinatesLocal().getArray().reshape(-1, 3)
    numbers = da.getLGMap().getIndices().reshape(-1, 3)
    for e in elements:  # a quarter of each face's load to its corners
        for node in e[4:] if low else []:
            if abs(places[node, 2] - 2) < 1e-9:
                b.setValue(numbers[node, 2], -0.1 * h[0] * h[1] / 4, addv=True)
    b.assemble()
    held = [numbers[np.abs(places[:, d]) < 1e-9, d] for d in range(3)]
    A.zeroRowsColumns(np.unique(np.concatenate(held[: 2 if low else 3])), diag=1.0)
    call("FetiFetiAddMatIS", ff, A, None, low)
    side = [0, 3, 2, 1] if low else [4, 5, 6, 7]  # anticlockwise for whoever looks at it from outside
    faces = np.array([e[side] for e in elements if abs(places[e[side[0]], 2] - 1) < 1e-9], "i4").reshape(-1, 4)
    start, dofs = 4 * np.arange(len(faces) + 1, dtype="i4"), np.ascontiguousarray(numbers, "i4")
    call("FetiFetiAddSurface", ff, low, 3, 3, len(places), dofs, places.copy(), len(faces), start, faces, None)
    return A, b, len(places)


ff = ctypes.c_void_p()
call("FetiFetiCreateFortran", comm.fortran, ctypes.byref(ff))
call("FetiFetiSetFromOptions", ff)
lower, upper = block(ff, [4, 5, 3], 0), block(ff, [3, 3, 4], 1)
call("FetiFetiAddMortar", ff, 0, 1, INEQUALITY, 0.0, 0.0, 0.0, None, None, None)
load = PETSc.Vec().createNest([lower[1], upper[1]], comm=comm)
u, n = load.duplicate(), lower[2]
call("FetiFetiSolve", ff, load, u)
pressure, state = np.zeros(n), np.zeros(n, "i4")
call("FetiFetiGetMortar", ff, 0, n, None, pressure, None, state)
call("FetiFetiDestroy", ctypes.byref(ff))
error = np.abs(pressure[state >= 0] - 0.1).max(initial=0.0)
PETSc.Sys.syncPrint(f"pressure 0.1 but for {error:.2e} at {np.sum(state >= 0)} nodes", comm=comm)
PETSc.Sys.syncFlush(comm=comm)
assert error < 1e-10, "not the pressure that was expected"
