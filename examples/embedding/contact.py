"""Two elastic bars in contact from petsc4py: fetifeti.h by ctypes.

    LD_LIBRARY_PATH=target/release mpirun -n 2 python3 examples/embedding/contact.py

Each bar is a DMDA with its own matrix (MATIS) and load, as a program for one bar has it. The left one is held at its left end, the
right one pushed to the left against it by a load; the gap between them is 0.25.
"""
import ctypes
import sys

import numpy as np
import petsc4py

petsc4py.init(sys.argv)
from petsc4py import PETSc  # noqa: E402

comm, n, force = PETSc.COMM_WORLD, 12, 0.05


def bar(first):
    """A bar of n springs with its load; the first one is held, the other one is pushed."""
    da = PETSc.DMDA().create([n + 1], dof=1, stencil_width=1, comm=comm)
    da.setMatType("is")
    A, b = da.createMat(), da.createGlobalVec()
    for e in da.getElements():
        A.setValuesLocal(e, e, [1.0, -1.0, -1.0, 1.0], addv=True)
    A.assemble()
    if first:
        A.zeroRowsColumns([0] if comm.rank == 0 else [], diag=1.0)
    elif comm.rank == comm.size - 1:
        b.setValue(b.getSize() - 1, -force)
    b.assemble()
    return da, A, b


def numbers(da, start):
    """Where a bar's unknowns stand among those of both."""
    first, last = da.getGlobalVec().getOwnershipRange()
    return PETSc.IS().createStride(last - first, first + start, 1, comm=comm)


# contact
lib = ctypes.CDLL("libfetifeti.so")


def call(name, *args):
    """Calls a function of fetifeti.h; an error is PETSc's."""
    code = getattr(lib, name)(*args)
    if code:
        raise PETSc.Error(code)


def c(values, kind):
    """A NumPy array as C takes it."""
    return np.ascontiguousarray(values, kind).ctypes.data_as(ctypes.c_void_p)


def handle(obj):
    """A PETSc object as C takes it."""
    return ctypes.c_void_p(obj.handle)


bars, starts = [bar(True), bar(False)], [0, n + 1]
b = PETSc.Vec().createMPI((None, 2 * n + 2), comm=comm)
x = b.duplicate()
ff = ctypes.c_void_p()
call("FetiFetiCreateFortran", ctypes.c_int(comm.fortran), ctypes.byref(ff))
call("FetiFetiSetFromOptions", ff)
call("FetiFetiSetSizes", ff, b.getLocalSize(), b.getSize())
for body, ((da, A, load), start) in enumerate(zip(bars, starts)):
    where = numbers(da, start)
    call("FetiFetiAddMatIS", ff, handle(A), handle(where), body)
    b.setValues(where.getIndices(), load.getArray())
b.assemble()
rows = 1 if comm.rank == 0 else 0  # u_n - u_(n+1) <= 0.25, given by the first rank
call("FetiFetiSetContactRows", ff, rows, c([0, 2], "i4"), c([n, n + 1], "i4"), c([1, -1], "f8"), c([0.25], "f8"), c([1], "i4"))
call("FetiFetiSolve", ff, handle(b), handle(x))
reason, multiplier = ctypes.c_int(), (ctypes.c_double * 1)()
call("FetiFetiGetConvergedReason", ff, ctypes.byref(reason))
call("FetiFetiGetMultipliers", ff, rows, multiplier)
call("FetiFetiDestroy", ctypes.byref(ff))
# end of contact

# The left bar gives way by n force, the right one lies against it.
first, last = x.getOwnershipRange()
k = np.arange(first, last)
exact = np.where(k <= n, -force * k, -force * n - 0.25 - force * (k - n - 1))
error = PETSc.Vec().createWithArray(np.abs(x.getArray() - exact), comm=comm).max()[1]
PETSc.Sys.Print(f"reason {reason.value} force {multiplier[0]:.8f} error {error:.2e}")
