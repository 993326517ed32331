"""A solver that is used again with other rows, gaps and matrices: against dense solutions, and what it sets up for it.

Two bodies, a row of P squares of M x M elements each, one square on each rank; springs hold the first one.
"""

import re

import numpy as np
import pytest
from petsc4py import PETSc
from test_solver import M, gathered, numbers, size

import fetifeti

OPTIONS = {"ksp_rtol": 1e-13, "contact_rtol": 1e-12}
ELEMENT = np.array([[4, -1, -2, -1], [-1, 4, -1, -2], [-2, -1, 4, -1], [-1, -2, -1, 4]]) / 6


def square(part, seed):
    """The matrix of a square with a coefficient for each element."""
    coefficients = 1 + np.random.default_rng([seed, part]).random(M * M)
    k, w = np.zeros(((M + 1) ** 2,) * 2), M + 1
    for e, c in enumerate(coefficients):
        i, j = e % M, e // M
        nodes = [j * w + i, j * w + i + 1, (j + 1) * w + i + 1, (j + 1) * w + i]
        k[np.ix_(nodes, nodes)] += c * ELEMENT
    return k


def spring(part, body, parts):
    return np.diag(3.0 * (numbers(part, parts) < M + 1) * (body == 0))


def dense(parts, seeds):
    """The assembled matrix of both bodies."""
    n = size(parts)
    k = np.zeros((2 * n, 2 * n))
    for body, seed in enumerate(seeds):
        for p in range(parts):
            at = body * n + numbers(p, parts)
            k[np.ix_(at, at)] += square(p, seed) + spring(p, body, parts)
    return k


def set_entries(A, comm, body, seed, more=0.0):
    """Puts the entries of a body's square on this rank into its MATIS, with `more` on its diagonal."""
    k = square(comm.rank, seed) + spring(comm.rank, body, comm.size) + np.diag(more * np.ones((M + 1) ** 2))
    local = A.getISLocalMat()
    local.zeroEntries()
    starts, columns, _ = local.getValuesCSR()
    rows = np.repeat(np.arange(len(k)), np.diff(starts))
    local.setValuesCSR(starts, columns, k[rows, columns])
    local.assemble()
    A.setISLocalMat(local)
    A.assemble()


def matis(comm, body, seed):
    n, at = size(comm.size), numbers(comm.rank, comm.size)
    map = PETSc.LGMap().create(at, comm=comm)
    A = PETSc.Mat().createIS([n, n], lgmapr=map, lgmapc=map, comm=comm)
    pattern = square(0, 0) != 0
    starts = np.append(0, np.cumsum(pattern.sum(axis=1))).astype("i4")
    columns = np.nonzero(pattern)[1].astype("i4")
    csr = (starts, columns, np.zeros(len(columns)))
    A.setISLocalMat(PETSc.Mat().createAIJ(pattern.shape, csr=csr, comm=PETSc.COMM_SELF))
    A.assemble()
    A.setNearNullSpace(PETSc.NullSpace().create(constant=True, comm=comm))
    set_entries(A, comm, body, seed)
    return A


def mortar(parts, count, seed, columns=2):
    """Rows of 8 to 20 terms between the last columns of nodes of both bodies: means on either side."""
    rng, n = np.random.default_rng(seed), size(parts)
    rows = np.zeros((count, 2 * n))
    for row in rows:
        for body in range(2):
            terms = rng.integers(4, 5 * columns + 1)
            at = n - 1 - rng.permutation(5 * columns)[:terms]
            weights = rng.random(terms) + 0.1
            row[body * n + at] = (1 - 2 * body) * weights / weights.sum()
    return rows


def reference(k, f, rows, gap):
    """Dense active sets by trying."""
    active = np.ones(len(rows), bool)
    for _ in range(100):
        b = rows[active]
        whole = np.block([[k, b.T], [b, np.zeros((len(b),) * 2)]])
        x = np.linalg.solve(whole, np.concatenate([f, gap[active]]))
        u, force = x[: len(f)], np.zeros(len(rows))
        force[active] = x[len(f) :]
        now = (active & (force > 0)) | (rows @ u - gap > 1e-12)
        if np.array_equal(now, active):
            return u, force
        active = now
    raise AssertionError("the reference does not converge")


