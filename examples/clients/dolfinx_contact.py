"""Two elastic bodies with a mesh each in contact, from dolfinx 0.5 (Debian: python3-dolfinx).

    mpirun -n 4 python3 examples/clients/dolfinx_contact.py -fetifeti_ksp_rtol 1e-10

A block of tetrahedra lies on another one with a curved lower side, and is pressed from above. Both meshes are
distributed over all ranks. dolfinx assembles into matrices of type "is" that petsc4py makes: one of dolfinx's own
create_matrix(a, "is") has no room for entries, and assemble_matrix crashes.
"""
import sys

import fetifeti
import numpy as np
import petsc4py

petsc4py.init(sys.argv)
import direct  # noqa: E402
import ufl  # noqa: E402
from dolfinx import fem, mesh  # noqa: E402
from dolfinx.fem.petsc import assemble_matrix, assemble_vector  # noqa: E402
from mpi4py import MPI  # noqa: E402
from petsc4py import PETSc  # noqa: E402

comm = MPI.COMM_WORLD


def matis(V, a):
    """The stiffness of this rank's cells as a matrix of type "is", with the motions that cost no energy."""
    map, bs = V.dofmap.index_map, V.dofmap.index_map_bs
    here = np.arange(map.size_local + map.num_ghosts, dtype=np.int32)
    numbers = PETSc.LGMap().create(map.local_to_global(here).astype(np.int32), bsize=bs, comm=comm)
    size = (bs * map.size_local, bs * map.size_global)
    A = PETSc.Mat().create(comm)
    A.setSizes([size, size], bsize=bs)
    A.setType("is")
    A.setLGMap(numbers)
    A.setUp()
    A.getISLocalMat().setPreallocationNNZ(27 * bs)  # for rows with more: NEW_NONZERO_ALLOCATION_ERR, False
    assemble_matrix(A, a)  # without bcs: they leave a diagonal other than 1 where ranks share an unknown
    A.assemble()
    places = PETSc.Vec().createWithArray(V.tabulate_dof_coordinates()[: map.size_local].ravel(), bsize=bs, comm=comm)
    A.setNearNullSpace(PETSc.NullSpace().createRigidBody(places))
    return A


def block(counts, low, press):
    """A block on [0, 1] x [0, 1] x [low, low + 1]: matrix, load, places of the nodes and their numbers."""
    domain = mesh.create_box(comm, [[0, 0, low], [1, 1, low + 1]], counts, ghost_mode=mesh.GhostMode.none)
    if low:  # the lower side is curved
        x = domain.geometry.x
        x[:, 2] += (2 - x[:, 2]) * (0.02 + 0.3 * (x[:, 0] - 0.5) ** 2 + 0.2 * x[:, 1] ** 2)
    V = fem.VectorFunctionSpace(domain, ("CG", 1))
    u, v, normal = ufl.TrialFunction(V), ufl.TestFunction(V), ufl.FacetNormal(domain)
    strain, stress = ufl.sym(ufl.grad(v)), 2 * ufl.sym(ufl.grad(u)) + ufl.div(u) * ufl.Identity(3)
    A = matis(V, fem.form(ufl.inner(stress, strain) * ufl.dx))
    top = mesh.locate_entities_boundary(domain, 2, lambda x: np.isclose(x[2], 2))
    ds = ufl.Measure("ds", domain, subdomain_data=mesh.meshtags(domain, 2, np.sort(top), np.full(len(top), 1, "i4")))
    b = assemble_vector(fem.form(fem.Constant(domain, -press) * ufl.dot(v, normal) * ds(1)))
    b.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
    map = V.dofmap.index_map
    own = np.arange(map.size_local, dtype=np.int32)
    places, numbers = V.tabulate_dof_coordinates()[own], map.local_to_global(own)
    held = [3 * numbers[np.isclose(places[:, d], 0)] + d for d in range(3)]  # two sides, and the ground
    A.zeroRowsColumns(np.concatenate(held).astype("i4"), diag=1.0, b=b, x=b.duplicate())
    return A, b, places, numbers


def side(places, numbers, here):
    """The nodes of a side, of all ranks, in the order of their places."""
    rows = np.concatenate(comm.allgather(np.column_stack([places, numbers])[here]))
    return rows[np.lexsort(np.round(rows[:, :2], 9).T)]


lower, upper = block([4, 4, 3], 0, 0.0), block([4, 4, 2], 1, 0.1)
first = side(*lower[2:], np.isclose(lower[2][:, 2], 1))
curve = 1 + 0.02 + 0.3 * (upper[2][:, 0] - 0.5) ** 2 + 0.2 * upper[2][:, 1] ** 2
second = side(*upper[2:], np.isclose(upper[2][:, 2], curve))
up = [3 * rows[:, 3].astype("i4") + 2 for rows in (first, second)]  # vertical displacements
gap = second[:, 2] - first[:, 2]
mine = slice(comm.rank, None, comm.size)  # each row is given by one rank, any one
with fetifeti.Solver(comm) as solver:
    solver.add_mat_is(lower[0], body=0)
    solver.add_mat_is(upper[0], body=1)
    solver.add_contact_pairs(up[0][mine], up[1][mine], gap[mine], matrices=(0, 1))
    u = solver.solve([lower[1], upper[1]])
    force, its, steps = comm.allreduce(solver.multipliers.sum()), solver.iterations, solver.contact_steps

# Beside a direct solution of the assembled problem
n, m = lower[1].getSize(), upper[1].getSize()
K, B = np.zeros((n + m, n + m)), np.zeros((len(gap), n + m))
K[:n, :n], K[n:, n:] = direct.dense(lower[0]), direct.dense(upper[0])
B[range(len(gap)), up[0]], B[range(len(gap)), n + up[1]] = 1.0, -1.0
exact, forces = direct.contact(K, np.concatenate([direct.entries(lower[1]), direct.entries(upper[1])]), B, gap)
error = abs(np.concatenate([direct.entries(part) for part in u.getNestSubVecs()]) - exact).max() / abs(exact).max()
PETSc.Sys.Print(f"{n + m} unknowns, {its} iterations in {steps} steps, {(forces > 0).sum()} of {len(gap)} nodes touch")
PETSc.Sys.Print(f"force {force:.9f} of {forces.sum():.9f}, error {error:.1e}")
assert error < 1e-8, "not the solution"
