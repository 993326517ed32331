"""Calls of the functions of fetifeti.h and fetifeti_step.h: their arguments, and errors as exceptions."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

import numpy as np
from petsc4py import PETSc

from .arrays import INT
from .library import LIBRARY, STEP_LIBRARY, load

DECIDE = -1
"""PETSC_DECIDE."""

ERR_USER = 83
"""PETSC_ERR_USER."""

_C, _D, _P, _S = ctypes.c_int, ctypes.c_double, ctypes.c_void_p, ctypes.c_char_p

PETSC_INT = _I = ctypes.c_int64 if INT.itemsize == 8 else ctypes.c_int
"""PetscInt, as ctypes has it."""

# Types of the arguments, in their order; handles, arrays and places for results are pointers.
SIGNATURES: dict[str, list[Any]] = {
    "FetiFetiInitializePackage": [],
    "KSPFETIFETISetBody": [_P, _I],
    "KSPFETIFETISetBodyIS": [_P, _P],
    "KSPFETIFETISetBodyLabel": [_P, _S],
    "KSPFETIFETISetPrimalDofs": [_P, _P],
    "KSPFETIFETIGetInnerKSP": [_P, _P],
    "PCFETIFETIGetKSP": [_P, _P],
    "FetiFetiCreateFortran": [_C, _P],
    "FetiFetiDestroy": [_P],
    "FetiFetiReset": [_P],
    "FetiFetiSetOptionsPrefix": [_P, _S],
    "FetiFetiSetFromOptions": [_P],
    "FetiFetiView": [_P, _P],
    "FetiFetiSetSizes": [_P, _I, _I],
    "FetiFetiSetBlockSize": [_P, _I],
    "FetiFetiAddSubdomain": [_P, _I, _I, _P, _P, _P, _P],
    "FetiFetiSetMatIS": [_P, _P, _I],
    "FetiFetiAddMatIS": [_P, _P, _P, _I],
    "FetiFetiSetNearNullSpace": [_P, _P],
    "FetiFetiSetCoordinates": [_P, _I, _I, _P],
    "FetiFetiSetDirichletBoundaries": [_P, _P, _P],
    "FetiFetiSetNeumannBoundaries": [_P, _P],
    "FetiFetiSetPrimalDofs": [_P, _P],
    "FetiFetiSetContactRows": [_P, _I, _P, _P, _P, _P, _P],
    "FetiFetiUpdateMatrices": [_P, _I, _P],
    "FetiFetiUpdateSubdomain": [_P, _I, _I, _P, _P, _P],
    "FetiFetiSetContactRowsByMatrix": [_P, _I, _P, _P, _P, _P, _P, _P],
    "FetiFetiSetContactGaps": [_P, _I, _P],
    "FetiFetiSetContactPairs": [_P, _I, _P, _I, _P, _P, _I],
    "FetiFetiSetContactLaw": [_P, _I, _P, _P, _P, _P, _P],
    "FetiFetiSetContactSlip": [_P, _I, _I, _P],
    "FetiFetiNextContactStep": [_P],
    "FetiFetiGetContactFriction": [_P, _I, _I, _P, _P, _P],
    "FetiFetiContactMonitorSet": [_P, _P, _P],
    "FetiFetiAddSurface": [_P, _I, _I, _I, _I, _P, _P, _I, _P, _P, _P],
    "FetiFetiAddMortar": [_P, _I, _I, _I, _D, _D, _D, _P, _P, _P],
    "FetiFetiSetMortarLaw": [_P, _I, _D, _D, _D, _D, _D],
    "FetiFetiSetMortarSlip": [_P, _I, _I, _P],
    "FetiFetiGetMortar": [_P, _I, _I, _P, _P, _P, _P],
    "FetiFetiGetMortarFriction": [_P, _I, _I, _P, _P, _P],
    "FetiFetiResetMortar": [_P],
    "FetiFetiSetUp": [_P],
    "FetiFetiSolve": [_P, _P, _P],
    "FetiFetiGetIterations": [_P, _P],
    "FetiFetiGetContactSteps": [_P, _P],
    "FetiFetiGetConvergedReason": [_P, _P],
    "FetiFetiGetSpectrum": [_P, _P, _P],
    "FetiFetiGetKKT": [_P, _P],
    "FetiFetiGetMultipliers": [_P, _I, _P],
    "FetiFetiGetInnerKSP": [_P, _P],
}

STEP_SIGNATURES: dict[str, list[Any]] = {
    "FetiFetiStepCreateFortran": [_C, _S, _P],
    "FetiFetiStepDestroy": [_P],
    "FetiFetiStepNext": [_P, _P],
    "FetiFetiStepGetNumber": [_P, _P],
    "FetiFetiStepGetTime": [_P, _P],
    "FetiFetiStepGetEnergy": [_P, _P],
    "FetiFetiStepGetIterations": [_P, _P],
    "FetiFetiStepGetConvergedReason": [_P, _P, _P],
    "FetiFetiStepGetBodies": [_P, _P],
    "FetiFetiStepGetBody": [_P, _I, _P, _P, _P],
    "FetiFetiStepGetCoordinates": [_P, _I, _I, _P],
    "FetiFetiStepGetDisplacements": [_P, _I, _I, _P],
    "FetiFetiStepGetContact": [_P, _P, _P],
    "FetiFetiStepCheckpoint": [_P, _S],
    "FetiFetiStepResume": [_P, _S],
}


class ContactStep(ctypes.Structure):
    """A step of the contact loop, as `Solver.on_step` gets it."""

    _fields_ = [
        ("step", _I),
        ("active", _I),
        ("entered", _I),
        ("left", _I),
        ("wrong", _I),
        ("iterations", _I),
        ("residual", _D),
        ("tolerance", _D),
    ]


MONITOR = ctypes.CFUNCTYPE(_C, ctypes.POINTER(ContactStep), _P)
"""The type of the function that the library calls after each step."""


_HANDLER = ctypes.CFUNCTYPE(_C, _P, _C, _S, _S, _C, _C, _S, _P)
_ERROR_INITIAL = 0


class Error(PETSc.Error):
    """An error of the library or of PETSc under it.

    Attributes
    ----------
    ierr : int
        PETSc's error code.
    sentence : str
        What is wrong; the same on all ranks after a collective call.
    """

    def __init__(self, function: str, ierr: int, sentence: str) -> None:
        super().__init__(ierr)
        self.function = function
        self.sentence = sentence

    def __str__(self) -> str:
        return f"{self.function}: {self.sentence} (PETSc error {self.ierr})"


@lru_cache(maxsize=None)
def _library(file: str) -> ctypes.PyDLL:
    if np.dtype(PETSc.ScalarType) != np.float64:
        raise ImportError(
            f"petsc4py has {np.dtype(PETSc.ScalarType)} numbers, expected float64, with which fetifeti is built"
        )
    library = load(file)
    for name, arguments in (SIGNATURES if file == LIBRARY else STEP_SIGNATURES).items():
        function = getattr(library, name)
        function.argtypes, function.restype = arguments, _C
    return library


def call(name: str, *arguments: Any) -> None:
    """Calls a function: PETSc objects and None for handles, NumPy arrays for arrays and places of results.

    Raises
    ------
    Error
        The function returned an error code.
    """
    library = _library(STEP_LIBRARY if name in STEP_SIGNATURES else LIBRARY)
    with _listening(library) as said:
        code = getattr(library, name)(*[_argument(a) for a in arguments])
    if code:
        text = re.sub(r"^\[\d+\] ", "", said[-1]) if said else PETSc.Error(code).args[-1]
        raise Error(name, code, str(text))


@contextmanager
def _listening(library: ctypes.PyDLL) -> Iterator[list[str]]:
    """What PETSc's error handler is given meanwhile, the sentence last."""
    if hasattr(PETSc.Error, "_traceback_"):  # older versions of petsc4py keep it there
        trace: list[str] = PETSc.Error._traceback_
        del trace[:]
        yield trace
        return
    said: list[str] = []

    def listen(comm: Any, line: int, function: Any, file: Any, code: int, kind: int, text: Any, context: Any) -> int:
        if kind == _ERROR_INITIAL:
            said[:] = [text.decode(errors="replace")] if text else []
        return code

    handler = _HANDLER(listen)
    library.PetscPushErrorHandler(handler, None)
    try:
        yield said
    finally:
        library.PetscPopErrorHandler()


def _argument(a: Any) -> Any:
    if isinstance(a, PETSc.Object):
        return a.handle
    if isinstance(a, np.ndarray):
        return a.ctypes.data
    return a.encode() if isinstance(a, str) else a


def ksp_at(address: ctypes.c_void_p) -> PETSc.KSP:
    """The petsc4py object of a KSP in C, which it refers to (petsc4py's C function PyPetscKSP_New)."""
    python, capsule = ctypes.pythonapi, PETSc.__pyx_capi__["PyPetscKSP_New"]
    python.PyCapsule_GetName.restype, python.PyCapsule_GetName.argtypes = _S, [ctypes.py_object]
    python.PyCapsule_GetPointer.restype, python.PyCapsule_GetPointer.argtypes = _P, [ctypes.py_object, _S]
    new = python.PyCapsule_GetPointer(capsule, python.PyCapsule_GetName(capsule))
    return ctypes.PYFUNCTYPE(ctypes.py_object, _P)(new)(address)