class Problem:
    """Two bodies in contact by rows with many terms."""

    def __init__(self, comm):
        self.comm, self.n = comm, size(comm.size)
        self.seeds, self.rows = [1, 2], mortar(comm.size, 6, 7)
        self.gap = 0.02 * np.arange(6.0) - 0.05
        self.A = [matis(comm, body, seed) for body, seed in enumerate(self.seeds)]
        self.loads = [A.createVecLeft() for A in self.A]
        self.f = np.concatenate([0.01 * np.cos(np.arange(self.n)), np.zeros(self.n)])
        self.f[-5:] = [-0.5, -0.1, 0.3, -0.2, -0.4]
        low, high = self.loads[0].getOwnershipRange()
        for body, load in enumerate(self.loads):
            load.setArray(self.f[body * self.n + low : body * self.n + high])
        self.solver = fetifeti.Solver(comm, options=OPTIONS)
        for body, A in enumerate(self.A):
            self.solver.add_mat_is(A, body)
        self.give()

    def mine(self, values):
        return values[self.comm.rank :: self.comm.size]

    def give(self):
        rows = self.mine(self.rows)
        blocks = {0: rows[:, : self.n], 1: rows[:, self.n :]}
        self.solver.set_contact_blocks(blocks, self.mine(self.gap), "inequality")

    def agrees(self):
        """Solves, and compares with the dense solution."""
        u = self.solver.solve(self.loads)
        assert self.solver.converged
        exact, force = reference(dense(self.comm.size, self.seeds), self.f, self.rows, self.gap)
        assert 0 < np.sum(force > 0) < len(force), "some of the rows hold"
        found = np.concatenate([gathered(part) for part in u.getNestSubVecs()])
        assert np.abs(found - exact).max() < 1e-11 * np.abs(exact).max()
        assert np.allclose(self.solver.multipliers, self.mine(force), atol=1e-11 * max(1, np.abs(force).max()))

    def counts(self, tmp_path):
        """Set-ups of everything, of numbers, of rows; patterns, subdomains, partitions; the same on all ranks."""
        file = str(tmp_path / "view")
        viewer = PETSc.Viewer().createASCII(file, comm=self.comm)
        self.solver.view(viewer)
        viewer.destroy()
        return counts(self.comm, file)


def counts(comm, file):
    found = np.zeros(6)
    if comm.rank == 0:
        line = next(line for line in open(file) if "set-ups:" in line)
        found[:] = [int(n) for n in re.findall(r"\d+", line)]
    return comm.tompi4py().bcast(found) if comm.size > 1 else found


@pytest.fixture
def problem(world):
    made = Problem(world)
    with made.solver:
        yield made


def test_rows_by_matrix_agree_with_a_direct_solution(problem):
    terms = np.count_nonzero(problem.rows, axis=1)
    assert terms.min() >= 8 and terms.max() > 12 and terms.max() <= 20
    problem.agrees()


def test_mistakes_in_rows_by_matrix(problem):
    solver, n = problem.solver, problem.n
    with pytest.raises(fetifeti.Error, match="contact row 0 names matrix 2 but 2 have been added"):
        solver.set_contact_blocks({2: [[1.0]]})
    with pytest.raises(fetifeti.Error, match=f"row 0 has a coefficient at unknown {n}, expected numbers from 0 to"):
        solver.set_contact_blocks({1: ([0, 1], [n], [1.0])})
    with pytest.raises(ValueError, match=r"the blocks have \[1, 2\] rows"):
        solver.set_contact_blocks({0: [[1.0]], 1: [[1.0], [2.0]]})
    with pytest.raises(ValueError):
        solver.set_contact_gaps(np.zeros(99))
    problem.agrees()


def test_new_gaps_set_up_nothing(problem, tmp_path):
    problem.agrees()
    before = problem.counts(tmp_path)
    for shift in (0.03, -0.02):
        problem.gap = problem.gap + shift * np.cos(np.arange(6))
        problem.solver.set_contact_gaps(problem.mine(problem.gap))
        problem.agrees()
    assert np.array_equal(problem.counts(tmp_path), before)
    assert before[:3].tolist() == [1, 0, 0]


