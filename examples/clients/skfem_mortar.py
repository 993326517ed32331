"""Two elastic bodies with unstructured meshes in contact, from scikit-fem, cut into parts by METIS.

    pip install scikit-fem==12.0.2 pymetis==2025.2.2 typing_extensions    # and scipy
    mpirun -n 4 python3 examples/clients/skfem_mortar.py -fetifeti_ksp_rtol 1e-10

A body with a round lower side is pressed on a block; the meshes do not match. scikit-fem integrates the mortar rows
itself, with the usual hat functions as multipliers, so that the multipliers are pressures. Every rank knows both meshes
and assembles its parts of them.
"""
import sys

import fetifeti
import numpy as np
import petsc4py

petsc4py.init(sys.argv)
import direct  # noqa: E402
import pymetis  # noqa: E402
import scipy.sparse  # noqa: E402
import scipy.spatial  # noqa: E402
import skfem  # noqa: E402
from petsc4py import PETSc  # noqa: E402
from skfem.models.elasticity import lame_parameters, linear_elasticity  # noqa: E402
from skfem.supermeshing import elementwise_quadrature, intersect  # noqa: E402

comm, element = PETSc.COMM_WORLD, skfem.ElementVector(skfem.ElementTriP1())
elasticity, PARTS = linear_elasticity(*lame_parameters(1.0, 0.3)), 6


def triangles(n, seed):
    """A Delaunay mesh of the unit square whose inner nodes are at random places."""
    x, y = np.array(np.divmod(np.arange((n + 1) ** 2), n + 1)) / n
    inner = (x > 0) & (x < 1) & (y > 0) & (y < 1)
    p = np.array([x, y]) + np.random.default_rng(seed).uniform(-0.3 / n, 0.3 / n, (2, len(x))) * inner
    return skfem.MeshTri(p, scipy.spatial.Delaunay(p.T).simplices.T.astype(np.int64))


def add_parts(solver, mesh, body, first):
    """Hands the parts of a mesh over that are this rank's; its unknowns are numbered from `first`."""
    # By sides (ncommon): in parts by nodes cells hang by a corner, and every such hinge costs iterations.
    part = np.array(pymetis.part_mesh(PARTS, mesh.t.T.tolist(), None, None, pymetis.GType.DUAL, 2).element_part)
    for k in range(comm.rank, PARTS, comm.size):
        cells = skfem.Basis(mesh, element, elements=np.flatnonzero(part == k))
        dofs = np.unique(cells.element_dofs)
        solver.add_subdomain(elasticity.assemble(cells)[dofs][:, dofs], first + dofs, body)


lower, upper = triangles(9, 1), triangles(7, 2).translated([0, 1])
upper.doflocs[1] += (2 - upper.p[1]) * 0.3 * (upper.p[0] - 0.6) ** 2  # its lower side is round
bodies = [lower, upper]
whole = [skfem.Basis(mesh, element) for mesh in bodies]
n, total = whole[0].N, whole[0].N + whole[1].N

# Mortar rows: integrals of a hat function of the lower side times u_lower - u_upper, and times the gap
sides = [m.facets_satisfying(lambda x: (abs(x[1] - 1) < 0.12) & (x[0] % 1 > 0), boundaries_only=True) for m in bodies]
traces = zip(bodies, sides)
lines, facets = zip(*(m.trace(side, mtype=skfem.MeshLine, project=lambda p: p[:1]) for m, side in traces))
common, *owner = intersect(*lines)
rules = [elementwise_quadrature(line, common, own) for line, own in zip(lines, owner)]
hats, below, above = (
    skfem.FacetBasis(mesh, kind, facets=facets[k][owner[k]], quadrature=rules[k])
    for mesh, kind, k in ((lower, skfem.ElementTriP1(), 0), (lower, element, 0), (upper, element, 1))
)
times = skfem.BilinearForm(lambda m, v, w: m * v[1])  # the first basis is the flat side: it has the lengths
nodes = np.unique(lower.facets[:, facets[0]])
B = scipy.sparse.hstack([times.assemble(hats, below).T, -times.assemble(hats, above).T]).tocsr()[nodes]
distance = above.global_coordinates().value[1] - 1
gap = skfem.LinearForm(lambda m, w: m * w["distance"]).assemble(hats, distance=distance)[nodes]

# The lower body stands on the ground, the upper one is pressed from above; both are held at their left
top = skfem.FacetBasis(upper, element, facets=upper.facets_satisfying(lambda x: x[1] > 2 - 1e-9))
load = np.concatenate([np.zeros(n), skfem.LinearForm(lambda v, w: -0.02 * v[1]).assemble(top)])
left = [basis.get_dofs(lambda x: x[0] < 1e-9).all("u^1") for basis in whole]
ground = whole[0].get_dofs(lambda x: x[1] < 1e-9).all("u^2")
held = np.unique(np.concatenate([left[0], n + left[1], ground]))

b = PETSc.Vec().createMPI(total, bsize=2, comm=comm)
mine = slice(*b.getOwnershipRange())
b.setArray(load[mine])
with fetifeti.Solver(comm) as solver:
    solver.set_sizes(b.getLocalSize(), total)
    solver.set_block_size(2)
    solver.set_coordinates(np.hstack([lower.p, upper.p]).T[mine.start // 2 : mine.stop // 2])
    add_parts(solver, lower, 0, 0)
    add_parts(solver, upper, 1, n)
    solver.set_dirichlet(held)
    rows = slice(comm.rank, None, comm.size)  # any rank may give a row
    solver.set_contact_rows(B[rows], gap[rows])
    u = direct.entries(solver.solve(b))
    its, steps, pressures = solver.iterations, solver.contact_steps, solver.multipliers
# Beside a direct solution of the assembled problem
K = scipy.sparse.block_diag([elasticity.assemble(basis) for basis in whole]).toarray()
K[held] = K[:, held] = load[held] = 0
K[held, held] = 1
exact, expected = direct.contact(K, load, B.toarray(), gap)
error = abs(u - exact).max() / abs(exact).max()
PETSc.Sys.Print(f"{total} unknowns, {its} iterations in {steps} steps, {sum(expected > 0)} of {len(nodes)} rows hold")
PETSc.Sys.Print(f"error {error:.1e}")
assert error < 1e-8 and np.allclose(pressures, expected[rows], atol=1e-8 * expected.max()), "not the solution"
