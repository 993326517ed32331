"""A Laplacian on a line of elements, one stretch per rank, as a MATIS: the solver is chosen by the options."""
import sys
import petsc4py

petsc4py.init(sys.argv)
from petsc4py import PETSc  # noqa: E402

comm = PETSc.COMM_WORLD
rank, size, n = comm.rank, comm.size, 40
first, last = n * rank // size, n * (rank + 1) // size
lgmap = PETSc.LGMap().create(list(range(first, last + 1)), comm=comm)
A = PETSc.Mat().createIS(((None, n + 1), (None, n + 1)), lgmapr=lgmap, lgmapc=lgmap, comm=comm)
local = PETSc.Mat().createAIJ([last - first + 1] * 2, nnz=3, comm=PETSc.COMM_SELF)
for i in range(last - first):
    local.setValues([i, i + 1], [i, i + 1], [1.0, -1.0, -1.0, 1.0], addv=True)
local.assemble()
A.setISLocalMat(local)
A.assemble()
A.zeroRowsColumns([0] if rank == 0 else [], diag=1.0)
x, b = A.createVecs()
b.set(1.0)
ksp = PETSc.KSP().create(comm)
ksp.setOperators(A)
ksp.setFromOptions()
ksp.solve(b, x)
residual = (b - A * x).norm()
PETSc.Sys.Print(f"type {ksp.getType()} reason {ksp.reason} residual {residual:.2e}")
