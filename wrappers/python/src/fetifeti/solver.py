"""`Solver`: the C API of fetifeti.h on petsc4py objects and NumPy arrays."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Any, NamedTuple, Union

import numpy as np
from petsc4py import PETSc

from .arrays import INT, csr, integers, reals
from .calls import ContactStep, Error, call, ksp_at
from .contact import Contact, RowKind, _number
from .surfaces import Surfaces

Vector = Union[PETSc.Vec, np.ndarray, Sequence[PETSc.Vec]]
"""A vector of PETSc, this rank's entries of one, or the parts of a nested one."""


class Kkt(NamedTuple):
    """How well a solution satisfies the optimality conditions; numbers without units, 0 where they hold exactly."""

    stationarity: float
    """|K u - f + B'l| / (|f| + |B'l|)"""
    feasibility: float
    """The largest violation of a row over the largest |u|."""
    complementarity: float
    """The largest |l_r (B u - c)_r| over max |l| max |u|."""
    sign: float
    """The smallest multiplier of an inequality over max |l|."""


class MortarResult(NamedTuple):
    """What a mortar found at the n nodes that this rank gave of its first surface, in the order of `add_surface`."""

    multiplier: np.ndarray
    """Forces of the first surface on the second one: in contact (n,) along the normal, in ties (n, components). In the
    plane a force per unit of thickness. 0 at nodes without a multiplier."""
    pressure: np.ndarray
    """The multiplier over the area of the node's function: force per area. The shape is that of `multiplier`."""
    gap: np.ndarray
    """What remains of the gap, a length, (n,); infinite at nodes without a multiplier."""
    state: np.ndarray
    """(n,) Numbers of `RowState`, -1 at nodes without a multiplier."""


class MortarFriction(NamedTuple):
    """Friction of a mortar at the n nodes that this rank gave of its first surface, zero at nodes without it."""

    force: np.ndarray
    """(n, components) The force with which the first surface drags the second one along."""
    shear: np.ndarray
    """(n, components) The force over the area of the node's function, a shear stress."""
    slip: np.ndarray
    """(n, components) How far the first surface has slid on the second one since the beginning of the load step, a
    length, without the elastic part of a stick stiffness."""


