"""The types "fetifeti" of KSP and PC in petsc4py."""

from __future__ import annotations

import ctypes
from typing import Any

from petsc4py import PETSc

from .arrays import integers
from .calls import call, ksp_at


def register() -> None:
    """Registers "fetifeti" as a type of KSP and PC: ``ksp.setType("fetifeti")`` and ``-ksp_type fetifeti`` work then.

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


def set_primal_dofs(ksp: PETSc.KSP, dofs: Any) -> None:
    """Makes unknowns primal where subdomains of one body share them. Collective.

    Parameters
    ----------
    ksp : PETSc.KSP
        Of type "fetifeti".
    dofs : PETSc.IS or array_like of int
        Global numbers of unknowns, listed by any rank.
    """
    if not isinstance(dofs, PETSc.IS):
        dofs = PETSc.IS().createGeneral(integers(dofs, "dofs"), comm=ksp.comm)
    call("KSPFETIFETISetPrimalDofs", ksp, dofs)


def pc_ksp(pc: PETSc.PC) -> PETSc.KSP:
    """The KSP that a PC of type "fetifeti" applies: for `set_body` and its like."""
    place = ctypes.c_void_p()
    call("PCFETIFETIGetKSP", pc, ctypes.byref(place))
    return ksp_at(place)


def inner_ksp(ksp: PETSc.KSP) -> PETSc.KSP:
    """The KSP that iterates on the multipliers, after ``ksp.setUp()``."""
    place = ctypes.c_void_p()
    call("KSPFETIFETIGetInnerKSP", ksp, ctypes.byref(place))
    return ksp_at(place)