def test_new_rows_factor_what_they_touch(problem, tmp_path):
    problem.agrees()
    before = problem.counts(tmp_path)
    # Between the same nodes: no interface changes.
    problem.rows = problem.rows * (1 + 0.1 * np.random.default_rng(3).random(problem.rows.shape))
    problem.give()
    problem.agrees()
    same = problem.counts(tmp_path)
    assert (same - before)[[0, 1, 2, 4]].tolist() == [0, 0, 1, 0]
    # Other nodes of the last square of either body: those two subdomains alone.
    problem.rows, problem.gap = mortar(problem.comm.size, 5, 11, columns=3), problem.gap[:5]
    problem.give()
    problem.agrees()
    assert (problem.counts(tmp_path) - same)[[0, 1, 2, 4]].tolist() == [0, 0, 1, 2]


def test_new_entries_keep_all_that_follows_from_patterns(problem, tmp_path):
    problem.agrees()
    before = problem.counts(tmp_path)
    problem.seeds = [3, 4]
    for body, A in enumerate(problem.A):
        set_entries(A, problem.comm, body, problem.seeds[body])
    problem.solver.update_matrices(problem.A)
    problem.agrees()
    parts, once = 2 * problem.comm.size, problem.counts(tmp_path)
    # Set-ups of everything, of numbers, of rows; patterns analysed, subdomains factored, partitions.
    assert (once - before).tolist() == [0, 1, 0, 0, parts, 0]
    # One of the matrices, with other rows and gaps at the same time.
    problem.seeds[1], problem.gap = 5, problem.gap + 0.01
    set_entries(problem.A[1], problem.comm, 1, 5)
    problem.rows = problem.rows * (1 + 0.1 * np.random.default_rng(3).random(problem.rows.shape))
    problem.give()
    problem.solver.update_matrices([None, problem.A[1]])
    problem.agrees()
    assert (problem.counts(tmp_path) - once).tolist() == [0, 1, 0, 0, parts, 0]


def test_newtons_method_with_contact(problem, tmp_path):
    """Springs with a force of 2 u^3 at all nodes of the first body. λ is kept."""
    comm, n, gap = problem.comm, problem.n, problem.gap.copy()
    at, u, steps, norms = numbers(comm.rank, comm.size), np.zeros(2 * problem.n), [], []
    shared = np.bincount(np.concatenate([numbers(p, comm.size) for p in range(comm.size)]))
    k = dense(comm.size, problem.seeds)
    low, high = problem.loads[0].getOwnershipRange()
    for _ in range(12):
        force = 2 * np.where(np.arange(2 * n) < n, u, 0) ** 3
        residual = problem.f - k @ u - force
        for body, load in enumerate(problem.loads):
            load.setArray(residual[body * n + low : body * n + high])
        problem.solver.set_contact_gaps(problem.mine(gap - problem.rows @ u))
        du = problem.solver.solve(problem.loads)
        du = np.concatenate([gathered(part) for part in du.getNestSubVecs()])
        u, norms = u + du, [*norms, np.abs(du).max()]
        steps.append(problem.solver.contact_steps)
        if norms[-1] < 1e-12 * np.abs(u).max():
            break
        set_entries(problem.A[0], comm, 0, problem.seeds[0], 6 * u[at] ** 2 / shared[at])
        problem.solver.update_matrices([problem.A[0], None])
    assert norms[-1] < 1e-12 * np.abs(u).max(), norms
    # The springs have no stiffness at u = 0: a subdomain that floats then is held afterwards, another structure.
    whole = min(comm.size, 2)
    assert problem.counts(tmp_path)[:3].tolist() == [whole, len(norms) - whole, 0]
    # The loop ends with the states that it began with: a step with a loose tolerance, one with the given one.
    assert steps[-1] <= 2 < steps[0], steps
    # The multipliers of the last step are those of the whole: all conditions with them.
    forces = np.zeros(len(gap))
    forces[comm.rank :: comm.size] = problem.solver.multipliers
    forces = sum(comm.tompi4py().allgather(forces)) if comm.size > 1 else forces
    force = 2 * np.where(np.arange(2 * n) < n, u, 0) ** 3
    assert np.abs(k @ u + force + problem.rows.T @ forces - problem.f).max() < 1e-10
    remaining = gap - problem.rows @ u
    assert remaining.min() > -1e-10 and forces.min() > -1e-10 and np.abs(remaining * forces).max() < 1e-10
    assert np.abs(force).max() > 1e-3


