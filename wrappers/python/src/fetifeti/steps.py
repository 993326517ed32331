"""The load steps of a scene in this process: fetifeti_step.h on petsc4py and NumPy arrays."""

from __future__ import annotations

import ctypes
import operator
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from petsc4py import PETSc

from .arrays import INT
from .calls import PETSC_INT, Error, call
from .scene import InputError, NotConvergedError, ProgramError, Scene

# FetiFetiStepRow.
_ROW: list[tuple[Any, ...]] = [
    ("body", INT, (2,)),
    ("node", INT, (2,)),
    ("x", "f8", (3,)),
    ("normal", "f8", (3,)),
    ("multiplier", "f8"),
    ("gap", "f8"),
    ("area", "f8"),
    ("friction", "f8", (3,)),
    ("slip", "f8", (3,)),
    ("inequality", INT),
    ("active", INT),
    ("state", INT),
]

# Errors as the program has them, by PETSc's code: PETSC_ERR_NOT_CONVERGED, PETSC_ERR_ARG_WRONG, PETSC_ERR_LIB.
_ERRORS: dict[int, Any] = {91: (NotConvergedError, 1), 62: (InputError, 2), 76: (ProgramError, 3)}


@contextmanager
def _as_the_program() -> Iterator[None]:
    """Raises what concerns the scene, a solve or the disk as `Scene.solve` does."""
    try:
        yield
    except Error as error:
        if error.ierr not in _ERRORS:
            raise
        kind, code = _ERRORS[error.ierr]
        raise kind(error.sentence, code) from error


class LoadStep:
    """A load step that was solved. Arrays are read when they are asked for, before the next step is solved.

    Attributes
    ----------
    number : int
        Its number, from 0.
    time : float
        Its time t; 1 for a scene without ``[steps]``.
    energy : float
        The potential energy of all bodies.
    reason : int
        PETSc's KSPConvergedReason, or the nearest one; negative if the step has not converged.
    reason_name : str
        The exact reason.
    iterations : int
        Krylov iterations, with contact those of all steps of the contact loop.
    """

    def __init__(self, steps: LoadSteps) -> None:
        self._steps = steps
        self.number = int(steps._get("GetNumber", PETSC_INT()))
        self.time = float(steps._get("GetTime", ctypes.c_double()))
        self.energy = float(steps._get("GetEnergy", ctypes.c_double()))
        self.iterations = int(steps._get("GetIterations", PETSC_INT()))
        reason, name = ctypes.c_int(), ctypes.c_char_p()
        call("FetiFetiStepGetConvergedReason", steps._handle, ctypes.byref(reason), ctypes.byref(name))
        self.reason, self.reason_name = reason.value, (name.value or b"").decode()

    @property
    def converged(self) -> bool:
        """Whether everything reached its tolerance."""
        return self.reason > 0

    def _present(self) -> Any:
        if not self._steps._handle:
            raise ValueError(f"load step {self.number} was given back with its steps")
        if self._steps._step is not self:
            raise ValueError(
                f"load step {self.number} is no longer the present one, expected its arrays to be read before the "
                "next step is solved"
            )
        return self._steps._handle

    def displacements(self, body: int | str) -> np.ndarray:
        """The displacements at the nodes of a body, a number or a name: (nodes, components), on all ranks. Collective.

        The nodes are those of `LoadSteps.points`. Given displacements are included.
        """
        handle, body = self._present(), self._steps._number(body)
        nodes, components = self._steps._size(body)
        u = np.empty((nodes, components))
        call("FetiFetiStepGetDisplacements", handle, body, u.size, u)
        return u

    @cached_property
    def contact(self) -> np.ndarray:
        """The rows between bodies of all ranks, on all ranks: a structured array. Collective.

        Fields: ``body`` and ``node``, two each, -1 where there is none, as beside an obstacle; the place ``x``; the
        ``normal`` out of the first body; ``multiplier`` (a force) and ``gap`` (a length) along it; ``area`` of the
        node, 0 if it has none; ``friction``, the force with which the first body drags the other side along, and
        ``slip``, how far it has slid on it in the load step; ``inequality``, False for ties; ``active``, True where
        the row holds; ``state``, a `RowState` as of `Solver`: open, holding, sticking or slipping.
        """
        n, at = PETSC_INT(), ctypes.c_void_p()
        call("FetiFetiStepGetContact", self._present(), ctypes.byref(n), ctypes.byref(at))
        raw = np.dtype(_ROW, align=True)
        found = np.zeros(0, raw)
        if n.value:
            found = np.frombuffer(ctypes.string_at(at, n.value * raw.itemsize), raw)
        flags = {"inequality": "?", "active": "?"}
        out = np.zeros(n.value, [(name, flags.get(name, kind), *shape) for name, kind, *shape in _ROW])
        for name in out.dtype.names or ():
            out[name] = found[name]
        return out

    def checkpoint(self, file: str | Path) -> None:
        """Writes where the steps stand to a file, from which ``scene.steps(resume=file)`` goes on. Collective.

        The next step is made ready for that: an error in it is raised here, and no step follows. Where none follows
        anyway, nothing is written. ``fetifeti solve --resume`` reads the file, too.
        """
        with _as_the_program():
            call("FetiFetiStepCheckpoint", self._present(), str(file))


