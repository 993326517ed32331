"""`fetifeti.Solver` and the KSP type on rows of square membranes: against dense and LU solutions.

A body is a row of P squares of m x m elements, one on each rank: subdomains with common unknowns.
"""

import numpy as np
import pytest
from conftest import square
from petsc4py import PETSc

import fetifeti

M = 4
OPTIONS = {"ksp_rtol": 1e-12, "contact_rtol": 1e-11}


def numbers(part, parts):
    """The unknowns of a square of a row of squares, whose nodes are numbered column by column."""
    i, j = np.meshgrid(np.arange(M + 1), np.arange(M + 1))
    return ((part * M + i) * (M + 1) + j).ravel().astype("i4")


def size(parts):
    return (parts * M + 1) * (M + 1)


def dense(parts):
    """The assembled matrix of a row."""
    k, local = np.zeros((size(parts),) * 2), square(M)
    for p in range(parts):
        at = numbers(p, parts)
        k[np.ix_(at, at)] += local
    return k


def matis(comm, spring=0.0):
    """The matrix of a row as MATIS, one square on each rank; `spring` ties the first column of nodes to the ground."""
    n = size(comm.size)
    at = numbers(comm.rank, comm.size)
    map = PETSc.LGMap().create(at, comm=comm)
    A = PETSc.Mat().createIS([n, n], lgmapr=map, lgmapc=map, comm=comm)
    k = square(M) + np.diag(spring * (at < M + 1))
    starts = np.arange(len(at) + 1, dtype="i4") * len(at)
    columns = np.tile(np.arange(len(at), dtype="i4"), len(at))
    A.setISLocalMat(PETSc.Mat().createAIJ(k.shape, csr=(starts, columns, k.ravel()), comm=PETSc.COMM_SELF))
    A.assemble()
    constant = PETSc.NullSpace().create(constant=True, comm=comm)
    A.setNearNullSpace(constant)
    return A


def gathered(vec):
    """All entries of a vector on every rank."""
    scatter, whole = PETSc.Scatter.toAll(vec)
    scatter.scatter(vec, whole)
    return whole.getArray().copy()


def contact_reference(parts, spring, f, gap):
    """Two rows above each other, u_lower - u_upper <= gap in the last column: dense active sets by trying."""
    n = size(parts)
    k = np.zeros((2 * n, 2 * n))
    k[:n, :n] = dense(parts) + np.diag(spring * (np.arange(n) < M + 1))
    k[n:, n:] = dense(parts)
    rows = np.zeros((M + 1, 2 * n))
    for r, dof in enumerate(range(n - M - 1, n)):
        rows[r, dof], rows[r, n + dof] = 1, -1
    active = np.ones(M + 1, bool)
    for _ in range(50):
        b = rows[active]
        whole = np.block([[k, b.T], [b, np.zeros((len(b),) * 2)]])
        x = np.linalg.solve(whole, np.concatenate([f, gap[active]]))
        u, force = x[: 2 * n], np.zeros(M + 1)
        force[active] = x[2 * n :]
        violated = rows @ u - gap > 1e-12
        now = (active & (force > 0)) | violated
        if np.array_equal(now, active):
            return u, force
        active = now
    raise AssertionError("the reference does not converge")


