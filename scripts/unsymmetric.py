#!/usr/bin/env python3
"""Convection and diffusion on a square, an operator that is not symmetric: docs/which_solver.md.

    mpirun -n RANKS scripts/unsymmetric.py PECLET [PETSc options]

−Δu + b·∇u = 1, u = 0 on the boundary; |b| = PECLET, rectangles with bilinear shape functions, a square of them on every
rank. The operator is a MATIS; the second matrix of the KSP is its symmetric part, for solvers that need one.
"""
import sys

import petsc4py

petsc4py.init(sys.argv)
import numpy as np
from petsc4py import PETSc

CELLS = 32  # along a side of a rank's square


def cell(h, b):
    """The matrices of a square cell: stiffness, and convection by b; nodes (0, 0), (1, 0), (0, 1), (1, 1)."""
    mass = h / 6 * np.array([[2.0, 1.0], [1.0, 2.0]])
    stiff = 1 / h * np.array([[1.0, -1.0], [-1.0, 1.0]])
    slope = 0.5 * np.array([[-1.0, 1.0], [-1.0, 1.0]])
    return np.kron(mass, stiff) + np.kron(stiff, mass), b[0] * np.kron(mass, slope) + b[1] * np.kron(slope, mass)


def main():
    comm = PETSc.COMM_WORLD
    side = round(comm.size**0.5)
    if side * side != comm.size:
        sys.exit(f"{comm.size} ranks, expected a square number")
    n = side * CELLS
    x0, y0 = CELLS * (comm.rank % side), CELLS * (comm.rank // side)
    local = CELLS + 1
    grid = np.add.outer((y0 + np.arange(local)) * (n + 1), x0 + np.arange(local)).ravel().astype(PETSc.IntType)
    peclet = float(sys.argv[1])
    stiff, slope = cell(1 / n, peclet * np.array([0.8, 0.6]))
    maps = PETSc.LGMap().create(grid, comm=comm)
    matrices = []
    for entries in (stiff + slope, stiff):
        a = PETSc.Mat().create(comm)
        a.setSizes((n + 1) ** 2)
        a.setType("is")
        a.setLGMap(maps)
        a.setUp()
        a.getISLocalMat().setPreallocationNNZ(9)
        for j in range(CELLS):
            for i in range(CELLS):
                first = j * local + i
                nodes = np.array([first, first + 1, first + local, first + local + 1], dtype=PETSc.IntType)
                a.setValuesLocal(nodes, nodes, entries, PETSc.InsertMode.ADD_VALUES)
        a.assemble()
        matrices.append(a)
    a, p = matrices
    x, b = a.createVecs()
    b.set(1 / n**2)
    first, last = b.getOwnershipRange()
    mine = np.arange(first, last)
    on = [k for k in mine if min(k % (n + 1), k // (n + 1)) == 0 or max(k % (n + 1), k // (n + 1)) == n]
    for matrix in (a, p):
        matrix.zeroRowsColumns(np.array(on, dtype=PETSc.IntType), 1.0, x, b)
    ksp = PETSc.KSP().create(comm)
    ksp.setOperators(a, p if PETSc.Options().getBool("symmetric_part", False) else a)
    ksp.setTolerances(rtol=1e-8)
    ksp.setFromOptions()
    ksp.solve(b, x)
    r = b.copy()
    a.mult(x, r)
    r.aypx(-1, b)
    reason = ksp.getConvergedReason()
    left = r.norm() / b.norm()
    PETSc.Sys.Print(f"{ksp.getIterationNumber()} iterations, reason {reason}, ‖b − Ax‖ / ‖b‖ = {left:.1e}")


main()
