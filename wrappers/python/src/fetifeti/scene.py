"""Scenes: the program ``fetifeti`` solves a scene file, and what it writes comes back as arrays.

The program runs beside this process, with MPI of its own: nothing here starts MPI, or prints, but `Scene.steps`, which
solves in this process.
"""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .library import find_program
from .progress import Steps
from .vtu import Fields, read_vtu

if TYPE_CHECKING:
    from .steps import LoadStep, LoadSteps

OnStep = Callable[[dict[str, Any]], Any]
"""Gets the record of a step of the contact loop: an entry of ``report["contact"]["steps"]``."""


class SceneError(RuntimeError):
    """The program ended with an error; the message is its sentence.

    Attributes
    ----------
    code : int
        Its exit code.
    """

    def __init__(self, sentence: str, code: int) -> None:
        super().__init__(sentence)
        self.code = code


class NotConvergedError(SceneError):
    """Exit code 1: not converged.

    Attributes
    ----------
    result : Result or None
        What was written: partial.
    step : LoadStep or None
        Of `Scene.steps`: the load step as it is.
    """

    result: Result | None = None
    step: LoadStep | None = None


class InputError(SceneError, ValueError):
    """Exit code 2: the scene or an option is wrong."""


class ProgramError(SceneError):
    """Exit code 3, or any other: PETSc, MPI, the disk."""


_ERRORS: dict[int, type[SceneError]] = {1: NotConvergedError, 2: InputError}


class Step:
    """A load step: its record in the report, and its fields, read when they are first asked for."""

    def __init__(self, t: float, path: Path, files: Any) -> None:
        self.t = t
        """The load parameter."""
        self._path, self._files = path, files

    @cached_property
    def fields(self) -> Fields:
        """Displacements, stress and contact at the end of this step."""
        return read_vtu(self._path)


class Result:
    """What a solve of a scene wrote. Files in a temporary directory live as long as this object and its steps.

    Attributes
    ----------
    directory : Path
        The program's files: pictures, tables, fields for ParaView.
    """

    def __init__(self, directory: Path, files: Any = None) -> None:
        self.directory = directory
        self._files = files

    @cached_property
    def report(self) -> dict[str, Any]:
        """The report of the program (report.json): sizes, iterations, contact, energy, seconds."""
        return json.loads((self.directory / "report.json").read_text())

    @cached_property
    def fields(self) -> Fields:
        """The fields at the end."""
        return read_vtu(self.directory / "solution.vtu")

    @cached_property
    def steps(self) -> list[Step]:
        """The load steps with their fields; empty for a scene without."""
        index = self.directory / "solution.pvd"
        if not index.is_file():
            return []
        import xml.etree.ElementTree as ElementTree

        sets = ElementTree.parse(index).getroot().iter("DataSet")
        return [Step(float(s.get("timestep", 0)), self.directory / s.get("file", ""), self._files) for s in sets]

    @cached_property
    def contact(self) -> np.ndarray:
        """The rows of all interfaces (interfaces.csv), a structured array; empty without interfaces.

        Fields: ``name`` of the interface, ``t`` the load, the place ``x``, ``y``, in space ``z``, ``gap`` (a length),
        ``multiplier`` (a force), ``active`` (bool), and where faces have areas ``pressure`` and ``area``, else nan.
        """
        path = self.directory / "interfaces.csv"
        if not path.is_file():
            return np.zeros(0, [("name", "U1")])
        with open(path, newline="") as file:
            head, *rows = csv.reader(file)
        columns = list(zip(*rows)) or [()] * len(head)
        types = {"name": f"U{max(map(len, columns[0]), default=1)}", "active": "?"}
        out = np.zeros(len(rows), [(name, types.get(name, "f8")) for name in head])
        for name, column in zip(head, columns):
            if name == "name":
                out[name] = column
            elif name == "active":
                out[name] = [int(value) != 0 for value in column]
            else:
                out[name] = [float(value) if value else np.nan for value in column]
        return out

    @cached_property
    def contact_steps(self) -> np.ndarray:
        """The steps of the contact loop, a structured array: ``load_step``, ``step``, ``active``, ``iterations``, …"""
        return _table((self.report.get("contact") or {}).get("steps") or [])

    @cached_property
    def load_steps(self) -> np.ndarray:
        """The load steps, a structured array: ``t``, ``active``, ``energy``, ``contact_force``, ..."""
        return _table((self.report.get("contact") or {}).get("load_steps") or self.report.get("load_steps") or [])

    def to_pyvista(self) -> Any:
        """The fields at the end as a pyvista.UnstructuredGrid; see `Fields.to_pyvista`."""
        return self.fields.to_pyvista()


