"""The part of `fetifeti.Solver` for rows between bodies (contact, obstacles, equations) and the loop over them."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from petsc4py import PETSc

from .arrays import INT, csr, for_each, integers, reals
from .calls import DECIDE, ERR_USER, MONITOR, ContactStep, call


class RowKind(IntEnum):
    """How a row of contact holds."""

    EQUALITY = 0
    """(B u)_r = gap_r"""
    INEQUALITY = 1
    """(B u)_r <= gap_r, with a multiplier that is not negative"""


EQUALITY, INEQUALITY = RowKind.EQUALITY, RowKind.INEQUALITY


class RowState(IntEnum):
    """The state of a row of contact after a solve."""

    OPEN = 0
    """The sides are apart."""
    HOLDS = 1
    """The row holds: an equation, or contact without a force of friction."""
    STICK = 2
    """In contact, and the sides stick to each other."""
    SLIP = 3
    """The sides slide, with the largest force of friction that the law allows."""


class ContactFriction(NamedTuple):
    """Friction at the n rows and pairs of this rank, in the order of `Solver.multipliers`."""

    force: np.ndarray
    """(n, components) The force with which the first side, that of a row's first term, drags the other one along."""
    slip: np.ndarray
    """(n, components) How far the first side has slid on the other one since the beginning of the load step, a length,
    without the elastic part of a stick stiffness."""
    state: np.ndarray
    """(n,) Numbers of `RowState`."""


