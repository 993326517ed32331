"""Problems with known solutions, and what all tests need."""

import os
import sys
import tempfile

import numpy as np
import pytest


@pytest.fixture
def world():
    """PETSc's world."""
    from petsc4py import PETSc

    return PETSc.COMM_WORLD


def pytest_configure(config):
    """Ranks have temporary directories of their own: pytest would tidy up those of the others."""
    if int(os.environ.get("OMPI_COMM_WORLD_SIZE", 1)) > 1:
        config.option.basetemp = tempfile.mkdtemp(prefix="fetifeti-test-")


def pytest_exception_interact(report):
    """A failure on one of several ranks ends all of them: the others may wait for it."""
    if int(os.environ.get("OMPI_COMM_WORLD_SIZE", 1)) > 1:
        print(report.longreprtext, file=sys.stderr, flush=True)
        os._exit(1)


def square(m):
    """The stiffness matrix of the Laplace operator on m x m squares of bilinear elements of edge 1, dense."""
    local = np.array([[4, -1, -2, -1], [-1, 4, -1, -2], [-2, -1, 4, -1], [-1, -2, -1, 4]]) / 6
    k, w = np.zeros(((m + 1) ** 2,) * 2), m + 1
    for i in range(m):
        for j in range(m):
            nodes = [j * w + i, j * w + i + 1, (j + 1) * w + i + 1, (j + 1) * w + i]
            k[np.ix_(nodes, nodes)] += local
    return k