class Solver(Contact, Surfaces):
    """A solver for bodies that are tied or in contact: min 1/2 u'Ku - f'u subject to B u = c, B u <= c.

    The unknowns of all bodies have one numbering, that of the entries of the load. Units are the caller's: matrices in
    force per length, loads and multipliers in forces, gaps and solutions in lengths. Every method says if all ranks
    have to call it ("Collective").

    Parameters
    ----------
    comm : PETSc.Comm or mpi4py.MPI.Comm, optional
        The communicator; PETSc's world if it is left out.
    prefix : str, optional
        In front of all options: -PREFIXfetifeti_...
    options : dict, optional
        Options without prefix and ``fetifeti_``, for example ``{"ksp_rtol": 1e-10}``. They are put into PETSc's
        database, where other solvers with the same prefix find them, too.

    Raises
    ------
    NotFoundError
        The library is nowhere.
    Error
        What the library or PETSc say, one sentence. So do all methods. No method ends the process.

    Notes
    -----
    Memory belongs to the library: use ``with Solver(comm) as solver:``, or call `destroy`, on all ranks.
    """

    def __init__(self, comm: Any = None, *, prefix: str = "", options: Mapping[str, Any] | None = None) -> None:
        self._ff = ctypes.c_void_p()
        self._monitor: Any = None
        self._raised: BaseException | None = None
        if comm is None:
            comm = PETSc.COMM_WORLD
        self.comm: PETSc.Comm = comm if isinstance(comm, PETSc.Comm) else PETSc.Comm(comm)
        self._forget()
        call("FetiFetiCreateFortran", self.comm.fortran, ctypes.byref(self._ff))
        if prefix:
            call("FetiFetiSetOptionsPrefix", self._ff, prefix)
        database = PETSc.Options(f"{prefix}fetifeti_")
        for key, value in (options or {}).items():
            database.setValue(key, value)
        call("FetiFetiSetFromOptions", self._ff)

    def _forget(self) -> None:
        self._rows = self._pairs = 0
        self._block_size: int | None = None
        self._of_matrices = 0
        self._surfaces: list[tuple[int, int]] = []
        self._mortars: list[tuple[int, RowKind]] = []

    # Life

    def __enter__(self) -> Solver:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.destroy()

    def destroy(self) -> None:
        """Gives everything back. May be called twice. Collective."""
        if self._ff:
            call("FetiFetiDestroy", ctypes.byref(self._ff))

    def reset(self) -> None:
        """Forgets matrices, rows and everything else but the prefix and the options. Collective."""
        call("FetiFetiReset", self._ff)
        self._forget()

    def set_from_options(self) -> None:
        """Reads the options of the object again, after changes of PETSc's database. Collective."""
        call("FetiFetiSetFromOptions", self._ff)

    def set_options_prefix(self, prefix: str) -> None:
        """Sets the prefix of all options, without a hyphen."""
        call("FetiFetiSetOptionsPrefix", self._ff, prefix)

    def view(self, viewer: PETSc.Viewer | None = None) -> None:
        """Shows bodies, multipliers and the last solve, on standard output or an ASCII viewer. Collective."""
        call("FetiFetiView", self._ff, viewer)

    # Matrices and bodies

    def set_sizes(self, n: int | None, total: int | None) -> None:
        """Sets the numbers of unknowns, where no matrix says them: on this rank, and on all; None: from the other."""
        call("FetiFetiSetSizes", self._ff, _number(n), _number(total))

    def set_block_size(self, components: int) -> None:
        """Sets how many consecutive unknowns belong to a node: 2 in the plane, 3 in space, 1 for scalars."""
        call("FetiFetiSetBlockSize", self._ff, components)
        self._block_size = components

    @property
    def _components(self) -> int:
        """Unknowns of a node: as said, else the largest number that fits all matrices."""
        return self._block_size or self._of_matrices or 1

    def add_subdomain(self, matrix: Any, dofs: Any, body: int | None = None) -> None:
        """Adds the stiffness matrix of one subdomain, as often as a rank likes.

        Parameters
        ----------
        matrix : scipy.sparse matrix, (row starts, columns, entries), or array_like; shape (n, n)
            Symmetric; of the elements of the subdomain alone. The sum over all subdomains is the assembled matrix.
        dofs : array_like of int, shape (n,)
            The number of the unknown of each row; a negative one is left out.
        body : int, optional
            The body that it belongs to; left out in all calls, a graph partition finds the bodies.
        """
        ia, ja, a = csr(matrix, "matrix")
        dofs = integers(dofs, "dofs", (len(ia) - 1,))
        call("FetiFetiAddSubdomain", self._ff, _number(body), len(dofs), ia, ja, a, dofs)

    def set_mat_is(self, matrix: PETSc.Mat, body: int | None = None) -> None:
        """Takes the subdomains from a matrix of type "is", one on each rank, instead of those given before. Collective.

        Parameters
        ----------
        matrix : PETSc.Mat
            Its layout, block size and near-null space are taken over. Entries are copied.
        body : int, optional
            The body of this rank's subdomain, or left out on all ranks.
        """
        call("FetiFetiSetMatIS", self._ff, matrix, _number(body))
        self._of_matrices = matrix.getBlockSize()

    def add_mat_is(self, matrix: PETSc.Mat, body: int | None = None, *, numbers: Any = None) -> None:
        """Adds the matrix of a body of several that were discretised by themselves, of type "is". Collective.

        Parameters
        ----------
        matrix : PETSc.Mat
            Motions that cost no energy are those of ``setNearNullSpace``, else of ``setNullSpace``.
        body : int, optional
            The body, or left out for all matrices.
        numbers : PETSc.IS or array_like of int, shape (rows of this rank,), optional
            The number of each row among the unknowns of all bodies. Left out, matrices are numbered one after the
            other, and loads and solutions are nested vectors, or have on each rank the rows of the first matrix, of the
            second, and so on.
        """
        call("FetiFetiAddMatIS", self._ff, matrix, self._set(numbers, "numbers"), _number(body))
        self._of_matrices = math.gcd(self._of_matrices, matrix.getBlockSize())

    def update_matrices(self, matrices: Sequence[PETSc.Mat | None]) -> None:
        """Takes new entries of the matrices that were added, for Newton's method and load steps. Collective.

        The next `setup` or `solve` keeps bodies, constraints and the analyses of patterns; where the new entries do not
        fit them, everything is set up anew. Rows and their multipliers stay.

        Parameters
        ----------
        matrices : list of PETSc.Mat or None
            As many as were added, in their order, with the same maps; None for one that stays.
        """
        handles = np.array([0 if a is None else a.handle for a in matrices], np.uintp)
        call("FetiFetiUpdateMatrices", self._ff, len(handles), handles)

    def update_subdomain(self, number: int, matrix: Any) -> None:
        """Takes new entries of a subdomain of `add_subdomain`: the `number`-th of this rank, from 0."""
        ia, ja, a = csr(matrix, "matrix")
        call("FetiFetiUpdateSubdomain", self._ff, number, len(ia) - 1, ia, ja, a)

    def set_near_null_space(self, space: PETSc.NullSpace | None) -> None:
        """Gives vectors that span every kernel that a subdomain without boundary conditions may have. Collective."""
        call("FetiFetiSetNearNullSpace", self._ff, space)

    def set_coordinates(self, coordinates: Any) -> None:
        """Gives the places of the nodes whose unknowns are on this rank, for rigid body motions; shape (n, 1 to 3)."""
        coordinates = reals(coordinates, "coordinates", (None, None))
        n, dim = coordinates.shape
        call("FetiFetiSetCoordinates", self._ff, dim, n, coordinates)

    # Conditions

    def set_dirichlet(self, dofs: Any, values: PETSc.Vec | None = None) -> None:
        """Holds unknowns at given values. Collective.

        Parameters
        ----------
        dofs : PETSc.IS, array_like of int, shape (any,), or None
            Unknowns, listed by any rank, also by several; None: none.
        values : PETSc.Vec, optional
            A vector like the solution that has their values, read at each solve; left out: zero.
        """
        call("FetiFetiSetDirichletBoundaries", self._ff, self._set(dofs, "dofs"), values)

    def set_neumann(self, dofs: Any) -> None:
        """Has no effect; for programs that called PCBDDCSetNeumannBoundaries. Collective."""
        call("FetiFetiSetNeumannBoundaries", self._ff, self._set(dofs, "dofs"))

    def set_primal_dofs(self, dofs: Any) -> None:
        """Makes unknowns primal where subdomains of one body share them; None: those that the solver chooses alone.
        Collective."""
        call("FetiFetiSetPrimalDofs", self._ff, self._set(dofs, "dofs"))

    # Solving and results

    def setup(self) -> None:
        """Finds bodies, interfaces and constraints, and factors; `solve` does it if it was not done. Collective."""
        call("FetiFetiSetUp", self._ff)

    def solve(self, load: Vector, solution: PETSc.Vec | None = None) -> Any:
        """Solves. Collective.

        Parameters
        ----------
        load : PETSc.Vec, array_like of shape (unknowns of this rank,), or a list of PETSc.Vec, one for each matrix
            Forces, assembled over all subdomains.
        solution : PETSc.Vec, optional
            Where the solution goes, if the load is a vector of PETSc; its entries on input are ignored.

        Returns
        -------
        PETSc.Vec or numpy.ndarray
            The solution: a vector like the load, nested for a list, an array for an array.

        Notes
        -----
        A solve after another one with inequalities starts from its multipliers. An iteration that stops early is no
        error: see `converged`.
        """
        plain = not isinstance(load, PETSc.Vec)
        if isinstance(load, (list, tuple)) and load and all(isinstance(part, PETSc.Vec) for part in load):
            load, plain = PETSc.Vec().createNest(list(load), comm=self.comm), False
        if plain:
            if solution is not None:
                raise TypeError("the load is an array and the solution is given, expected vectors of PETSc for both")
            load = PETSc.Vec().createWithArray(reals(load, "load"), comm=self.comm)
        assert isinstance(load, PETSc.Vec)
        if solution is None:
            solution = load.duplicate()
        self._raised = None
        try:
            call("FetiFetiSolve", self._ff, load, solution)
        except Error:
            # What a callback has raised says more than that it has.
            if self._raised is not None:
                raise self._raised from None
            raise
        return solution.getArray().copy() if plain else solution

    @property
    def iterations(self) -> int:
        """Krylov iterations of the last solve, over all steps of the contact loop."""
        return self._int("FetiFetiGetIterations")

    @property
    def contact_steps(self) -> int:
        """Steps of the contact loop in the last solve; 0 without inequalities."""
        return self._int("FetiFetiGetContactSteps")

    @property
    def reason(self) -> int:
        """Why the last solve ended, a number of PETSc.KSP.ConvergedReason; positive where everything converged."""
        return self._int("FetiFetiGetConvergedReason")

    @property
    def converged(self) -> bool:
        """Whether everything reached its tolerance in the last solve, or rounding where that is larger."""
        return self.reason > 0

    @property
    def spectrum(self) -> tuple[float, float]:
        """The extreme eigenvalues of the preconditioned operator as the last iteration saw them."""
        ends = np.zeros(2)
        call("FetiFetiGetSpectrum", self._ff, ends[:1], ends[1:])
        return float(ends[0]), float(ends[1])

    @property
    def kkt(self) -> Kkt:
        """How well the last solution satisfies the optimality conditions."""
        numbers = np.zeros(4)
        call("FetiFetiGetKKT", self._ff, numbers)
        return Kkt(*numbers.tolist())

    @property
    def multipliers(self) -> np.ndarray:
        """The multipliers of the rows and pairs that this rank gave, in that order: K u + B' multipliers = f; forces.

        Those of mortars are in `mortar`."""
        out = np.zeros(self._rows + self._pairs)
        call("FetiFetiGetMultipliers", self._ff, len(out), out)
        return out

    @property
    def inner_ksp(self) -> PETSc.KSP:
        """The KSP that iterates on the multipliers, after `setup`; a new set-up makes a new one."""
        place = ctypes.c_void_p()
        call("FetiFetiGetInnerKSP", self._ff, ctypes.byref(place))
        return ksp_at(place)

    def _int(self, name: str) -> int:
        place = np.zeros(1, INT)
        call(name, self._ff, place)
        return int(place[0])


__all__ = ["ContactStep", "Error", "Kkt", "MortarResult", "RowKind", "Solver"]
