"""`Scene.steps`: the load steps of a scene in this process, against those of the program. On any number of ranks."""

import gc

import numpy as np
import pytest

import fetifeti

SCENE = """
title = "Two blocks"
physics = "elasticity"
[options]
fetifeti_ksp_rtol = 1e-11
[[body]]
name = "low"
size = 1
elements = 4
subdomains = 2
young = 100
poisson = 0.3
dirichlet = ["bottom"]
[[body]]
name = "high"
origin = [0.1, 1]
size = 0.8
elements = 6
subdomains = 2
young = 100
poisson = 0.2
dirichlet = { top = { x = 0.05, y = -0.1 } }
[[contact]]
bodies = ["low", "high"]
[steps]
count = 3
dirichlet = "t"
update = true
"""


@pytest.fixture(scope="module")
def program():
    """What the program finds; every rank has it solve for itself."""
    return fetifeti.Scene.from_text(SCENE).solve()


def same_displacements(steps, step, fields):
    """Compares with the fields of the program, whose points are those of subdomains."""
    cells = np.concatenate([np.asarray(c) for c in fields.cells().values()])
    for number, name in enumerate(steps.bodies):
        x, u = steps.points(name), step.displacements(number)
        assert x.shape == (len(u), 3) and u.shape[1] == 2
        points = np.unique(cells[fields.cell_data["body"] == number])
        distance = np.linalg.norm(fields.points[points][:, None] - x[None], axis=2)
        nearest = distance.argmin(1)
        assert np.all(distance.min(1) < 1e-9) and set(nearest) == set(range(len(x)))
        assert np.allclose(fields.point_data["u"][points, :2], u[nearest], rtol=0, atol=1e-9)


def test_every_step_is_that_of_the_program(program):
    seen = []
    with fetifeti.Scene.from_text(SCENE).steps() as steps:
        assert steps.bodies == ["low", "high"]
        for step in steps:
            told = program.load_steps[step.number]
            assert step.converged and step.reason_name.startswith("CONVERGED") and step.iterations > 0
            assert np.isclose(step.time, told["t"]) and np.isclose(step.energy, told["energy"], rtol=1e-9)
            same_displacements(steps, step, program.steps[step.number].fields)
            contact = step.contact[step.contact["inequality"]]
            assert contact["active"].sum() == told["active"]
            assert np.isclose(contact["multiplier"].sum(), told["contact_force"], rtol=1e-8)
            assert np.all(contact["gap"][contact["active"]] < 1e-9)
            assert set(contact["body"][:, 0]) <= {0, 1} and np.all(contact["node"][:, 0] >= 0)
            seen.append(step)
        assert [step.number for step in seen] == [0, 1, 2] and next(steps, None) is None
        # The last step stays, the arrays of those before do not.
        assert np.allclose(seen[2].displacements("high")[:, 1].min(), -0.1, atol=1e-9)
        with pytest.raises(ValueError, match="load step 0 is no longer the present one"):
            seen[0].displacements(0)
        assert seen[0].energy == pytest.approx(program.load_steps["energy"][0], rel=1e-9)
    rows = program.contact
    assert np.allclose(contact["multiplier"], rows["multiplier"], rtol=0, atol=1e-8)
    assert np.allclose(contact["x"][:, 0], rows["x"]) and np.array_equal(contact["active"], rows["active"])


def test_steps_resume(program, world, tmp_path):
    scene = fetifeti.Scene.from_text(SCENE)
    # Rank 0 writes and reads: the file of the others may be anywhere.
    file = tmp_path / "state"
    with scene.steps() as steps:
        next(steps).checkpoint(file)
    with scene.steps(resume=file) as steps:
        rest = list(steps)
        rest[-1].checkpoint(file)  # nothing is left to resume
    assert [step.number for step in rest] == [1, 2]
    assert np.allclose([step.energy for step in rest], program.load_steps["energy"][1:], rtol=1e-7)
    other = fetifeti.Scene.from_text(SCENE.replace("poisson = 0.3", "poisson = 0.25"))
    with pytest.raises(fetifeti.InputError, match="as it was before it changed"):
        other.steps(resume=file)


def test_scenes_speak_in_exceptions(world):
    with pytest.raises(fetifeti.InputError, match=r"nothing.toml: the scene cannot be read") as caught:
        fetifeti.Scene("nothing.toml").steps()
    assert caught.value.code == 2
    with pytest.raises(fetifeti.InputError, match=r"scene.toml:12: unknown key `poison`"):
        fetifeti.Scene.from_text(SCENE.replace("poisson = 0.3", "poison = 0.3")).steps()
    from petsc4py import PETSc

    with fetifeti.Scene.from_text(SCENE).steps({"fetifeti_ksp_max_it": 1}) as steps:
        with pytest.raises(fetifeti.NotConvergedError, match="load step 1 of 3 of .* did not converge") as caught:
            next(steps)
        PETSc.Options().delValue("fetifeti_ksp_max_it")
        step = caught.value.step
        assert step.number == 0 and not step.converged and step.reason_name == "DIVERGED_ITS"
        assert step.displacements("low").shape == (25, 2) and next(steps, None) is None
        # A number from the rows is one, too.
        of_rows = step.contact["body"][0][0]
        assert step.displacements(of_rows).shape == step.displacements(int(of_rows)).shape
        with pytest.raises(ValueError, match="there is no body 'middle', expected one of low, high"):
            step.displacements("middle")
        with pytest.raises(fetifeti.Error, match="there is no body 7"):
            step.displacements(7)


def test_memory_is_given_back(world):
    if world.size > 1:
        pytest.skip("on several ranks it is given back on demand")
    for _ in range(3):
        steps = fetifeti.Scene.from_text(SCENE).steps()
        handle = steps._handle
        next(steps)
        del steps
        gc.collect()
        assert not handle


def test_friction_of_a_step(world):
    """A block that is moved by its top slips as a whole: friction is the coefficient times the force."""
    text = """
physics = "elasticity"
[[body]]
name = "block"
size = [2, 1]
elements = [16, 8]
young = 1
poisson = 0.3
traction = { top = [0, -0.1] }
dirichlet = { top = { x = 0.3 } }
[[obstacle]]
body = "block"
side = "bottom"
plane = { point = [0, 0], normal = [0, 1] }
friction = 0.3
[steps]
count = 2
dirichlet = "t"
"""
    with fetifeti.Scene.from_text(text).steps({"fetifeti_ksp_rtol": 1e-10}) as steps:
        first, last = next(steps).contact, next(steps).contact
    slips = last["state"] == fetifeti.RowState.SLIP
    assert slips.sum() > 10 and not np.any(last["state"] == fetifeti.RowState.STICK)
    assert np.isclose(last["multiplier"].sum(), 0.2, atol=1e-8)
    # The block moves along +x and drags the plane along.
    assert np.allclose(last["friction"].sum(axis=0), [0.06, 0, 0], atol=1e-7)
    assert np.allclose(last["friction"][:, 0], 0.3 * last["multiplier"], atol=1e-7)
    assert np.allclose(last["slip"][slips, 0], 0.15, atol=1e-6)
    assert not np.any(first["friction"][:, 1]) and first["friction"][:, 0].sum() <= 0.06 + 1e-7
