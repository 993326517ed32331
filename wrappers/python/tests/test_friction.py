"""Friction and soft contact of `fetifeti.Solver`: nodes on springs of stiffness 1 that are pressed on planes of any
direction and pulled along them, against closed forms.
"""

import numpy as np
import pytest

import fetifeti
from fetifeti import RowState

N, MU = 4, 0.4
OPTIONS = {"ksp_rtol": 1e-12, "contact_rtol": 1e-11}


class Nodes:
    """N nodes on each rank, each with a spring to a node that is held; row k is about a node of the next rank."""

    def __init__(self, comm, dim, normal=None, held=()):
        self.comm, self.dim = comm, dim
        self.count = N * comm.size
        rng = np.random.default_rng(5)
        normals = rng.normal(size=(self.count, dim)) if normal is None else np.tile(normal, (self.count, 1))
        self.normals = normals / np.linalg.norm(normals, axis=1)[:, None]
        self.press = 1 + rng.random(self.count)
        spring = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.eye(dim))
        self.solver = fetifeti.Solver(comm, options=OPTIONS)
        self.solver.set_block_size(dim)
        size = 2 * N * dim
        self.solver.set_sizes(size, size * comm.size)
        self.mine = slice(comm.rank * size, (comm.rank + 1) * size)
        for node in range(comm.rank * N, (comm.rank + 1) * N):
            ends = np.concatenate([self.dofs(node), self.dofs(self.count + node)])
            self.solver.add_subdomain(spring, ends, body=node)
        anchors = np.arange(dim * self.count, 2 * dim * self.count)
        self.solver.set_dirichlet([*anchors, *(dim * node + c for node in range(self.count) for c in held)])
        self.own = (np.arange(N) + N * ((comm.rank + 1) % comm.size)) % self.count
        columns = np.concatenate([self.dofs(node) for node in self.own])
        self.solver.set_contact_rows((dim * np.arange(N + 1), columns, self.normals[self.own].ravel()))

    def dofs(self, node):
        return self.dim * node + np.arange(self.dim)

    def solve(self, pull):
        """Displacements of all nodes under the pressure and these forces along the planes."""
        force = self.press[:, None] * self.normals + pull
        whole = np.concatenate([force.ravel(), np.zeros(force.size)])
        u = self.solver.solve(whole[self.mine])
        assert self.solver.converged
        parts = self.comm.tompi4py().allgather(u) if self.comm.size > 1 else [u]
        return np.concatenate(parts)[: force.size].reshape(force.shape)

    def along(self, vectors):
        return vectors - np.sum(vectors * self.normals, axis=1)[:, None] * self.normals

    def pulls(self, seed, most):
        return self.along(np.random.default_rng(seed).uniform(-most, most, (self.count, self.dim)))


def step(pull, before, bound):
    """Displacements and forces of friction of nodes that stood at `before`."""
    trial = pull - before
    size = np.linalg.norm(trial, axis=1)[:, None]
    slips = size > bound[:, None]
    force = np.where(slips, bound[:, None] * trial / np.maximum(size, 1e-30), trial)
    return pull - force, force, slips[:, 0]


@pytest.mark.parametrize("dim", [2, 3])
def test_load_steps_with_friction(world, dim):
    nodes = Nodes(world, dim)
    with nodes.solver as solver:
        own, u, seen = nodes.own, np.zeros((nodes.count, dim)), set()
        solver.set_contact_law(friction=0.05)
        solver.set_contact_law(friction=np.full(N, MU))
        for k in range(3):
            pull = nodes.pulls(k, 1.0)
            before = u
            if k:
                solver.next_contact_step()
            found = nodes.solve(pull)
            u, force, slips = step(pull, before, MU * nodes.press)
            seen.update(slips.tolist())
            assert np.abs(found - u).max() < 1e-8
            friction = solver.contact_friction
            assert np.abs(friction.force - force[own]).max() < 1e-8
            assert np.abs(friction.slip - (u - before)[own]).max() < 1e-8
            assert np.array_equal(friction.state, np.where(slips[own], RowState.SLIP, RowState.STICK))
            assert np.abs(solver.multipliers - nodes.press[own]).max() < 1e-8
        assert seen == {False, True}, "nodes stick and slip"
        # The same load step once more, with another law; a limit, too.
        solver.set_contact_law(friction=0.8, limit=0.5)
        u, _, _ = step(pull, before, np.minimum(0.8 * nodes.press, 0.5))
        assert np.abs(nodes.solve(pull) - u).max() < 1e-8
        # Where the sides stand without a slip is given in place of the history.
        given = nodes.pulls(7, 0.3)
        solver.set_contact_slip(given[own] + 3.0 * nodes.normals[own])
        u, _, _ = step(pull, given, np.minimum(0.8 * nodes.press, 0.5))
        assert np.abs(nodes.solve(pull) - u).max() < 1e-8