def test_another_pattern_is_seen(problem, tmp_path):
    problem.agrees()
    before = problem.counts(tmp_path)
    # A boundary condition comes: the last unknown of the second body is held.
    A = problem.A[1]
    low, high = A.getOwnershipRange()
    A.zeroRowsColumns([problem.n - 1] if low <= problem.n - 1 < high else [], diag=1.0)
    problem.solver.update_matrices(problem.A)
    u = problem.solver.solve(problem.loads)
    k = dense(problem.comm.size, problem.seeds)
    k[-1, :], k[:, -1], k[-1, -1] = 0, 0, 1
    # Its value is the load over the diagonal, and no row moves it.
    rows, gap = problem.rows.copy(), problem.gap - problem.rows[:, -1] * problem.f[-1]
    rows[:, -1] = 0
    exact, _ = reference(k, problem.f, rows, gap)
    found = np.concatenate([gathered(part) for part in u.getNestSubVecs()])
    assert np.abs(found - exact).max() < 1e-11 * np.abs(exact).max()
    assert (problem.counts(tmp_path) - before)[:3].tolist() == [1, 0, 0]


def test_mistakes_with_new_entries(problem):
    with pytest.raises(fetifeti.Error, match="there are 1 matrices, expected 2"):
        problem.solver.update_matrices(problem.A[:1])
    with pytest.raises(fetifeti.Error, match="subdomain 0 of rank .* the rank has added 0"):
        problem.solver.update_subdomain(0, np.eye(2))
    world, A = problem.comm, problem.A[1]
    at = numbers((world.rank + 1) % world.size, world.size)[::-1].copy()
    map = PETSc.LGMap().create(at, comm=world)
    other = PETSc.Mat().createIS([problem.n] * 2, lgmapr=map, lgmapc=map, comm=world)
    other.setISLocalMat(A.getISLocalMat())
    other.assemble()
    with pytest.raises(fetifeti.Error, match="matrix 1 has another local-to-global map"):
        problem.solver.update_matrices([None, other])
    problem.agrees()


def test_each_step_is_shown_and_may_end_the_solve(problem):
    steps = []
    problem.solver.on_step(steps.append)
    problem.agrees()
    assert len(steps) == problem.solver.contact_steps > 1
    assert [step.step for step in steps] == list(range(len(steps)))
    assert sum(step.iterations for step in steps) == problem.solver.iterations
    assert steps[-1].entered == steps[-1].left == steps[-1].wrong == 0

    def stop(step):
        raise KeyError(f"step {step.step}")

    problem.solver.on_step(stop)
    problem.solver.set_contact_gaps(problem.mine(problem.gap + 0.01))
    with pytest.raises(KeyError, match="step 0"):
        problem.solver.solve(problem.loads)
    problem.solver.on_step(None)
    problem.solver.set_contact_gaps(problem.mine(problem.gap))
    problem.agrees()


def test_a_ksp_keeps_what_follows_from_patterns(world, tmp_path):
    fetifeti.register()
    A = matis(world, 0, 1)
    b, x, ksp = A.createVecLeft(), A.createVecLeft(), PETSc.KSP().create(world)
    low, high = b.getOwnershipRange()
    b.setArray(np.sin(np.arange(low, high)))
    ksp.setOperators(A)
    ksp.setType("fetifeti")
    ksp.setTolerances(rtol=1e-12)

    def solve(matrix, seed):
        ksp.setOperators(matrix)
        ksp.solve(b, x)
        assert ksp.getConvergedReason() > 0
        n = size(world.size)
        exact = np.linalg.solve(dense(world.size, [seed, 1])[:n, :n], np.sin(np.arange(n)))
        assert np.abs(gathered(x) - exact).max() < 1e-10 * np.abs(exact).max()
        viewer = PETSc.Viewer().createASCII(str(tmp_path / "view"), comm=world)
        ksp.view(viewer)
        viewer.destroy()
        return counts(world, str(tmp_path / "view"))

    first = solve(A, 1)
    set_entries(A, world, 0, 2)
    second = solve(A, 2)
    # Another matrix with the same pattern and another near-null space object asks for everything.
    other = matis(world, 0, 3)
    third = solve(other, 3)
    assert (second - first).tolist() == [0, 1, 0, 0, world.size, 0]
    assert third[:2].tolist() == [1, 0]
    # So do options that are read again.
    set_entries(other, world, 0, 4)
    ksp.setFromOptions()
    assert solve(other, 4)[:2].tolist() == [1, 0]
    # And a reset.
    ksp.reset()
    assert solve(other, 4)[:2].tolist() == [1, 0]
