"""`fetifeti.Solver` with subdomains as arrays: against dense solutions and closed forms; and its errors."""

import numpy as np
import pytest
import scipy.sparse
from conftest import square
from petsc4py import PETSc

import fetifeti

OPTIONS = {"ksp_rtol": 1e-12, "contact_rtol": 1e-11}


def part_of(total, comm):
    """The first entry of this rank's part of a vector, and the one behind it."""
    return PETSc.Vec().createMPI(total, comm=comm).getOwnershipRange()


def everywhere(values, comm):
    """The parts of all ranks, one behind the other."""
    vec = PETSc.Vec().createWithArray(np.array(values), comm=comm)
    scatter, whole = PETSc.Scatter.toAll(vec)
    scatter.scatter(vec, whole)
    return whole.getArray().copy()


def bar(solver, comm, elements, stiffness):
    """A bar of springs, a subdomain on each rank, held at the left; returns the number of its unknowns."""
    k = stiffness * scipy.sparse.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(elements + 1,) * 2).tolil()
    k[0, 0] = k[elements, elements] = stiffness
    solver.add_subdomain(k.tocsr(), comm.rank * elements + np.arange(elements + 1), body=0)
    solver.set_dirichlet([0] if comm.rank == 0 else [])
    return elements * comm.size + 1


@pytest.mark.parametrize("kind", ["inequality", fetifeti.RowKind.EQUALITY])
def test_force_of_an_obstacle_is_that_of_the_closed_form(world, kind):
    stiffness, pull, gap = 3.0, 2.0, 0.1
    with fetifeti.Solver(world, options=OPTIONS) as solver:
        n = bar(solver, world, 6, stiffness)
        low, high = part_of(n, world)
        load = np.zeros(high - low)
        mine = low <= n - 1 < high
        if mine:
            load[-1] = pull
        # The end of the bar, no further than the gap; one rank gives the row.
        row = scipy.sparse.csr_matrix(([1.0], ([0], [n - 1])), shape=(1, n))
        solver.set_contact_rows(row if mine else row[:0], gap, kind)
        u = everywhere(solver.solve(load), world)
        force = solver.multipliers
        again = solver.solve(load)
        assert np.allclose(everywhere(again, world), u, atol=1e-12)
        assert solver.converged
    assert np.allclose(u, gap * np.arange(n) / (n - 1), atol=1e-10)
    assert force.shape == (int(mine),)
    assert np.allclose(force, pull - gap * stiffness / (n - 1), atol=1e-9)


def test_an_obstacle_out_of_reach_has_no_force(world):
    with fetifeti.Solver(world, options=OPTIONS) as solver:
        n = bar(solver, world, 6, 3.0)
        low, high = part_of(n, world)
        load = (np.arange(low, high) == n - 1).astype(int)
        mine = [n - 1] if world.rank == 0 else []
        starts = np.arange(len(mine) + 1)
        solver.set_contact_rows((starts, mine, np.ones(len(mine))), np.full(len(mine), 1e3))
        u = everywhere(solver.solve(load), world)
        assert np.all(solver.multipliers == 0)
    assert np.allclose(u, np.arange(n) / 3.0, atol=1e-9)


def test_given_values_and_tied_bodies(world):
    """Each rank's square is a body of its own; those that list the same unknowns are tied."""
    m, n = 3, (3 * world.size + 1) * 4
    dofs = [((p * m + np.arange(m + 1)) * (m + 1) + j) for p in range(world.size) for j in range(m + 1)]
    of_rank = np.array(dofs).reshape(world.size, -1)
    whole = np.zeros((n, n))
    for at in of_rank:
        whole[np.ix_(at, at)] += square(m)
    low, high = part_of(n, world)
    held = np.arange(4)
    given = PETSc.Vec().createMPI(n, comm=world)
    given.setArray(0.1 * np.arange(low, high))
    f = np.cos(np.arange(n))
    with fetifeti.Solver(world, options=OPTIONS) as solver:
        solver.set_sizes(high - low, n)
        solver.set_block_size(1)
        solver.add_subdomain(square(m), of_rank[world.rank], body=world.rank)
        solver.set_dirichlet(held if world.rank == world.size - 1 else [], given)
        solver.setup()
        solver.inner_ksp.setTolerances(rtol=1e-12)
        u = everywhere(solver.solve(f[low:high]), world)
        assert solver.contact_steps == 0
    free, values = np.arange(4, n), 0.1 * np.arange(4)
    exact = np.linalg.solve(whole[np.ix_(free, free)], f[free] - whole[np.ix_(free, held)] @ values)
    assert np.allclose(u, np.concatenate([values, exact]), atol=1e-8)


