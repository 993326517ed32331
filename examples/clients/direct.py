"""The direct solution that the clients compare themselves with: dense, for some hundreds of unknowns.

None of this is needed to use fetifeti.
"""
import numpy as np


def contact(K, f, B, gap):
    """Minimises u'Ku/2 - f'u subject to B u <= gap; returns u and the multipliers. All matrices are arrays."""
    n, closed = len(f), np.ones(len(gap), bool)
    for _ in range(50):
        C = B[closed]
        full = np.block([[K, C.T], [C, np.zeros((len(C), len(C)))]])
        both = np.linalg.solve(full, np.concatenate([f, gap[closed]]))
        u, force = both[:n], np.zeros(len(gap))
        force[closed] = both[n:]
        now = np.where(closed, force >= 0, B @ u > gap)
        if np.array_equal(now, closed):
            return u, force
        closed = now
    raise RuntimeError("the sets of rows that hold do not come to rest in 50 steps")


def entries(vector):
    """A distributed vector of petsc4py as an array on every rank."""
    from petsc4py import PETSc

    scatter, whole = PETSc.Scatter.toAll(vector)
    scatter.scatter(vector, whole)
    return whole.getArray().copy()


def dense(matrix):
    """A distributed matrix of petsc4py, MATIS too, as an array on every rank: its products with unit vectors."""
    x, y = matrix.createVecs()
    columns = []
    for j in range(matrix.getSize()[1]):
        x.set(0)
        x.setValue(j, 1.0)
        x.assemble()
        matrix.mult(x, y)
        columns.append(entries(y))
    return np.array(columns).T
