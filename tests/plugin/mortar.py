"""Rows with many terms, and mortars, against a direct solution of the dense optimality system.

    mortar.py -dim 2 -order 1 -components 2 -kind 1 -by rows|mortar [-spread] [-patch [-cells simplex|serendipity]]

Two blocks [0, 1]^dim of tensor-product elements, or of simplices or serendipity elements, lie on each other, turned in
space, 0.01 apart; the far sides are held at given displacements. The rows of -by rows are made here: dual mortar rows
for elements of first order, as products of rows in one dimension, else collocation in the nodes. -by mortar leaves them
to FetiFetiAddMortar. -spread: faces are given by the ranks that have them, with some by several ranks. -patch: without
loads, and lambda = 0, the pressure is the same everywhere.
"""
import ctypes
import itertools
import sys

import numpy as np
import petsc4py

petsc4py.init(sys.argv)
from petsc4py import PETSc  # noqa: E402

comm, options = PETSc.COMM_WORLD, PETSc.Options()
dim, order = options.getInt("dim", 2), options.getInt("order", 1)
c, kind = options.getInt("components", dim), options.getInt("kind", 1)
by, spread = options.getString("by", "rows"), options.getBool("spread", False)
patch, lame = options.getBool("patch", False), 0.0 if options.getBool("patch", False) else 1.0
scale, cells = options.getReal("scale", 1.0), options.getString("cells", "tensor")
assert patch or cells == "tensor", "only pressures are known of other elements"
lib = ctypes.PyDLL("libfetifeti.so")


def call(name, *args):
    """Calls a function of fetifeti.h."""
    code = getattr(lib, name)(*[argument(a) for a in args])
    if code:
        raise PETSc.Error(code)


def argument(a):
    if isinstance(a, PETSc.Object):
        return ctypes.c_void_p(a.handle)
    if isinstance(a, np.ndarray):
        assert a.dtype in ("f8", "i4") and a.flags.c_contiguous
        return ctypes.c_void_p(a.ctypes.data)
    return ctypes.c_double(a) if isinstance(a, float) else ctypes.c_int(a) if isinstance(a, int) else a


def line(t):
    """Functions of a segment [0, 1] and their slopes at t, for nodes from left to right."""
    if order == 1:
        return np.array([1 - t, t]), np.array([-1.0, 1.0])
    return (np.array([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)]),
            np.array([4 * t - 3, 4 - 8 * t, 4 * t - 1]))


def pieces():
    """The elements of a cell: the places of their nodes in it, from 0 to order, and how many corners they have."""
    everywhere = list(itertools.product(range(order + 1), repeat=dim))
    if cells == "serendipity":
        everywhere = [a for a in everywhere if a.count(1) <= 1]
    if cells != "simplex":
        return [(np.array(everywhere), 0)]
    out = []
    for way in itertools.permutations(range(dim)):
        corners = np.cumsum([np.zeros(dim, int)] + [np.eye(dim, dtype=int)[d] for d in way], axis=0)
        middles = [a + b for a, b in itertools.combinations(corners, 2)] if order == 2 else []
        out.append((np.array([order * a for a in corners] + middles), dim + 1))
    return out


def quadrature(corners):
    """Points and weights on the unit cube, or on a simplex of volume 1 / dim! with these corners."""
    points, weights = np.polynomial.legendre.leggauss(order + 2)
    for q in itertools.product(range(order + 2), repeat=dim):
        t, w = (1 + points[list(q)]) / 2, np.prod(weights[list(q)] / 2)
        if len(corners):  # a cube that is pressed onto the simplex
            left, share = 1.0, []
            for d in range(dim):
                share.append(left * t[d])
                w *= left ** (d < dim - 1) if d == 0 else left
                left -= share[-1]
            t = corners[0] * left + np.array(share) @ corners[1:]
        yield t, w


def stiffness(h):
    """Of the elements of a box with edges h: -div grad, or elasticity with lambda = lame and mu = 1."""
    degree = sum if cells == "simplex" else max if cells == "tensor" else lambda a: max(max(a), 1 + a.count(2))
    powers = [a for a in itertools.product(range(order + 1), repeat=dim) if degree(a) <= order]
    for places, n_corners in pieces():
        at = places / order
        # the functions of the nodes as sums of monomials
        function = np.linalg.inv(np.array([[np.prod(x ** np.array(a)) for a in powers] for x in at]))
        n = len(places)
        k = np.zeros((n, c, n, c))
        for t, w in quadrature(at[:n_corners]):
            slopes = np.array([[a[e] * t[e] ** max(a[e] - 1, 0) * np.prod([t[d] ** a[d] for d in range(dim) if d != e])
                                / h[e] for e in range(dim)] for a in powers])
            g, w = function.T @ slopes, w * np.prod(h)
            both = g @ g.T
            if c == 1:
                k[:, 0, :, 0] += w * both
                continue
            for i, j in itertools.product(range(c), repeat=2):
                k[:, i, :, j] += w * (lame * np.outer(g[:, i], g[:, j]) + np.outer(g[:, j], g[:, i]) + (i == j) * both)
        yield places, k.reshape(n * c, n * c)