def test_mortar_tie_of_two_meshes_has_the_flux_of_the_patch(world):
    """u = y on two membranes above each other with 3 x 3 and 2 x 2 elements: the flux through the joint is 1."""
    first = {"m": 3, "y": 0.0, "dofs": np.arange(16), "body": 0, "rank": 0}
    second = {"m": 2, "y": 1.0, "dofs": 16 + np.arange(9), "body": 1, "rank": world.size - 1}
    low, high = part_of(25, world)
    load = np.zeros(25)
    load[22:] = [0.25, 0.5, 0.25]
    with fetifeti.Solver(world, options=OPTIONS) as solver:
        solver.set_sizes(high - low, 25)
        for side, row in (first, 3), (second, 0):
            m, w = side["m"], side["m"] + 1
            x = np.arange(w) / m
            coordinates, dofs, faces = np.zeros((0, 2)), np.zeros(0, int), []
            if world.rank == side["rank"]:
                solver.add_subdomain(square(m), side["dofs"], side["body"])
                coordinates = np.stack([x, np.full(w, 1.0)], 1)
                dofs = side["dofs"][row * w : (row + 1) * w]
                # The body lies to the left on the way along a face.
                faces = [[i + 1, i] if row else [i, i + 1] for i in range(m)]
            number = solver.add_surface(coordinates, dofs, faces)
            assert number == side["body"]
        solver.set_dirichlet(np.arange(4) if world.rank == 0 else [])
        assert solver.add_mortar(0, 1, "equality") == 0
        u = everywhere(solver.solve(load[low:high]), world)
        result = solver.mortar(0)
        with pytest.raises(ValueError, match="no mortar 1, expected one of 1"):
            solver.mortar(1)
        assert np.all(np.isfinite(solver.spectrum))
        solver.reset_mortar()
    exact = np.concatenate([np.repeat(np.arange(4) / 3, 4), 1 + np.repeat(np.arange(3) / 2, 3)])
    assert np.allclose(u, exact, atol=1e-9)
    assert result.pressure.shape == ((4, 1) if world.rank == 0 else (0, 1))
    assert np.allclose(np.abs(result.pressure), 1.0, atol=1e-8)
    assert np.all(result.state == 1)


def test_errors_are_exceptions_with_a_sentence_on_all_ranks(world):
    with fetifeti.Solver(world) as solver:
        with pytest.raises(fetifeti.Error, match="expected") as caught:
            solver.setup()
        assert isinstance(caught.value, PETSc.Error) and caught.value.ierr > 0
        assert caught.value.sentence in str(caught.value) and "FetiFetiSetUp" in str(caught.value)
        with pytest.raises(fetifeti.Error, match="nothing has been solved yet"):
            solver.iterations
        with pytest.raises(fetifeti.Error, match="matrix 3 but 0 have been added"):
            solver.add_contact_pairs([0], [1], matrices=(3, 0))
        # The solver lives on.
        n = bar(solver, world, 2, 1.0)
        low, high = part_of(n, world)
        assert np.all(solver.solve(np.zeros(high - low)) == 0)
        with pytest.raises(fetifeti.Error):
            solver.solve(np.zeros(high - low + 1))
        solver.reset()
        with pytest.raises(fetifeti.Error):
            solver.setup()
    solver.destroy()
    with pytest.raises(fetifeti.Error, match="FetiFeti is NULL"):
        solver.setup()


def test_arrays_are_converted_or_refused(world):
    with fetifeti.Solver(world) as solver:
        k = np.array([[1.0, -1.0], [-1.0, 1.0]])
        for error, matrix, dofs, sentence in [
            (TypeError, k, [0.0, 1.0], "dofs has the type float64, expected integers"),
            (ValueError, k, [0, 1, 2], r"dofs has the shape \(3,\), expected \(2\)"),
            (ValueError, k, [0, 2**31], "dofs has the number 2147483648"),
            (TypeError, 1j * k, [0, 1], "matrix has the type complex128, expected real numbers"),
            (TypeError, scipy.sparse.csr_matrix(1j * k), [0, 1], "entries of matrix has the type complex128"),
            (ValueError, ([0, 2, 1], [0, 1], [1.0, 1.0]), [0, 1], "row starts of matrix do not lead"),
            (ValueError, ([0, 1, 2], [0, 1], [1.0]), [0, 1], r"entries of matrix has the shape \(1,\)"),
            (TypeError, k, ["a", "b"], "dofs has the type <U1"),
        ]:
            with pytest.raises(error, match=sentence):
                solver.add_subdomain(matrix, dofs)
        with pytest.raises(ValueError, match="of kind 'friction', expected 'equality' or 'inequality'"):
            solver.set_contact_rows(k, 0.0, "friction")
        with pytest.raises(ValueError, match=r"gap has the shape \(3,\), expected \(2\)"):
            solver.set_contact_rows(k, np.zeros(3))
        with pytest.raises(ValueError, match="a face has node 2, expected places in the list of 2 nodes"):
            solver.add_surface(np.zeros((2, 2)), [0, 1], [[1, 2]])
        # Other types and strides with the same numbers are as good.
        a = np.asfortranarray(np.kron(k, np.ones((1, 2))))[:, ::2].astype("f4")
        dofs = (world.rank + np.arange(4, dtype="i8"))[:2]
        solver.add_subdomain(a, dofs)
        solver.set_dirichlet(PETSc.IS().createGeneral([0] if world.rank == 0 else [], comm=world))
        n = world.size + 1
        low, high = part_of(n, world)
        load = (np.arange(low, high) == n - 1).astype(np.int64)
        assert np.allclose(everywhere(solver.solve(load), world), np.arange(n), atol=1e-9)


