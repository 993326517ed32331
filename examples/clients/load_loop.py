"""A load that rises and falls, in a loop that sets up once: two membranes, the upper one pressed on the lower one.

    mpirun -n 4 python3 examples/clients/load_loop.py [-load_steps 8] -fetifeti_ksp_rtol 1e-10

Factors, coarse problem and rows stay as long as matrices and rows do; a solve takes the new load and the new values of
held unknowns, and starts from the multipliers of the last one. Each step is compared with a direct solution.
"""
import sys

import fetifeti
import numpy as np
import petsc4py

petsc4py.init(sys.argv)
import direct  # noqa: E402
from petsc4py import PETSc  # noqa: E402

comm, options = PETSc.COMM_WORLD, PETSc.Options()
steps, m = options.getInt("load_steps", 8), 12  # elements on a side, 2 x 2 parts in each membrane
node = np.arange((m + 1) ** 2).reshape(m + 1, m + 1)
square = np.array([[4, -1, -2, -1], [-1, 4, -1, -2], [-2, -1, 4, -1], [-1, -2, -1, 4]]) / 6  # of -Laplace, any size
n = node.size


def stiffness(rows, columns):
    """Of a rectangle of elements: the matrix and the nodes of its rows."""
    here = node[rows[0] : rows[1] + 1, columns[0] : columns[1] + 1].ravel()
    out = np.zeros((n, n))
    for i in range(*rows):
        for j in range(*columns):
            corners = [node[i, j], node[i, j + 1], node[i + 1, j + 1], node[i + 1, j]]
            out[np.ix_(corners, corners)] += square
    return out[np.ix_(here, here)], here


edge = np.setdiff1d(node, node[1:-1, 1:-1])
held = np.concatenate([edge, n + edge])
y, x = np.array(np.divmod(np.arange(n), m + 1)) / m
inner = node[1:-1, 1:-1].ravel()
gap = 0.03 + 0.1 * x[inner] * y[inner]
rows = np.zeros((len(inner), 2 * n))  # u_lower - u_upper <= gap
rows[range(len(inner)), inner], rows[range(len(inner)), n + inner] = 1, -1

whole = stiffness((0, m), (0, m))[0]
K = np.kron(np.eye(2), whole)  # for the direct solution
K[held], K[held, held] = 0, 1

load = PETSc.Vec().createMPI(2 * n, comm=comm)
values, u = load.duplicate(), load.duplicate()
mine, some = slice(*load.getOwnershipRange()), slice(comm.rank, None, comm.size)
with fetifeti.Solver(comm) as solver:
    solver.set_sizes(load.getLocalSize(), 2 * n)
    for k in range(comm.rank, 8, comm.size):  # parts of this rank: four of each body
        half = [(0, m // 2), (m // 2, m)]
        matrix, dofs = stiffness(half[k % 2], half[k // 2 % 2])
        solver.add_subdomain(matrix, n * (k // 4) + dofs, body=k // 4)
    solver.set_dirichlet(held, values)
    solver.set_contact_rows(rows[some], gap[some])
    solver.setup()
    kept = solver.inner_ksp.handle
    for step in range(1, steps + 1):
        t = 1 - abs(2 * step / steps - 1)  # up to 1 and down to 0
        f, given = np.zeros(2 * n), np.zeros(2 * n)
        f[n + inner] = -8 * t / m**2
        given[n + edge] = -0.02 * t  # the edge of the upper one sinks
        load.setArray(f[mine])
        values.setArray(given[mine])
        solver.solve(load, u)
        assert solver.converged and solver.inner_ksp.handle == kept, "it was set up again"

        f[held] = given[held]
        exact, forces = direct.contact(K, f, rows, gap)
        error = abs(direct.entries(u) - exact).max() / max(abs(exact).max(), 1e-3)
        touch = f"{(forces > 0).sum()} of {len(gap)} nodes touch"
        PETSc.Sys.Print(f"load {t:.2f}: {solver.iterations} iterations, {touch}, error {error:.1e}")
        assert error < 1e-8, "not the solution"