def _table(records: list[dict[str, Any]]) -> np.ndarray:
    """The plain numbers and words of records; nan where one is missing."""
    names = {name: value for record in records for name, value in record.items() if value is not None}
    kinds: list[tuple[str, Any]] = []
    for name, value in names.items():
        values = [record.get(name) for record in records]
        if isinstance(value, str):
            kinds.append((name, f"U{max(len(str(v or '')) for v in values)}"))
        elif isinstance(value, (int, float)):
            kinds.append((name, "i8" if all(isinstance(v, int) for v in values) else "f8"))
    out = np.zeros(len(records), kinds)
    for name, kind in kinds:
        missing: Any = "" if str(kind).startswith("U") else np.nan
        out[name] = [missing if record.get(name) is None else record[name] for record in records]
    return out


class Scene:
    """A scene: bodies, loads, contacts, as the language of examples/scenes says.

    Parameters
    ----------
    path : str or Path
        A file, TOML; files that it names lie beside it.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        # Where the text of `from_text` lies as long as the scene lives.
        self._files: tempfile.TemporaryDirectory[str] | None = None

    @classmethod
    def from_text(cls, text: str) -> Scene:
        """A scene that was put together here; files that it names need full paths."""
        files = tempfile.TemporaryDirectory(prefix="fetifeti-")
        scene = cls(Path(files.name) / "scene.toml")
        scene.path.write_text(text)
        scene._files = files
        return scene

    def solve(
        self,
        options: Mapping[str, Any] | None = None,
        ranks: int = 1,
        on_step: OnStep | None = None,
        *,
        out: str | Path | None = None,
    ) -> Result:
        """Solves the scene; see `solve`."""
        return solve(self.path, options, ranks, on_step, out=out)

    def steps(
        self,
        options: Mapping[str, Any] | None = None,
        comm: Any = None,
        *,
        resume: str | Path | None = None,
    ) -> LoadSteps:
        """Solves the load steps of the scene in this process, one after the other. Needs petsc4py. Collective.

        Parameters
        ----------
        options : dict, optional
            As in `solve`; they are put into PETSc's database, and stay there.
        comm : PETSc.Comm or mpi4py.MPI.Comm, optional
            The communicator; PETSc's world if it is left out.
        resume : str or Path, optional
            A file of `LoadStep.checkpoint` or of the program's ``--checkpoint``: the first step is the one after it.

        Returns
        -------
        LoadSteps
            An iterator over `LoadStep`: each is solved when it is asked for, from the end of the one before.

        Raises
        ------
        InputError
            The scene is wrong, or the file is no checkpoint of it.
        NotConvergedError
            A step has not converged, when it is asked for; no step follows. The error's ``step`` has it.
        ProgramError
            MPI, the disk.
        NotFoundError
            petsc4py or the library are nowhere.
        """
        import fetifeti

        return fetifeti.LoadSteps(self, options, comm, resume=resume)


def solve(
    scene: str | Path | Scene,
    options: Mapping[str, Any] | None = None,
    ranks: int = 1,
    on_step: OnStep | None = None,
    *,
    out: str | Path | None = None,
) -> Result:
    """Solves a scene with the program ``fetifeti`` and waits for it.

    Parameters
    ----------
    scene : str, Path or Scene
        The scene, a TOML file.
    options : dict, optional
        PETSc options without their hyphen, for example ``{"fetifeti_ksp_rtol": 1e-10}``; None for one without value.
    ranks : int
        Processes, under ``mpirun`` (or what ``FETIFETI_MPIRUN`` names) if there are several.
    on_step : callable, optional
        Called for each step of the contact loop, in order, with its record. It is called while the program runs, a
        tenth of a second late at most (the program's ``--events``); never for scenes without contact or obstacles. An
        exception in it ends the program.
    out : str or Path, optional
        Where the program writes; left out: in a temporary directory that goes with the result.

    Returns
    -------
    Result
        Report, fields, contact.

    Raises
    ------
    NotConvergedError, InputError, ProgramError
        What the program says.
    NotFoundError
        The program is nowhere.
    """
    if isinstance(scene, Scene):
        scene = scene.path
    if ranks < 1:
        raise ValueError(f"ranks is {ranks}, expected at least 1")
    files = tempfile.TemporaryDirectory(prefix="fetifeti-")
    directory = Path(files.name) / "out" if out is None else Path(out)
    events, said = Path(files.name) / "events", Path(files.name) / "stderr"
    command = [str(find_program()), "solve", str(scene), "--quiet", "--out", str(directory)]
    if on_step:
        command += ["--events", str(events)]
    command += list(_options(options or {}))
    if ranks > 1:
        command = [os.environ.get("FETIFETI_MPIRUN", "mpirun"), "-n", str(ranks), *command]
    steps = Steps(events, on_step) if on_step else None
    with open(said, "wb") as errors:
        code = _run(command, errors, steps)
    if steps:
        steps.look()
    result = Result(directory, files)
    if code in (0, 1) and (directory / "report.json").is_file():
        if code == 0:
            return result
    ours, sentence = _sentence(said.read_text(errors="replace"), code)
    # mpirun, too, ends with 1 where it cannot start the program.
    error = (_ERRORS.get(code, ProgramError) if ours else ProgramError)(sentence, code)
    if isinstance(error, NotConvergedError) and (directory / "report.json").is_file():
        error.result = result
    raise error


def _options(options: Mapping[str, Any]) -> Iterator[str]:
    """The options as arguments of a command."""
    for key, value in options.items():
        yield key if key.startswith("-") else f"-{key}"
        if isinstance(value, bool):
            yield str(value).lower()
        elif isinstance(value, (list, tuple)):
            yield ",".join(map(str, value))
        elif value is not None:
            yield str(value)


def _run(command: list[str], errors: Any, steps: Steps | None) -> int:
    """The exit code of a command that has a group of its own, which ends with this call whatever happens."""
    env = environment()
    if not shutil.which(command[0]):
        raise ProgramError(f"'{command[0]}' is not on PATH, expected MPI's program for several ranks", 3)
    process = subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=errors, stderr=errors, env=env, start_new_session=True
    )
    try:
        while True:
            try:
                return process.wait(0.05 if steps else None)
            except subprocess.TimeoutExpired:
                if steps:
                    steps.look()
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGTERM)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def environment() -> dict[str, str]:
    """The variables for a program with MPI of its own: those of a running MPI would mislead it."""
    theirs = ("PMIX_", "PMI_", "ORTE_", "OMPI_MCA_orte", "OMPI_MCA_ess", "OMPI_MCA_pmix", "OMPI_MCA_initial")
    settings = ("OMPI_ALLOW_", "OMPI_MCA_")
    env = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(theirs) and (name.startswith(settings) or not name.startswith("OMPI_"))
    }
    # More ranks than processors are wanted where the machine is small; idle ranks yield then.
    env.setdefault("OMPI_MCA_rmaps_base_oversubscribe", "1")
    env.setdefault("OMPI_MCA_mpi_yield_when_idle", "1")
    return env


def _sentence(text: str, code: int) -> tuple[bool, str]:
    """What was said on standard error: whether the program said it, and its sentence, or the last lines."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    ours = [line[len("Error: ") :] for line in lines if line.startswith("Error: ")]
    if ours:
        return True, ours[-1]
    return False, "\n".join(lines[-10:]) or f"the program ended with exit code {code} and said nothing"
