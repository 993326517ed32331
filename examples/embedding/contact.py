"""Plane elasticity on DMDAs from petsc4py, and two blocks in contact: the package of wrappers/python.

    mpirun -n 2 python3 examples/embedding/contact.py [-contact] [-m 17]

The same problems as in contact.c. Without -contact: one block, held at its left (in x) and at its bottom (in y),
pressed from above, solved by any KSP. With it a second block with a curved lower side lies on the first one, and the
press is on that.
"""
import sys

import fetifeti
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
    fetifeti.register()  # for -ksp_type fetifeti
    ksp, u = PETSc.KSP().create(comm), b.duplicate()
    ksp.setOperators(A)
    ksp.setFromOptions()
    ksp.solve(b, u)
    PETSc.Sys.Print(f"{ksp.getIterationNumber()} iterations, energy {-b.dot(u) / 2:.9f}")
    sys.exit()

# contact
lower = block(hold=True, press=False)
upper = block(hold=False, press=True)
load = PETSc.Vec().createNest([lower[2], upper[2]], comm=comm)
n = 0 if comm.rank else m  # the first rank gives the rows
gap = 0.05 + 0.4 * (np.arange(n) / (m - 1)) ** 2
with fetifeti.Solver(comm) as solver:
    solver.add_mat_is(lower[1], body=0)
    solver.add_mat_is(upper[1], body=1)
    solver.add_contact_pairs(lower[4], upper[3], gap, matrices=(0, 1))  # top of the one, bottom of the other
    u = solver.solve(load)
    force, reason = solver.multipliers, solver.reason
# end of contact

PETSc.Sys.Print(f"reason {reason}, work {-load.dot(u):.9f}")
PETSc.Sys.Print(f"{np.sum(force > 1e-10)} of {m} nodes touch, force {force.sum():.9f}")