class LoadSteps(Iterator[LoadStep]):
    """The load steps of a scene, each solved when it is asked for: ``for step in scene.steps():``. Collective.

    Memory belongs to the library. On one rank it is given back with this object; on several use
    ``with scene.steps() as steps:``, or call `destroy`, on all of them.

    Attributes
    ----------
    bodies : list of str
        The names of the bodies.
    """

    def __init__(
        self,
        scene: Scene,
        options: Mapping[str, Any] | None = None,
        comm: Any = None,
        *,
        resume: str | Path | None = None,
    ) -> None:
        self._handle = ctypes.c_void_p()
        # A scene that was put together lies in a directory of its own.
        self._scene = scene
        self._step: LoadStep | None = None
        comm = PETSc.COMM_WORLD if comm is None else comm
        self.comm: PETSc.Comm = comm if isinstance(comm, PETSc.Comm) else PETSc.Comm(comm)
        database = PETSc.Options()
        for key, value in (options or {}).items():
            database.setValue(key, value)
        with _as_the_program():
            call("FetiFetiStepCreateFortran", self.comm.fortran, str(scene.path), ctypes.byref(self._handle))
            self.bodies = [self._name(body) for body in range(self._get("GetBodies", PETSC_INT()))]
            if resume is not None:
                try:
                    call("FetiFetiStepResume", self._handle, str(resume))
                except Error:
                    self.destroy()
                    raise

    def __next__(self) -> LoadStep:
        solved = ctypes.c_int()
        try:
            with _as_the_program():
                call("FetiFetiStepNext", self._handle, ctypes.byref(solved))
        except NotConvergedError as error:
            self._step = error.step = LoadStep(self)
            raise
        if not solved.value:
            raise StopIteration
        self._step = LoadStep(self)
        return self._step

    def __enter__(self) -> LoadSteps:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.destroy()

    def __del__(self) -> None:
        if self._handle and not PETSc.Sys.isFinalized() and self.comm.size == 1:
            self.destroy()

    def destroy(self) -> None:
        """Gives everything back. May be called twice. Collective."""
        self._step = None
        if self._handle:
            call("FetiFetiStepDestroy", ctypes.byref(self._handle))

    def points(self, body: int | str) -> np.ndarray:
        """The coordinates of the nodes of a body, a number or a name, before it is deformed: (nodes, 3)."""
        body = self._number(body)
        x = np.empty((self._size(body)[0], 3))
        call("FetiFetiStepGetCoordinates", self._handle, body, x.size, x)
        return x

    def _get(self, what: str, place: Any) -> Any:
        """A number of the library."""
        call(f"FetiFetiStep{what}", self._handle, ctypes.byref(place))
        return place.value

    def _name(self, body: int) -> str:
        name = ctypes.c_char_p()
        call("FetiFetiStepGetBody", self._handle, body, ctypes.byref(name), None, None)
        return (name.value or b"").decode()

    def _size(self, body: int) -> tuple[int, int]:
        """The nodes of a body, and the components of each."""
        nodes, components = PETSC_INT(), PETSC_INT()
        call("FetiFetiStepGetBody", self._handle, body, None, ctypes.byref(nodes), ctypes.byref(components))
        return nodes.value, components.value

    def _number(self, body: int | str) -> int:
        if not isinstance(body, str):
            return operator.index(body)
        if body not in self.bodies:
            raise ValueError(f"there is no body '{body}', expected one of {', '.join(self.bodies)}")
        return self.bodies.index(body)
