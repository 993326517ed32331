"""`fetifeti.solve` and `fetifeti.Scene`: fields, tables and errors, in one process, which may run under mpirun."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest

import fetifeti

SOURCES = Path(os.environ.get("FETIFETI_SOURCES") or Path(__file__).resolve().parents[3])
SCENES = SOURCES / "examples" / "scenes"

pytestmark = pytest.mark.skipif(
    int(os.environ.get("OMPI_COMM_WORLD_SIZE", 1)) > 1, reason="a scene is solved by processes of its own"
)


@pytest.mark.parametrize("ranks", [1, 2])
def test_contact_holds_the_floating_body(ranks, capfd):
    result = fetifeti.solve(SCENES / "model_contact.toml", ranks=ranks)
    assert capfd.readouterr() == ("", "")
    assert result.report["ranks"] == ranks
    # The load of the right body is -1/4, and only the contact carries it.
    contact = result.contact
    assert abs(contact["multiplier"].sum() - 0.25) < 1e-8
    assert np.all(contact["x"] == 1) and np.all(contact["name"] == "left|right")
    assert 0 < contact["active"].sum() < len(contact) == 33
    assert np.all(contact["gap"][contact["active"]] < 1e-9)
    fields = result.fields
    u, x = fields.point_data["u"], fields.points
    assert u.shape == (2 * 33 * 33,) and x.shape == (2 * 33 * 33, 3)
    held = x[:, 0] == 0
    assert held.sum() == 33 and np.all(u[held] == 0)
    # 1/2 f'u = -energy without gaps; the load is -3 on a quarter of the left body, -1 on one of the right one.
    cells, body = fields.cells()[9], fields.cell_data["body"]
    middle, mean = x[cells].mean(1), u[cells].mean(1)
    load = np.where(body == 0, -3.0 * (middle[:, 1] > 0.75), -1.0 * (middle[:, 1] < 0.25))
    assert abs(-0.5 * np.sum(load * mean) / 32**2 - result.report["energy"]) < 1e-7
    assert len(result.contact_steps) == result.report["outer_iterations"]
    assert result.steps == [] and len(result.load_steps) == 0


def test_load_steps_and_a_callback_for_each_contact_step():
    seen = []
    result = fetifeti.Scene(SCENES / "press_ramp.toml").solve(on_step=seen.append)
    assert seen == result.report["contact"]["steps"]
    assert len(result.steps) == len(result.load_steps) == 10
    assert np.allclose(result.load_steps["t"], [step.t for step in result.steps])
    last, end = result.steps[-1].fields.point_data["u"], result.fields.point_data["u"]
    assert np.array_equal(last, end) and not np.allclose(result.steps[0].fields.point_data["u"], end)
    final = result.contact["multiplier"][result.contact["active"]].sum()
    assert abs(final - result.load_steps["contact_force"][-1]) < 1e-9
    assert set(result.contact_steps["method"]) == {"active_set"}


def test_a_callback_can_stop_the_program():
    class Enough(Exception):
        pass

    def stop(step):
        raise Enough(step["step"])

    with pytest.raises(Enough):
        fetifeti.solve(SCENES / "press_ramp.toml", on_step=stop)


def test_the_program_speaks_in_exceptions(tmp_path, monkeypatch):
    with pytest.raises(fetifeti.InputError, match="nothing.toml: the scene cannot be read") as caught:
        fetifeti.solve("nothing.toml")
    assert caught.value.code == 2 and isinstance(caught.value, ValueError)
    with pytest.raises(fetifeti.InputError, match="unknown key `x` in the scene"):
        fetifeti.Scene.from_text("x = 1").solve()
    with pytest.raises(fetifeti.NotConvergedError, match="did not converge: DIVERGED_ITS") as caught:
        fetifeti.solve(SCENES / "model_contact.toml", {"fetifeti_ksp_max_it": 1})
    assert caught.value.result.fields.point_data["u"].shape == (2178,)
    (tmp_path / "file").write_text("")
    with pytest.raises(fetifeti.ProgramError) as caught:
        fetifeti.solve(SCENES / "model_contact.toml", out=tmp_path / "file" / "below")
    assert caught.value.code == 3
    seen = []
    fetifeti.solve(SCENES / "poisson_2x2.toml", on_step=seen.append)
    assert seen == []
    mpirun = tmp_path / "mpirun"
    mpirun.write_text("#!/bin/sh\necho no room >&2\nexit 1\n")
    mpirun.chmod(0o755)
    monkeypatch.setenv("FETIFETI_MPIRUN", str(mpirun))
    with pytest.raises(fetifeti.ProgramError, match="no room"):
        fetifeti.solve(SCENES / "poisson_2x2.toml", ranks=2)
    with pytest.raises(ValueError, match="ranks is 0"):
        fetifeti.solve(SCENES / "poisson_2x2.toml", ranks=0)


def test_stress_in_space_and_files_that_stay(tmp_path):
    result = fetifeti.solve(SCENES / "blocks_3d.toml", out=tmp_path / "out")
    fields = result.fields
    n = len(fields.points)
    assert fields.point_data["u"].shape == (n, 3) and fields.point_data["stress"].shape == (n, 6)
    s = fields.point_data["stress"]
    xx, yy, zz, xy, yz, xz = s.T
    mises = np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * (xy**2 + yz**2 + xz**2))
    assert np.allclose(mises, fields.point_data["von_mises"], rtol=1e-9)
    assert (tmp_path / "out" / "report.json").is_file()
    assert not np.any(np.isnan(result.contact["z"]))


def test_the_reader_agrees_with_meshio():
    meshio = pytest.importorskip("meshio")
    result = fetifeti.solve(SCENES / "blocks_3d.toml")
    theirs, ours = meshio.read(result.directory / "solution.vtu"), result.fields
    assert np.array_equal(theirs.points, ours.points)
    assert np.array_equal(theirs.cells[0].data, ours.cells()[12])
    assert set(theirs.point_data) == set(ours.point_data)
    for name, values in theirs.point_data.items():
        assert np.array_equal(values, ours.point_data[name])
    for name, values in theirs.cell_data.items():
        assert np.array_equal(np.concatenate(values), ours.cell_data[name])


@pytest.mark.parametrize("scene", ["scenes/blocks_3d", "scenes/poisson_2x2", "gallery/pin_lug"])
def test_pyvista_gets_what_vtk_reads(scene):
    pyvista = pytest.importorskip("pyvista")
    result = fetifeti.solve(SOURCES / "examples" / f"{scene}.toml")
    theirs, ours = pyvista.read(result.directory / "solution.vtu"), result.to_pyvista()
    assert np.array_equal(theirs.points, ours.points)
    assert np.array_equal(theirs.cells, ours.cells) and np.array_equal(theirs.celltypes, ours.celltypes)
    assert set(theirs.array_names) == set(ours.array_names)
    assert all(np.array_equal(theirs[name], ours[name]) for name in theirs.array_names)


def test_no_mpi_in_this_process(tmp_path):
    import subprocess

    code = "import sys, fetifeti; fetifeti.solve(sys.argv[1]); assert 'petsc4py' not in sys.modules"
    subprocess.run([sys.executable, "-c", code, str(SCENES / "poisson_2x2.toml")], check=True)
