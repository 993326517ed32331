"""FETI-FETI for bodies in contact: FETI-DP inside bodies, one-level FETI between them, contact by active sets.

Two ways in, which need different things:

- `Solver` and `register` work inside a program on petsc4py, with its matrices and vectors. They load
  ``libfetifeti.so``. `Scene.steps` solves the load steps of a scene there, and loads ``libfetifeti_step.so``.
- `solve` and `Scene` run the program ``fetifeti`` on a scene file and read what it writes. They need NumPy only, and
  start no MPI in this process.

Nothing of petsc4py is imported before it is used, so that ``petsc4py.init(sys.argv)`` may follow ``import fetifeti``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._version import VERSION as __version__
from .library import NotFoundError, find_library, find_program
from .scene import InputError, NotConvergedError, ProgramError, Result, Scene, SceneError, solve
from .vtu import Fields, read_vtu

if TYPE_CHECKING:
    from .ksp import inner_ksp, pc_ksp, register, set_body, set_body_is, set_body_label, set_primal_dofs
    from .calls import ContactStep, Error
    from .contact import ContactFriction, RowKind, RowState
    from .solver import MortarFriction, MortarResult, Solver
    from .steps import LoadStep, LoadSteps

_PLACES = {
    "register": "ksp",
    "set_body": "ksp",
    "set_body_is": "ksp",
    "set_body_label": "ksp",
    "set_primal_dofs": "ksp",
    "inner_ksp": "ksp",
    "pc_ksp": "ksp",
    "Error": "calls",
    "Solver": "solver",
    "RowKind": "contact",
    "RowState": "contact",
    "ContactFriction": "contact",
    "ContactStep": "calls",
    "MortarFriction": "solver",
    "MortarResult": "solver",
    "LoadStep": "steps",
    "LoadSteps": "steps",
}

__all__ = [
    "__version__",
    "Fields",
    "InputError",
    "NotConvergedError",
    "NotFoundError",
    "ProgramError",
    "Result",
    "Scene",
    "SceneError",
    "find_library",
    "find_program",
    "read_vtu",
    "solve",
    *_PLACES,
]


def __getattr__(name: str) -> Any:
    """What needs petsc4py is imported when it is first asked for."""
    if name not in _PLACES:
        raise AttributeError(f"module 'fetifeti' has no attribute '{name}'")
    from importlib import import_module

    try:
        return getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)
    except ModuleNotFoundError as error:
        if error.name != "petsc4py":
            raise
        raise NotFoundError(
            f"fetifeti.{name} needs petsc4py, that of the PETSc which the library was built with. Debian's is found "
            "after 'export PYTHONPATH=/usr/lib/petscdir/petsc3.18/x86_64-linux-gnu-real/lib/python3/dist-packages'"
        ) from error


def __dir__() -> list[str]:
    return sorted(__all__)
