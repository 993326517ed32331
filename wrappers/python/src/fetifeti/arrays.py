"""Arrays from callers: checked and converted, never read as what they are not."""

from __future__ import annotations

from typing import Any

import numpy as np
from petsc4py import PETSc

INT = np.dtype(PETSc.IntType)
"""PetscInt."""


def integers(values: Any, what: str, shape: tuple[int | None, ...] = (None,)) -> np.ndarray:
    """A contiguous array of PetscInt.

    Parameters
    ----------
    values : array_like of int
        Any integer type whose values fit.
    what : str
        Its name in errors.
    shape : tuple
        The shape to expect, None for any length.

    Raises
    ------
    TypeError, ValueError
        Not integers; another shape; a number that PetscInt does not hold.
    """
    array = _shaped(values, what, shape)
    if array.size == 0:
        return np.zeros(array.shape, INT)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{what} has the type {array.dtype}, expected integers")
    bad = array[(array > np.iinfo(INT).max) | (array < np.iinfo(INT).min)]
    if bad.size:
        raise ValueError(f"{what} has the number {bad[0]}, expected one of {8 * INT.itemsize} bits")
    return np.ascontiguousarray(array, INT)


def reals(values: Any, what: str, shape: tuple[int | None, ...] = (None,)) -> np.ndarray:
    """A contiguous float64 array, of integers or real numbers; the parameters are those of `integers`.

    Raises
    ------
    TypeError, ValueError
        Not real numbers; another shape.
    """
    array = _shaped(values, what, shape)
    if array.size and array.dtype.kind not in "iuf":
        raise TypeError(f"{what} has the type {array.dtype}, expected real numbers")
    return np.ascontiguousarray(array, np.float64)


def for_each(values: Any, n: int, what: str, of: Any = reals) -> np.ndarray:
    """n numbers: an array of this length, or one number for all."""
    return of(np.full(n, values) if np.ndim(values) == 0 else values, what, (n,))


def csr(matrix: Any, what: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Row starts (rows + 1), columns and entries of a SciPy sparse matrix, a dense one, or such a triple.

    Raises
    ------
    TypeError, ValueError
        As `integers` and `reals`; starts that do not fit the columns.
    """
    if isinstance(matrix, tuple):
        if len(matrix) != 3:
            raise ValueError(f"{what} is a tuple of {len(matrix)}, expected row starts, columns and entries")
        ia, ja, a = matrix
    elif hasattr(matrix, "tocsr"):
        matrix = matrix.tocsr()
        ia, ja, a = matrix.indptr, matrix.indices, matrix.data
    else:
        dense = reals(matrix, what, (None, None))
        rows, ja = np.nonzero(dense)
        a = dense[rows, ja]
        ia = np.searchsorted(rows, np.arange(len(dense) + 1))
    ia, ja = integers(ia, f"the row starts of {what}"), integers(ja, f"the columns of {what}")
    a = reals(a, f"the entries of {what}", (len(ja),))
    if len(ia) == 0 or ia[0] != 0 or ia[-1] != len(ja) or np.any(np.diff(ia) < 0):
        raise ValueError(f"the row starts of {what} do not lead from 0 to its {len(ja)} entries")
    return ia, ja, a


def _shaped(values: Any, what: str, shape: tuple[int | None, ...]) -> np.ndarray:
    array = np.asarray(values)
    fits = array.ndim == len(shape) and all(n is None or n == m for n, m in zip(shape, array.shape))
    if not fits:
        wanted = ", ".join("any" if n is None else str(n) for n in shape)
        raise ValueError(f"{what} has the shape {array.shape}, expected ({wanted})")
    return array