class Contact:
    """Rows of a solver."""

    comm: PETSc.Comm
    _ff: ctypes.c_void_p
    _rows: int
    _pairs: int
    _components: int
    _monitor: Any
    _raised: BaseException | None

    def set_contact_rows(self, rows: Any, gap: Any = 0.0, kind: Any = INEQUALITY) -> None:
        """Gives the rows (B u)_r <= gap_r or = gap_r of this rank, instead of those that it gave here before.

        Parameters
        ----------
        rows : scipy.sparse matrix, (row starts, columns, entries), or array_like; n rows
            B; its columns are numbers of unknowns. Each row is given by one rank, any one. With the normal from the
            first node to the second one at the first and minus the normal at the second, the multiplier is the force
            with which the second is pressed away.
        gap : float or array_like, shape (n,)
            Right-hand sides: distances.
        kind : RowKind, "equality" or "inequality", or n of these
        """
        ia, ja, b = csr(rows, "rows")
        n = len(ia) - 1
        kinds = np.array([_kind(k) for k in kind] if _several(kind) else n * [_kind(kind)], INT)
        kinds = integers(kinds, "kind", (n,))
        call("FetiFetiSetContactRows", self._ff, n, ia, ja, b, for_each(gap, n, "gap"), kinds)
        self._rows = n

    def set_contact_blocks(self, blocks: Mapping[int, Any], gap: Any = 0.0, kind: Any = INEQUALITY) -> None:
        """`set_contact_rows` with numbers of single matrices: nobody has to know the numbering of all unknowns.

        Parameters
        ----------
        blocks : dict of int to a matrix with n rows, as in `set_contact_rows`
            For matrices of `add_mat_is` (0 for the first one) or for that of `set_mat_is` (0) the part of the rows of
            this rank at their unknowns; columns are numbered as the entries of vectors of each matrix.
        gap, kind
            As in `set_contact_rows`.
        """
        parts = [(k, *csr(rows, f"the rows of matrix {k}")) for k, rows in blocks.items()]
        lengths = {len(ia) - 1 for _, ia, _, _ in parts} or {0}
        if len(lengths) > 1:
            raise ValueError(f"the blocks have {sorted(lengths)} rows, expected as many in each")
        n = lengths.pop()
        row = np.concatenate([np.repeat(np.arange(n), np.diff(ia)) for _, ia, _, _ in parts] or [np.zeros(0, int)])
        order = np.argsort(row, kind="stable")
        join = lambda lists, kind: np.concatenate([*lists, np.zeros(0, kind)])[order].astype(kind)  # noqa: E731
        matrix = join([np.full(len(ja), k, INT) for k, _, ja, _ in parts], INT)
        ja, b = join([p[2] for p in parts], INT), join([p[3] for p in parts], np.float64)
        ia = np.searchsorted(row[order], np.arange(n + 1)).astype(INT)
        kinds = np.array([_kind(k) for k in kind] if _several(kind) else n * [_kind(kind)], INT)
        kinds, gap = integers(kinds, "kind", (n,)), for_each(gap, n, "gap")
        call("FetiFetiSetContactRowsByMatrix", self._ff, n, ia, matrix, ja, b, gap, kinds)
        self._rows = n

    def set_contact_gaps(self, gap: Any) -> None:
        """Gives new right-hand sides of the rows and pairs of this rank, in the order of `multipliers`.

        Parameters
        ----------
        gap : float or array_like, shape (rows and pairs of this rank,)
        """
        gap = for_each(gap, self._rows + self._pairs, "gap")
        call("FetiFetiSetContactGaps", self._ff, len(gap), gap)

    def add_contact_pairs(
        self, first: Any, second: Any, gap: Any = None, kind: Any = INEQUALITY, *, matrices: Any = (None, None)
    ) -> None:
        """Adds rows u_first - u_second <= gap, or = gap, for unknowns that face each other. Collective.

        Parameters
        ----------
        first, second : PETSc.IS or array_like of int, shape (n,)
            Unknowns, entry by entry; of any rank.
        gap : float or array_like, shape (n,), optional
            Right-hand sides; left out: zero.
        kind : RowKind, "equality" or "inequality"
        matrices : (int or None, int or None)
            The matrices whose unknowns `first` and `second` list: 0 for the first one of `add_mat_is`. None: numbers
            among the unknowns of all bodies.
        """
        first, second = self._set(first, "first"), self._set(second, "second")
        if first is None or second is None:
            raise TypeError("first or second is None, expected unknowns; clear_contact_pairs forgets the pairs")
        n = first.getLocalSize()
        gap = None if gap is None else for_each(gap, n, "gap")
        a, b = (_number(k) for k in matrices)
        call("FetiFetiSetContactPairs", self._ff, a, first, b, second, gap, _kind(kind))
        self._pairs += n

    def clear_contact_pairs(self) -> None:
        """Forgets all pairs of `add_contact_pairs`. Collective."""
        call("FetiFetiSetContactPairs", self._ff, DECIDE, None, DECIDE, None, None, EQUALITY)
        self._pairs = 0

    def set_contact_law(
        self,
        friction: Any = None,
        limit: Any = None,
        tresca: Any = None,
        stiffness: Any = None,
        stick_stiffness: Any = None,
    ) -> None:
        """Gives friction, and stiffnesses of soft contact, to the rows and pairs that this rank has given so far.

        Each is a number or an array_like of shape (n,), in the order of `multipliers`; it takes the place of the law of
        before. Laws belong to inequalities; rows that are given later have none. Friction needs nodes of 2 or 3
        consecutive unknowns, the block size, and rows whose coefficients at a node give the normal.

        Parameters
        ----------
        friction : float or array_like, optional
            Coulomb's coefficient, 0 without friction.
        limit : float or array_like, optional
            The largest force of friction beside `friction`; numpy.inf where there is no limit.
        tresca : float or array_like, optional
            A given bound of the force in place of Coulomb's, whether or not the row touches; 0 without friction.
        stiffness : float or array_like, optional
            The multiplier over the overclosure of soft contact, a force per length; numpy.inf where contact is hard.
        stick_stiffness : float or array_like, optional
            The force of friction over the slip while the sides stick; numpy.inf where slip is never elastic.
        """
        n = self._rows + self._pairs
        names = ("friction", "limit", "tresca", "stiffness", "stick_stiffness")
        given = (friction, limit, tresca, stiffness, stick_stiffness)
        laws = [None if v is None else for_each(v, n, name) for name, v in zip(names, given)]
        call("FetiFetiSetContactLaw", self._ff, n, *laws)

    def set_contact_slip(self, slip: Any = None) -> None:
        """Says where the sides of rows with friction stand without a slip, in place of `next_contact_step`, which adds
        the slips of the last solve to where they stood.

        Parameters
        ----------
        slip : array_like, shape (n, components), optional
            For each row and pair of this rank the displacement of the first side from the other one that counts as
            none: slips so far, and the way of an obstacle that drags; left out: zero.
        """
        n, dim = self._rows + self._pairs, self._components
        slip = None if slip is None else reals(slip, "slip", (n, dim))
        call("FetiFetiSetContactSlip", self._ff, n, dim, slip)

    def next_contact_step(self) -> None:
        """Begins a load step: slips count from where the last solve has ended. On all ranks."""
        call("FetiFetiNextContactStep", self._ff)

    @property
    def contact_friction(self) -> ContactFriction:
        """Forces of friction, slips and states of the rows and pairs of this rank."""
        n, dim = self._rows + self._pairs, self._components
        out = ContactFriction(np.zeros((n, dim)), np.zeros((n, dim)), np.zeros(n, INT))
        call("FetiFetiGetContactFriction", self._ff, n, dim, *out)
        return out

    def on_step(self, callback: Callable[[ContactStep], Any] | None) -> None:
        """Sets a function that is called after each step of the contact loop, on all ranks; None: none.

        It gets the number of the ``step`` from 0, the rows that held (``active``), that ``entered`` and that ``left``,
        those on the ``wrong`` side, ``iterations``, ``residual`` and ``tolerance``. What it raises ends `solve`, which
        raises it; it must not call this solver.
        """

        def monitor(step: Any, _: Any) -> int:
            assert callback is not None
            try:
                callback(ContactStep.from_buffer_copy(step.contents))
            except BaseException as error:
                self._raised = error
                return ERR_USER
            return 0

        function = MONITOR(0) if callback is None else MONITOR(monitor)
        call("FetiFetiContactMonitorSet", self._ff, ctypes.cast(function, ctypes.c_void_p), None)
        # The library calls it as long as it is not replaced.
        self._monitor = function

    def _set(self, numbers: Any, what: str) -> PETSc.IS | None:
        """An index set of numbers that may be one already."""
        if numbers is None or isinstance(numbers, PETSc.IS):
            return numbers
        return PETSc.IS().createGeneral(integers(numbers, what), comm=self.comm)


def _number(n: int | None) -> int:
    """A number for C, PETSC_DECIDE for None."""
    return DECIDE if n is None else int(integers(n, "a number", ()))


def _several(kind: Any) -> bool:
    return not isinstance(kind, str) and np.ndim(kind) > 0


def _kind(kind: Any) -> RowKind:
    try:
        return RowKind[kind.upper()] if isinstance(kind, str) else RowKind(kind)
    except (KeyError, ValueError):
        raise ValueError(f"a row is of kind {kind!r}, expected 'equality' or 'inequality'") from None
