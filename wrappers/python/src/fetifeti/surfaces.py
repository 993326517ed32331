"""The part of `fetifeti.Solver` for surfaces whose meshes need not match: mortar rows."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy as np

from .arrays import INT, for_each, integers, reals
from .calls import call

if TYPE_CHECKING:
    from .contact import RowKind
    from .solver import MortarFriction, MortarResult


class Surfaces:
    """Surfaces, mortars and their results."""

    _ff: ctypes.c_void_p
    _surfaces: list[tuple[int, int]]
    _mortars: list[tuple[int, RowKind]]

    def add_surface(self, coordinates: Any, dofs: Any, faces: Any, *, matrix: int | None = None) -> int:
        """Gives a surface of a body by nodes and faces; each rank gives what it has, or nothing. Collective.

        Parameters
        ----------
        coordinates : array_like of float, shape (n, 2) or (n, 3)
            Places of the nodes that this rank gives; nodes in no face do not count.
        dofs : array_like of int, shape (n, components)
            The unknowns of each node: 2 or 3 displacements, or (n,) for scalars. A negative one is held at zero.
        faces : array_like of int, shape (m, k), or a list of arrays of different lengths
            The nodes of each face as places in `coordinates`: 2 or 3 in the plane (both ends, the middle), in space 3,
            6, 4, 8 or 9 (corners around, middles of the edges, centre). In space corners go around anticlockwise for
            whoever looks at the body from outside, in the plane the body lies to the left.
        matrix : int, optional
            The matrix whose unknowns `dofs` lists: 0 for the first one of `add_mat_is`. Left out: numbers among the
            unknowns of all bodies.

        Returns
        -------
        int
            The number of the surface.
        """
        from .solver import _number

        coordinates = reals(coordinates, "coordinates", (None, None))
        n, dim = coordinates.shape
        if np.ndim(dofs) == 1:
            dofs = np.reshape(dofs, (-1, 1))
        dofs = integers(dofs, "dofs", (n, None))
        faces = [integers(face, f"face {k}") for k, face in enumerate(faces)]
        start = np.concatenate([[0], np.cumsum([len(face) for face in faces])]).astype(INT)
        nodes = np.concatenate([np.zeros(0, INT), *faces])
        bad = nodes[(nodes < 0) | (nodes >= n)]
        if bad.size:
            raise ValueError(f"a face has node {bad[0]}, expected places in the list of {n} nodes, from 0")
        place, components = np.zeros(1, INT), dofs.shape[1]
        call(
            "FetiFetiAddSurface", self._ff, _number(matrix), dim, components, n, dofs, coordinates,
            len(faces), start, nodes, place,
        )  # fmt: skip
        self._surfaces.append((n, components))
        return int(place[0])

    def add_mortar(
        self,
        first: int,
        second: int,
        kind: Any = "inequality",
        *,
        reach: float = 0.0,
        adjust: float = 0.0,
        gap: float = 0.0,
        gaps: Any = None,
        without: Any = None,
    ) -> int:
        """Ties two surfaces, or puts them in contact, by mortar rows; `set_mortar_law` gives friction. Collective.

        Parameters
        ----------
        first, second : int
            Surfaces; the first one carries the multipliers, by preference the finer or softer one.
        kind : RowKind, "equality" (a tie) or "inequality" (contact)
        reach : float
            How far along the normals of the first one the second may be, a length; 0: a few edges.
        adjust : float
            Initial distances and overlaps up to this length count as none.
        gap : float
            A clearance in addition to the distance of the places, a length; negative for an interference.
        gaps : float or array_like, shape (n,), optional
            More of it at each node that this rank gave of the first surface.
        without : array_like of bool, shape (n,), optional
            Nodes that are to carry no multiplier; left out: found alone.

        Returns
        -------
        int
            The number of the mortar, for `mortar`.
        """
        from .contact import _kind

        kind = _kind(kind)
        n = self._surfaces[first][0] if 0 <= first < len(self._surfaces) else 0
        gaps = None if gaps is None else for_each(gaps, n, "gaps")
        without = None if without is None else integers(np.asarray(without).astype(INT), "without", (n,))
        place = np.zeros(1, INT)
        call("FetiFetiAddMortar", self._ff, first, second, kind, reach, adjust, gap, gaps, without, place)
        self._mortars.append((first, kind))
        return int(place[0])

    def set_mortar_law(
        self,
        number: int = 0,
        friction: float = 0.0,
        limit: float = np.inf,
        tresca: float = 0.0,
        stiffness: float = np.inf,
        stick_stiffness: float = np.inf,
    ) -> None:
        """Gives friction, and stiffnesses of soft contact, to a mortar in contact. Collective.

        Parameters
        ----------
        number : int
            The mortar.
        friction : float
            Coulomb's coefficient.
        limit : float
            The largest shear stress beside `friction`.
        tresca : float
            A given bound of the shear stress in place of Coulomb's, whether or not the sides touch.
        stiffness : float
            The pressure over the overclosure of soft contact.
        stick_stiffness : float
            The shear stress over the slip while the sides stick.
        """
        call("FetiFetiSetMortarLaw", self._ff, number, friction, limit, tresca, stiffness, stick_stiffness)

    def set_mortar_slip(self, slip: Any = None, number: int = 0) -> None:
        """Says where the sides of a mortar with friction stand without a slip, in place of `next_contact_step`.
        Collective.

        Parameters
        ----------
        slip : array_like, shape (n, components), optional
            For each node that this rank gave of the first surface the displacement of this surface from the other one
            that counts as none: slips so far, and the way of a surface that drags; left out: this rank says nothing.
        number : int
            The mortar.
        """
        shape = self._surfaces[self._first(number)[0]]
        slip = None if slip is None else reals(slip, "slip", shape)
        call("FetiFetiSetMortarSlip", self._ff, number, shape[0], slip)

    def mortar_friction(self, number: int = 0) -> MortarFriction:
        """Friction of a mortar at the nodes that this rank gave of its first surface; `mortar` has their states."""
        from .solver import MortarFriction

        shape = self._surfaces[self._first(number)[0]]
        out = MortarFriction(np.zeros(shape), np.zeros(shape), np.zeros(shape))
        call("FetiFetiGetMortarFriction", self._ff, number, shape[0], *out)
        return out

    def _first(self, number: int) -> tuple[int, RowKind]:
        """The first surface of a mortar, and its kind."""
        if not 0 <= number < len(self._mortars):
            raise ValueError(f"there is no mortar {number}, expected one of {len(self._mortars)} (from 0)")
        return self._mortars[number]

    def mortar(self, number: int = 0) -> MortarResult:
        """The result of a mortar at the nodes that this rank gave of its first surface."""
        from .contact import INEQUALITY
        from .solver import MortarResult

        first, kind = self._first(number)
        n, components = self._surfaces[first]
        shape = (n,) if kind == INEQUALITY else (n, components)
        out = MortarResult(np.zeros(shape), np.zeros(shape), np.zeros(n), np.zeros(n, INT))
        call("FetiFetiGetMortar", self._ff, number, n, *out)
        return out

    def reset_mortar(self) -> None:
        """Forgets surfaces and mortars, for surfaces with new places; everything else stays. Collective."""
        call("FetiFetiResetMortar", self._ff)
        self._surfaces, self._mortars = [], []