# a rotation, of vectors too
turn = np.eye(dim)
for d in range(dim - 1):
    s, co = np.sin(0.3 + d), np.cos(0.3 + d)
    g = np.eye(dim)
    g[[d, d, d + 1, d + 1], [d, d + 1, d, d + 1]] = co, -s, s, co
    turn = g @ turn
normal = turn[:, -1]


class Block:
    def __init__(self, counts, low, first):
        self.counts, self.shape = counts, [order * n + 1 for n in counts]
        grid = np.array(list(itertools.product(*[range(m) for m in self.shape])))
        # serendipity elements have no nodes inside faces
        used = (grid % 2).sum(axis=1) <= 1 if cells == "serendipity" else np.ones(len(grid), bool)
        self.number, grid = np.cumsum(used) - 1, grid[used]
        self.flat = grid / (np.array(self.shape) - 1.0) + low * np.eye(dim)[-1]
        self.first, self.n, self.grid = first, len(grid) * c, grid
        self.places = scale * self.flat @ turn.T

    def node(self, place):
        return self.number[np.ravel_multi_index(tuple(place), self.shape)]

    def elements(self):
        """Cells with their elements: nodes and stiffness, components along the axes of space."""
        each = list(stiffness([1.0 / m for m in self.counts]))
        if c > 1:
            turned = [np.kron(np.eye(len(places)), turn) for places, _ in each]
            each = [(places, r @ k @ r.T) for r, (places, k) in zip(turned, each)]
        for cell in itertools.product(*[range(n) for n in self.counts]):
            for places, k in each:
                yield cell, [self.node(order * np.array(cell) + a) for a in places], k

    def dofs(self, nodes):
        return self.first + (c * np.asarray(nodes)[:, None] + np.arange(c)).ravel()

    def faces(self, level):
        """Cells of a side and its faces, with the normal out of the block."""
        row = order * self.counts[-1] if level else 0
        for cell in itertools.product(*[range(n) for n in self.counts[:-1]]):
            at = lambda *a: self.node(np.append(order * np.array(cell) + a, row))  # noqa: E731
            if dim == 2:
                ends = [at(0), at(order)]
                yield cell, (ends[::-1] if level else ends) + [at(1)] * (order == 2)
                continue
            around = [(0, 0), (1, 0), (1, 1), (0, 1)] if level else [(0, 0), (0, 1), (1, 1), (1, 0)]
            corners = [np.array(p) * order for p in around]
            for face in [corners[:3], corners[:1] + corners[2:]] if cells == "simplex" else [corners]:
                m = len(face)
                middles = [(face[k] + face[(k + 1) % m]) // 2 for k in range(m)]
                middles += [np.array([1, 1])] * (cells == "tensor")
                yield cell, [at(*p) for p in face + middles * (order == 2)]


lower = Block([3, 2, 2] if dim == 3 else [5, 3], 0.0, 0)
upper = Block([4, 3, 2] if dim == 3 else [7, 2], 1.01, lower.n)
blocks, n = [lower, upper], lower.n + upper.n
k_all, ff = np.zeros((n, n)), ctypes.c_void_p()
call("FetiFetiCreateFortran", comm.fortran, ctypes.byref(ff))
call("FetiFetiSetFromOptions", ff)
call("FetiFetiSetSizes", ff, -1, n)
call("FetiFetiSetBlockSize", ff, c)
for b, block in enumerate(blocks):
    parts = {0: [], 1: []}
    for cell, nodes, ke in block.elements():
        dofs = block.dofs(nodes)
        k_all[np.ix_(dofs, dofs)] += ke
        parts[2 * cell[0] // block.counts[0]].append((dofs, ke))
    for p, list_of in parts.items():
        if (2 * b + p) % comm.size != comm.rank:
            continue
        mine = np.unique(np.concatenate([dofs for dofs, _ in list_of]))
        k = np.zeros((len(mine), len(mine)))
        for dofs, ke in list_of:
            at = np.searchsorted(mine, dofs)
            k[np.ix_(at, at)] += ke
        ia = (len(mine) * np.arange(len(mine) + 1)).astype("i4")
        ja = np.tile(np.arange(len(mine)), len(mine)).astype("i4")
        call("FetiFetiAddSubdomain", ff, b, len(mine), ia, ja, k.ravel(), mine.astype("i4"))

# far sides held: the lower one at 0, the upper one pressed down
held_at = np.zeros(n)
far = [block.dofs(np.flatnonzero(block.grid[:, -1] == (0 if b == 0 else block.shape[-1] - 1)))
       for b, block in enumerate(blocks)]
held_at[far[1]] = np.tile(-0.03 * scale * normal if c > 1 else [-0.03], len(far[1]) // c)
if c == 1:
    held_at[far[0]] = 0.02
held = np.concatenate(far)
load = 0.0 if patch else 0.02 * scale
load = load * np.sin(1 + 1.7 * np.arange(n))


def rows_1d(own, other):
    """Dual mortar rows of first order on [0, 1]: M_pq / D_p and D_p for own and other elements of equal size."""
    m, d = np.zeros((own + 1, other + 1)), np.zeros(own + 1)
    cuts = np.unique(np.round(np.append(np.arange(own + 1) / own, np.arange(other + 1) / other), 13))
    points, weights = np.polynomial.legendre.leggauss(3)
    for a, b in zip(cuts, cuts[1:]):
        for x, w in zip((a + b) / 2 + (b - a) / 2 * points, (b - a) / 2 * weights):
            e, f = min(int(x * own), own - 1), min(int(x * other), other - 1)
            s, t = x * own - e, x * other - f
            psi = [2 * (1 - s) - s, 2 * s - (1 - s)]
            for i in range(2):
                d[e + i] += w * psi[i]
                m[e + i, f] += w * psi[i] * (1 - t)
                m[e + i, f + 1] += w * psi[i] * t
    return m / d[:, None], d


top = np.flatnonzero(lower.grid[:, -1] == lower.shape[-1] - 1)
bottom = np.flatnonzero(upper.grid[:, -1] == 0)
if order == 1 and cells == "tensor":
    each = [rows_1d(a, b) for a, b in zip(lower.counts[:-1], upper.counts[:-1])]
    weights, area = np.eye(1), np.ones(1)
    for m, d in each:
        weights, area = np.kron(weights, m), np.kron(area, d)
else:
    weights, area = np.zeros((len(top), len(bottom))), np.ones(len(top))
    for i, node in enumerate(top if cells == "tensor" else []):
        at = lower.flat[node][:-1] * upper.counts[:-1]
        cell = np.minimum(at.astype(int), np.array(upper.counts[:-1]) - 1)
        for a in itertools.product(range(order + 1), repeat=dim - 1):
            q = np.ravel_multi_index(tuple(order * cell + a), upper.shape[:-1])
            weights[i, q] += np.prod([line(t)[0][j] for t, j in zip(at - cell, a)])
area *= scale ** (dim - 1)
clear = 0.03 * scale * lower.flat[top][:, 0] ** 2 if kind and not patch else np.zeros(len(top))
gap = clear + 0.01 * scale * (c > 1 and kind)
directions = [normal] if kind and c > 1 else np.eye(c)
B, g = [], []
for i in range(len(top)):
    for e in directions:
        row = np.zeros(n)
        row[lower.dofs([top[i]])] += e
        row[upper.dofs(bottom)] -= np.outer(weights[i], e).ravel()
        B.append(row)
        g.append(gap[i])
B, g = np.array(B), np.array(g)

vec = lambda a: PETSc.Vec().createWithArray(a[slice(*layout)], comm=comm)  # noqa: E731
u = PETSc.Vec().createMPI(n, comm=comm)
layout = u.getOwnershipRange()
dofs = PETSc.IS().createGeneral(held.astype("i4") if comm.rank == 0 else [], comm=comm)
values, b = vec(held_at), vec(load)
call("FetiFetiSetDirichletBoundaries", ff, dofs, values)
if by == "rows":
    mine = range(comm.rank, len(B), comm.size)
    lists = [np.flatnonzero(B[r]) for r in mine]
    ia = np.concatenate([[0], np.cumsum([len(x) for x in lists])]).astype("i4")
    ja = np.concatenate(lists).astype("i4")
    call("FetiFetiSetContactRows", ff, len(mine), ia, ja, np.concatenate([B[r][x] for r, x in zip(mine, lists)]),
         g[mine], np.full(len(mine), kind, "i4"))
    terms = max(len(np.flatnonzero(row)) for row in B)
else:
    give = []
    for s, block in enumerate(blocks):
        owner = lambda cell: cell[0] % comm.size if spread else 0  # noqa: E731
        faces = [f for cell, f in block.faces(s == 0)
                 if owner(cell) == comm.rank or (spread and cell[-1] == 1 and comm.rank == 0)]
        nodes = np.unique(np.concatenate(faces)) if faces else np.zeros(0, int)
        start = np.cumsum([0] + [len(f) for f in faces]).astype("i4")
        flat = np.searchsorted(nodes, np.concatenate(faces)).astype("i4") if faces else np.zeros(0, "i4")
        number = np.zeros(1, "i4")
        call("FetiFetiAddSurface", ff, -1, dim, c, len(nodes), block.dofs(nodes).astype("i4") if len(nodes) else None,
             block.places[nodes].ravel(), len(faces), start, flat, number)
        give.append(nodes)
    mine = np.searchsorted(top, give[0])
    call("FetiFetiAddMortar", ff, 0, 1, kind, 0.0, 0.0, 0.0, clear[mine], None, number)
    terms = 0
call("FetiFetiSolve", ff, b, u)


def everywhere(v):
    """All entries of a vector on all ranks."""
    scatter, whole = PETSc.Scatter.toAll(v)
    scatter.scatter(v, whole)
    return whole.getArray().copy()


found = everywhere(u)
if by == "rows":
    lam = np.zeros(len(mine))
    call("FetiFetiGetMultipliers", ff, len(mine), lam)
    which = np.array(mine)
else:
    each = len(directions)
    lam, press = np.zeros(each * len(mine)), np.zeros(each * len(mine))
    open_by, state = np.zeros(len(mine)), np.zeros(len(mine), "i4")
    call("FetiFetiGetMortar", ff, 0, len(mine), lam, press, open_by, state)
    if patch:
        exact = 0.025 if c == 1 else 0.02 if kind else 0.03 * normal
        error = np.abs(press.reshape(-1, each) - exact).max(initial=0.0)
        print(f"node by node pressure within {error:.2e}" if error < 1e-10 else f"pressures {press}", flush=True)
        sys.exit(int(error >= 1e-10))
    if order == 1:
        assert np.allclose(press, lam / np.repeat(area[mine], each), rtol=1e-12, atol=1e-14), "pressures"
        if kind:
            assert np.allclose(open_by, (g - B @ found)[mine], atol=1e-12 * scale), "gaps"
            assert np.array_equal(state, (lam > 0).astype("i4")), "states"
    which = (each * mine[:, None] + np.arange(each)).ravel()
given = PETSc.Vec().createMPI(len(B), comm=comm)
given.setValues(which.astype("i4"), lam)
given.assemble()
here, lam = lam, everywhere(given)
assert np.array_equal(here, lam[which]), "ranks differ"

# the same set, by a dense solve
free = np.setdiff1d(np.arange(n), held)
holds = np.flatnonzero(lam > 0) if kind else np.arange(len(B))
A = np.block([[k_all[np.ix_(free, free)], B[np.ix_(holds, free)].T],
              [B[np.ix_(holds, free)], np.zeros((len(holds), len(holds)))]])
right = np.concatenate([load[free] - k_all[np.ix_(free, held)] @ held_at[held],
                        g[holds] - B[np.ix_(holds, held)] @ held_at[held]])
exact = held_at.copy()
solved = np.linalg.solve(A, right)
exact[free] = solved[:len(free)]
force = np.zeros(len(B))
force[holds] = solved[len(free):]
error = np.abs(found - exact).max() / np.abs(exact).max()
error_of_force = np.abs(lam - force).max() / np.abs(force).max()
over = ((B @ exact - g) if kind else np.zeros(1)).max() / np.abs(exact).max()
pull = -(force.min() if kind else 0.0) / np.abs(force).max()
reason = np.zeros(1, "i4")
call("FetiFetiGetConvergedReason", ff, reason)
call("FetiFetiDestroy", ctypes.byref(ff))
PETSc.Sys.Print(f"reason {reason[0]} terms {terms} rows {len(B)} touch {len(holds)} error {error:.2e} "
                f"force {error_of_force:.2e} over {over:.2e} pull {pull:.2e} sum {force.sum():.10e}")
