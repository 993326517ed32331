"""Where the library and the program are."""

from __future__ import annotations

import ctypes
import os
import shutil
import struct
import subprocess
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

from ._version import ABI, VERSION

LIBRARY = "libfetifeti.so"
STEP_LIBRARY = "libfetifeti_step.so"
"""The load steps of scenes; it lies beside the other one."""
PROGRAM = "fetifeti"


class NotFoundError(ImportError):
    """The library or the program is nowhere, or what is there does not fit this package."""


def find_library() -> Path:
    """Finds ``libfetifeti.so``.

    Looked at in this order, and the first file counts: the environment variable ``FETIFETI_LIBRARY``, the package
    itself, what pkg-config knows, the prefix of the program on ``PATH``, the source tree's ``target/release``.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    NotFoundError
        There is none; the sentence names all places.
    """
    return _first(LIBRARY, [_package, _pkg_config, _path, _source])


def find_program() -> Path:
    """Finds the program ``fetifeti``, as `find_library` finds the library, with ``FETIFETI_PROGRAM``.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    NotFoundError
        There is none; the sentence names all places.
    """
    return _first(PROGRAM, [_package, _pkg_config, _path, _source])


def find_installed(file: str) -> Path:
    """Finds a file that was installed apart from this package and its sources.

    Raises
    ------
    NotFoundError
        There is none.
    """
    return _first(file, [_pkg_config, _path])


def source_tree() -> Path | None:
    """The root of the source tree that this package lies in, if it was not installed elsewhere."""
    here = Path(__file__).resolve()
    root = here.parents[4] if len(here.parents) > 4 else here.parent
    return root if (root / "Cargo.toml").is_file() and (root / "wrappers" / "fetifeti.h").is_file() else None


def _package(file: str) -> tuple[str, Path | None]:
    """A place to look at, and the file that would be there; None where there is no such place."""
    return "the package", Path(__file__).resolve().parent / file


def _pkg_config(file: str) -> tuple[str, Path | None]:
    name = "pkg-config fetifeti"
    try:
        def ask(flag: str) -> str:
            out = subprocess.run(["pkg-config", flag, "fetifeti"], capture_output=True, text=True, check=True)
            return out.stdout.strip()

        version = ask("--modversion")
        if not _fits(version):
            return f"{name} of version {version}, not {VERSION}", None
        plugin = file == LIBRARY
        return name, Path(ask("--variable=plugin")) if plugin else Path(ask("--variable=prefix")) / "bin" / file
    except (OSError, subprocess.CalledProcessError):
        return name, None


def _path(file: str) -> tuple[str, Path | None]:
    found = shutil.which(PROGRAM)
    program = Path(found) if found else None
    if file == PROGRAM:
        return "PATH", program
    return f"the prefix of '{PROGRAM}' on PATH", program and program.resolve().parents[1] / "lib" / file


def _source(file: str) -> tuple[str, Path | None]:
    tree = source_tree()
    target = Path(os.environ.get("CARGO_TARGET_DIR") or (tree or Path()) / "target")
    return "the source tree", target / "release" / file if tree else None


def _first(file: str, places: list[Callable[[str], tuple[str, Path | None]]]) -> Path:
    what = "library" if file == LIBRARY else "program"
    variable = f"FETIFETI_{what.upper()}"
    given = os.environ.get(variable)
    if given:
        # Whoever names a file does not want another one.
        if Path(given).is_file():
            return Path(given)
        raise NotFoundError(f"{variable} is '{given}', expected the file of the {what} '{file}'")
    looked = [f"{variable} (not set)"]
    for place in places:
        name, path = place(file)
        if path is not None and path.is_file():
            return path
        looked.append(f"{name} ({path or 'nothing'})")
    raise NotFoundError(
        f"fetifeti's {what} '{file}' is in none of these places: {'; '.join(looked)}. "
        f"Run 'make install PREFIX=...' in fetifeti's sources, and put PREFIX/bin into PATH, "
        f"PREFIX/lib/pkgconfig into PKG_CONFIG_PATH, or the path of the file into {variable}"
    )


def _fits(version: str) -> bool:
    """Whether a version has the first two numbers of ours."""
    return version.split(".")[:2] == VERSION.split(".")[:2]


@lru_cache(maxsize=None)
def load(file: str = LIBRARY) -> ctypes.PyDLL:
    """Loads the library of this name, once.

    Raises
    ------
    NotFoundError
        It is not there, the loader refuses it, or it has another interface.
    """
    path = find_library()
    if file != LIBRARY:
        path = path.with_name(file)
        if not path.is_file():
            raise NotFoundError(f"{path} is not there, expected it beside {LIBRARY}: 'make install' brings both")
    name = soname(path)
    expected = f"{file}.{ABI}"
    if name != expected:
        raise NotFoundError(f"{path} calls itself '{name}', expected '{expected}': this package is version {VERSION}")
    try:
        # PyDLL and not CDLL: petsc4py's error handler and its printing run Python, and rely on the interpreter's lock.
        return ctypes.PyDLL(str(path))
    except OSError as error:
        raise NotFoundError(f"{path} cannot be loaded: {error}") from error


def soname(path: Path) -> str | None:
    """The name by which the loader knows a shared library (ELF, 64 bits, little-endian).

    Raises
    ------
    NotFoundError
        The file is no such library.
    """
    try:
        with open(path, "rb") as file:
            head = file.read(64)
            if len(head) < 64 or head[:6] != b"\x7fELF\x02\x01":
                raise NotFoundError(f"{path} is no shared library of 64 bits")
            start, size, count = *struct.unpack_from("<Q", head, 40), *struct.unpack_from("<HH", head, 58)
            file.seek(start)
            table = file.read(size * count)
            for at in range(0, size * count, size):
                if struct.unpack_from("<I", table, at + 4)[0] != 6:  # SHT_DYNAMIC
                    continue
                offset, length = struct.unpack_from("<QQ", table, at + 24)
                names = size * struct.unpack_from("<I", table, at + 40)[0]
                (strings,) = struct.unpack_from("<Q", table, names + 24)
                file.seek(offset)
                for tag, value in struct.iter_unpack("<qQ", file.read(length)):
                    if tag == 14:  # DT_SONAME
                        file.seek(strings + value)
                        return file.read(256).split(b"\0")[0].decode()
    except (OSError, struct.error) as error:
        raise NotFoundError(f"{path} cannot be read as a shared library: {error}") from error
    return None