def test_friction_in_a_plane_of_symmetry(world):
    """Where a component is held on a plane of symmetry, nodes in space slide along the other one."""
    nodes = Nodes(world, 3, normal=[0.0, 1.0, 0.0], held=[2])
    with nodes.solver as solver:
        solver.set_contact_law(friction=MU)
        pull = nodes.pulls(3, 1.0) * [1, 0, 0]
        u, force, slips = step(pull, 0 * pull, MU * nodes.press)
        assert slips.any()
        assert np.abs(nodes.solve(pull) - u).max() < 1e-8
        assert np.abs(solver.contact_friction.force - force[nodes.own]).max() < 1e-8


@pytest.mark.parametrize("dim", [2, 3])
def test_soft_contact(world, dim):
    nodes = Nodes(world, dim)
    with nodes.solver as solver:
        solver.set_contact_law(tresca=2.0, stiffness=3.0, stick_stiffness=np.full(N, 4.0))
        pull = nodes.pulls(1, 1.0)
        u = nodes.press[:, None] / 4 * nodes.normals + pull / 5
        assert np.abs(nodes.solve(pull) - u).max() < 1e-8
        friction = solver.contact_friction
        assert np.abs(friction.force - 0.8 * pull[nodes.own]).max() < 1e-8
        assert np.abs(friction.slip).max() < 1e-8
        assert np.all(friction.state == RowState.STICK)
        assert np.abs(solver.multipliers - 0.75 * nodes.press[nodes.own]).max() < 1e-8
        # Without a law the rows are hard and slippery again.
        solver.set_contact_law()
        assert np.abs(nodes.solve(pull) - pull).max() < 1e-8
        assert np.all(solver.contact_friction.state == RowState.HOLDS)


def test_friction_of_a_mortar(world):
    """A side of two nodes at a distance of 2 on a surface that does not move."""
    spring = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.eye(2))
    first = world.rank == 0
    with fetifeti.Solver(world, options=OPTIONS) as solver:
        solver.set_block_size(2)
        solver.set_sizes(8 * first, 8)
        for k in range(2 * first):
            solver.add_subdomain(spring, [2 * k, 2 * k + 1, 4 + 2 * k, 5 + 2 * k], body=k)
        solver.set_dirichlet([4, 5, 6, 7])
        places, none = [[0, 0], [2, 0]], np.full((2, 2), -1)
        solver.add_surface(places, [[0, 1], [2, 3]], [[0, 1]])
        solver.add_surface(places, none, [[1, 0]])
        mortar = solver.add_mortar(0, 1)
        solver.set_mortar_law(mortar, friction=0.5)
        load = np.array([0.9, -1.0, 0.3, -1.0, 0, 0, 0, 0])[: 8 * first]
        for k in range(2):
            if k:
                solver.next_contact_step()
            u = solver.solve(load)
            found, friction = solver.mortar(mortar), solver.mortar_friction(mortar)
            slip = [[0.4 * (k == 0), 0], [0, 0]]
            assert np.abs(found.multiplier - 1).max() < 1e-8
            assert np.abs(friction.force - [[0.5, 0], [0.3, 0]]).max() < 1e-8
            assert np.abs(friction.shear - friction.force).max() < 1e-8  # each node has an area of 1
            assert np.abs(friction.slip - slip).max() < 1e-8
            assert found.state[1] == RowState.STICK and (k or found.state[0] == RowState.SLIP)
            assert not first or np.abs(u[:4] - [0.4, 0, 0, 0]).max() < 1e-8
        # The surface is dragged by 0.3: what sticks goes along, and its springs bear less.
        solver.set_mortar_slip(friction.slip + [[0.7, 0], [0.3, 0]] if first else None)
        u = solver.solve(load)
        assert np.abs(solver.mortar_friction(mortar).force - [[0.2, 0], [0, 0]]).max() < 1e-8
        assert not first or np.abs(u[:4] - [0.7, 0, 0.3, 0]).max() < 1e-8
        with pytest.raises(ValueError, match="slip has the shape"):
            solver.set_mortar_slip(np.ones((3, 2)), mortar)


def test_mistakes_are_exceptions(world):
    nodes = Nodes(world, 2)
    with nodes.solver as solver:
        for law, sentence in [
            ({"friction": -0.1}, "coefficient of friction of -0.1, expected a number that is not negative"),
            ({"limit": 1.0}, "limit of friction without friction"),
            ({"friction": 0.2, "tresca": 1.0}, "Tresca bound beside a coefficient of friction"),
            ({"stiffness": 0.0}, "contact stiffness of 0, expected a positive number"),
            ({"stick_stiffness": 1.0}, "stick stiffness without friction"),
        ]:
            with pytest.raises(fetifeti.Error, match=sentence):
                solver.set_contact_law(**law)
        with pytest.raises(ValueError, match="friction has the shape"):
            solver.set_contact_law(friction=np.ones(N + 1))
        with pytest.raises(ValueError, match="slip has the shape"):
            solver.set_contact_slip(np.ones((N, 3)))
        with pytest.raises(ValueError, match="there is no mortar 0"):
            solver.mortar_friction()
        starts, entries = 2 * np.arange(N + 1), np.ones(2 * N)
        columns = np.concatenate([nodes.dofs(node) for node in nodes.own])
        solver.set_contact_rows((starts, columns, entries), kind="equality")
        with pytest.raises(fetifeti.Error, match="has friction and is an equation, expected an inequality"):
            solver.set_contact_law(friction=0.1)
