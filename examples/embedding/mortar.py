"""Two elastic blocks in space with different meshes in contact, from petsc4py: mortar rows join them.

    mpirun -n 2 python3 examples/embedding/mortar.py -fetifeti_ksp_rtol 1e-12

The upper block is pressed on the lower one by a constant load, so that the pressure between them is that load
everywhere. The package is that of wrappers/python.
"""
import itertools
import sys

import fetifeti
import numpy as np
import petsc4py

petsc4py.init(sys.argv)
from petsc4py import PETSc  # noqa: E402

comm = PETSc.COMM_WORLD
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])


def stiffness(h):
    """Of a trilinear box with the edges h, lambda = mu = 1."""
    k, points = np.zeros((8, 3, 8, 3)), 0.5 + np.array([-1, 1]) / np.sqrt(12)
    for p in itertools.product(points, repeat=3):
        factors, signs = np.where(CORNERS, p, 1 - np.array(p)), 2 * CORNERS - 1
        g = np.stack([signs[:, d] * np.prod(np.delete(factors, d, 1), 1) / h[d] for d in range(3)], 1)
        for i, j in itertools.product(range(3), repeat=2):
            k[:, i, :, j] += np.outer(g[:, i], g[:, j]) + np.outer(g[:, j], g[:, i]) + (i == j) * g @ g.T
    return k.reshape(24, 24) * np.prod(h) / 8


def block(solver, counts, low):
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
    solver.add_mat_is(A, body=low)
    side = [0, 3, 2, 1] if low else [4, 5, 6, 7]  # anticlockwise for whoever looks at it from outside
    faces = [e[side] for e in elements if abs(places[e[side[0]], 2] - 1) < 1e-9]
    solver.add_surface(places, numbers, faces, matrix=low)
    return A, b


with fetifeti.Solver(comm) as solver:
    lower, upper = block(solver, [4, 5, 3], 0), block(solver, [3, 3, 4], 1)
    solver.add_mortar(0, 1)
    solver.solve([lower[1], upper[1]])
    pressure, state = solver.mortar(0).pressure, solver.mortar(0).state
error = np.abs(pressure[state >= 0] - 0.1).max(initial=0.0)
PETSc.Sys.syncPrint(f"pressure 0.1 but for {error:.2e} at {np.sum(state >= 0)} nodes", comm=comm)
PETSc.Sys.syncFlush(comm=comm)
assert error < 1e-10, "not the pressure that was expected"
