"""The KSP type "fetifeti" in petsc4py."""

from __future__ import annotations

import ctypes
from typing import Any

from petsc4py import PETSc

from .arrays import integers
from .calls import call, ksp_at


def register() -> None:
    """Registers the KSP type: ``ksp.setType("fetifeti")`` and ``-ksp_type fetifeti`` work afterwards.

    May be called several times. The operator must be a matrix of type "is" (MATIS). Calls FetiFetiInitializePackage.

    Raises
    ------
    NotFoundError
        The library is nowhere.
    Error
        The library belongs to another PETSc.
    """
    call("FetiFetiInitializePackage")


def set_body(ksp: PETSc.KSP, body: int) -> None:
    """Says which body this rank's subdomain belongs to: ranks with the same number form a body."""
    call("KSPFETIFETISetBody", ksp, int(body))


def set_body_is(ksp: PETSc.KSP, bodies: Any) -> None:
    """Says which body each row of the operator belongs to. Collective.

    Parameters
    ----------
    ksp : PETSc.KSP
        Of type "fetifeti".
    bodies : PETSc.IS or array_like of int, shape (rows of this rank,)
        The number of a body for each row.
    """
    if not isinstance(bodies, PETSc.IS):
        bodies = PETSc.IS().createGeneral(integers(bodies, "bodies"), comm=ksp.comm)
    call("KSPFETIFETISetBodyIS", ksp, bodies)


def set_body_label(ksp: PETSc.KSP, name: str) -> None:
    """Says that a label of the cells of a DMPlex names the bodies."""
    call("KSPFETIFETISetBodyLabel", ksp, name)


def inner_ksp(ksp: PETSc.KSP) -> PETSc.KSP:
    """The KSP that iterates on the multipliers, after ``ksp.setUp()``."""
    place = ctypes.c_void_p()
    call("KSPFETIFETIGetInnerKSP", ksp, ctypes.byref(place))
    return ksp_at(place)