def test_prefixes_and_options(world):
    with fetifeti.Solver(world, prefix="mine_", options={"ksp_rtol": 1e-9}) as solver:
        n = bar(solver, world, 4, 1.0)
        low, high = part_of(n, world)
        solver.solve(np.ones(high - low))
        assert solver.inner_ksp.getTolerances()[0] == 1e-9
        assert solver.inner_ksp.getOptionsPrefix().startswith("mine_fetifeti_")
        viewer = PETSc.Viewer().createASCII("/dev/null", comm=world)
        solver.view(viewer)


def test_vectors_and_sets_of_petsc(world):
    """What set_mat_is, numbers, motions, coordinates and index sets take."""
    n = 4 * world.size + 1
    at = 4 * world.rank + np.arange(5, dtype="i4")
    map = PETSc.LGMap().create(at, comm=world)
    A = PETSc.Mat().createIS([n, n], lgmapr=map, lgmapc=map, comm=world)
    k = 2.0 * np.eye(5) - np.eye(5, k=1) - np.eye(5, k=-1)
    k[0, 0] = k[4, 4] = 1.0
    rows, columns = np.arange(0, 26, 5, dtype="i4"), np.tile(np.arange(5, dtype="i4"), 5)
    A.setISLocalMat(PETSc.Mat().createAIJ([5, 5], csr=(rows, columns, k.ravel()), comm=PETSc.COMM_SELF))
    A.assemble()
    low, high = A.getOwnershipRange()
    b = A.createVecLeft()
    b.setArray((np.arange(low, high) == n - 1) * 1.0)
    for way in ("whole", "numbers", "reversed"):
        with fetifeti.Solver(world, options=OPTIONS) as solver:
            held = 0
            if way == "whole":
                solver.set_mat_is(A, body=3)
                solver.set_coordinates(np.arange(low, high)[:, None])
                solver.set_near_null_space(PETSc.NullSpace().create(constant=True, comm=world))
            elif way == "numbers":
                solver.add_mat_is(A, numbers=np.arange(low, high), body=0)
                solver.set_neumann([n - 1] if world.rank == 0 else [])
            else:
                solver.set_sizes(high - low, n)
                solver.add_mat_is(A, numbers=PETSc.IS().createStride(high - low, n - 1 - low, -1, comm=world), body=0)
                held = n - 1
            solver.set_dirichlet(PETSc.IS().createGeneral([held] if world.rank == 0 else [], comm=world))
            solver.set_primal_dofs([4] if world.rank == 0 else [])
            load = b.duplicate()
            if way == "reversed":
                load.setArray((np.arange(low, high) == 0) * 1.0)
            else:
                b.copy(load)
            x = b.duplicate()
            assert solver.solve(load, x) is x
            u = everywhere(x.getArray(), world)
        exact = np.arange(n)[::-1] if way == "reversed" else np.arange(n)
        assert np.allclose(u, exact, atol=1e-9), way


def test_pairs_tie_and_are_forgotten(world):
    """Two bars side by side on one rank, tied at their ends by a pair; then apart."""
    spring = scipy.sparse.csr_matrix([[1.0, -1.0], [-1.0, 1.0]])
    low, high = part_of(4, world)
    load = (np.arange(low, high) == 3) * 1.0
    last = world.rank == world.size - 1
    with fetifeti.Solver(world, options=OPTIONS) as solver:
        solver.set_sizes(high - low, 4)
        if last:
            solver.add_subdomain(spring, [0, 1], body=0)
            solver.add_subdomain(spring, [2, 3], body=1)
        solver.set_dirichlet([0, 2] if last else [])
        solver.add_contact_pairs([1] if last else [], [3] if last else [], kind="equality")
        u = everywhere(solver.solve(load), world)
        force = solver.multipliers
        assert np.allclose(u, [0, 0.5, 0, 0.5], atol=1e-10)
        assert np.allclose(force, [-0.5] if last else [], atol=1e-10)
        solver.clear_contact_pairs()
        assert np.allclose(everywhere(solver.solve(load), world), [0, 0, 0, 1], atol=1e-10)
        assert solver.multipliers.shape == (0,)