@pytest.mark.parametrize("bodies", ["one", "by rank", "by row"])
def test_registered_ksp_agrees_with_lu(world, bodies):
    fetifeti.register()
    fetifeti.register()
    A = matis(world, spring=2.0)
    b = A.createVecLeft()
    low, high = b.getOwnershipRange()
    b.setArray(np.sin(np.arange(low, high)))
    ksp, x = PETSc.KSP().create(world), b.duplicate()
    ksp.setOperators(A)
    ksp.setType("fetifeti")
    if bodies == "by row":
        fetifeti.set_body_is(ksp, np.full(high - low, 2))
    else:
        fetifeti.set_body(ksp, 0 if bodies == "one" else world.rank)
    ksp.setTolerances(rtol=1e-12)
    ksp.solve(b, x)
    assert ksp.getConvergedReason() > 0
    assert isinstance(fetifeti.inner_ksp(ksp), PETSc.KSP)
    # PETSc's LU of the assembled matrix, on this rank alone.
    k = dense(world.size) + np.diag(2.0 * (np.arange(size(world.size)) < M + 1))
    direct = PETSc.Mat().createDense(k.shape, array=k, comm=PETSc.COMM_SELF)
    lu, y = PETSc.KSP().create(PETSc.COMM_SELF), direct.createVecLeft()
    lu.setOperators(direct)
    lu.setType("preonly")
    lu.getPC().setType("lu")
    right = direct.createVecLeft()
    right.setArray(gathered(b))
    lu.solve(right, y)
    assert np.abs(gathered(x) - y.getArray()).max() < 1e-9 * np.abs(y.getArray()).max()


def test_mistakes_with_a_ksp_are_exceptions(world):
    ksp = PETSc.KSP().create(world)
    with pytest.raises(fetifeti.Error) as caught:
        fetifeti.inner_ksp(ksp)
    assert caught.value.ierr > 0
    ksp.setOperators(PETSc.Mat().createAIJ([4, 4], nnz=1, comm=world))
    fetifeti.register()
    ksp.setType("fetifeti")
    fetifeti.set_body_label(ksp, "no label of any mesh")
    with pytest.raises(PETSc.Error):
        ksp.setUp()


@pytest.mark.parametrize("way", ["pairs", "rows"])
def test_contact_of_two_matrices(world, way):
    parts, spring = world.size, 3.0
    n, bodies = size(parts), [matis(world, spring), matis(world)]
    loads = [A.createVecLeft() for A in bodies]
    low, high = loads[0].getOwnershipRange()
    whole = [0.01 * np.cos(np.arange(n)), np.zeros(n)]
    whole[1][n - M - 1 :] = [-0.5, -0.1, 0.3, -0.2, -0.4]
    for load, values in zip(loads, whole):
        load.setArray(values[low:high])
    gap = 0.02 * np.arange(M + 1.0)
    side = np.arange(n - M - 1, n) if world.rank == 0 else []
    with fetifeti.Solver(world, options=OPTIONS) as solver:
        for body, A in enumerate(bodies):
            solver.add_mat_is(A, body)
        mine = gap if world.rank == 0 else []
        if way == "pairs":
            solver.add_contact_pairs(side, side, mine, matrices=(0, 1))
        else:
            # In the numbering of all unknowns a rank's part of the second matrix follows that of the first.
            ends = np.append(loads[0].getOwnershipRanges(), n)
            owner = np.searchsorted(ends[: parts + 1], side, "right") - 1 if len(side) else np.zeros(0, int)
            first = np.asarray(side, int) + ends[owner]
            second = np.asarray(side, int) + ends[owner + 1]
            columns = np.stack([first, second], 1).ravel()
            starts, entries = 2 * np.arange(len(mine) + 1), np.tile([1.0, -1.0], len(mine))
            solver.set_contact_rows((starts, columns, entries), mine, "inequality")
        u = solver.solve(loads)
        assert solver.converged and solver.reason > 0
        assert solver.contact_steps > 1 and solver.iterations >= 0
        assert solver.kkt.stationarity < 1e-9 and solver.kkt.feasibility < 1e-9
        least, largest = solver.spectrum
        assert 0 < least <= largest
        force = solver.multipliers
    exact, pressed = contact_reference(parts, spring, np.concatenate(whole), gap)
    found = np.concatenate([gathered(part) for part in u.getNestSubVecs()])
    assert 0 < np.sum(pressed > 0) < M + 1, "some of the nodes touch"
    assert np.abs(found - exact).max() < 1e-8 * np.abs(exact).max()
    if world.rank == 0:
        assert np.abs(force - pressed).max() < 1e-8
    else:
        assert force.shape == (0,)
