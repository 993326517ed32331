"""How the library is found, and what is said if it is not."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import fetifeti
from fetifeti import _version, library

SOURCES = Path(os.environ.get("FETIFETI_SOURCES") or Path(__file__).resolve().parents[3])


@pytest.fixture
def nowhere(monkeypatch, tmp_path):
    """A machine on which nothing is installed."""
    for name in ("FETIFETI_LIBRARY", "FETIFETI_PROGRAM", "PKG_CONFIG_PATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("PKG_CONFIG_LIBDIR", str(tmp_path))
    monkeypatch.setenv("PATH", "/usr/bin:/bin")
    monkeypatch.setattr(library, "source_tree", lambda: None)
    monkeypatch.setattr(library, "__file__", str(tmp_path / "library.py"))
    return tmp_path


def test_version_is_that_of_the_header():
    header = (SOURCES / "wrappers" / "fetifeti.h").read_text()
    numbers = [re.search(rf"#define FETIFETI_VERSION_{n}\s+(\d+)", header)[1] for n in ("MAJOR", "MINOR", "SUBMINOR")]
    assert fetifeti.__version__ == ".".join(numbers)


def test_abi_is_that_of_the_library():
    assert f"ABI: u32 = {_version.ABI};" in (SOURCES / "packaging" / "abi.rs").read_text()
    for file in (library.LIBRARY, library.STEP_LIBRARY):
        assert library.soname(library.find_library().with_name(file)) == f"{file}.{_version.ABI}"


def test_every_function_of_the_header_is_called():
    from fetifeti.calls import SIGNATURES, STEP_SIGNATURES

    for path, create, signatures in (
        ("fetifeti.h", "FetiFetiCreate", SIGNATURES),
        ("step/fetifeti_step.h", "FetiFetiStepCreate", STEP_SIGNATURES),
    ):
        header = (SOURCES / "wrappers" / path).read_text()
        functions = re.findall(r"PETSC_EXTERN PetscErrorCode (\w+)\((.*?)\);", header, re.S)
        of_python = {name: len(arguments) for name, arguments in signatures.items()}
        of_c = {name: 0 if given == "void" else given.count(",") + 1 for name, given in functions}
        of_c.pop(create)  # its communicator is no integer; Python has that of Fortran
        assert of_python == of_c


def test_all_places_are_named(nowhere):
    with pytest.raises(fetifeti.NotFoundError) as caught:
        fetifeti.find_library()
    for word in ["FETIFETI_LIBRARY", "package", "pkg-config", "PATH", "source tree", "make install", str(nowhere)]:
        assert word in str(caught.value)
    with pytest.raises(fetifeti.NotFoundError, match="program 'fetifeti' is in none"):
        fetifeti.find_program()


def test_where_petsc4py_is_missing():
    code = "import sys; sys.modules['petsc4py'] = None; import fetifeti; fetifeti.register()"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "NotFoundError: fetifeti.register needs petsc4py" in out.stderr and "PYTHONPATH=" in out.stderr


def test_a_wrong_name_is_not_replaced(nowhere, monkeypatch):
    monkeypatch.setenv("FETIFETI_LIBRARY", "/nowhere/libfetifeti.so")
    with pytest.raises(fetifeti.NotFoundError, match="FETIFETI_LIBRARY is '/nowhere/libfetifeti.so'"):
        fetifeti.find_library()


def test_order_of_the_places(nowhere, monkeypatch):
    prefix = nowhere / "prefix"
    for file in ("lib/libfetifeti.so", "bin/fetifeti"):
        (prefix / file).parent.mkdir(parents=True)
        (prefix / file).write_bytes(b"")
    (prefix / "bin/fetifeti").chmod(0o755)
    monkeypatch.setenv("PATH", f"{prefix}/bin:/usr/bin:/bin")
    assert fetifeti.find_library() == prefix / "lib/libfetifeti.so"
    assert fetifeti.find_program() == prefix / "bin/fetifeti"
    other = nowhere / "other/lib/libfetifeti.so"
    other.parent.mkdir(parents=True)
    other.write_bytes(b"")
    known = "prefix={0}\nplugin={0}/lib/libfetifeti.so\nName: f\nDescription: f\nVersion: {1}\n"
    (nowhere / "fetifeti.pc").write_text(known.format(nowhere / "other", fetifeti.__version__))
    assert fetifeti.find_library() == other
    (nowhere / "fetifeti.pc").write_text(known.format(nowhere / "other", "9.9.0"))
    assert fetifeti.find_library() == prefix / "lib/libfetifeti.so"
    (nowhere / "libfetifeti.so").write_bytes(b"")
    assert fetifeti.find_library() == nowhere / "libfetifeti.so"


def test_files_that_are_no_library_of_ours_are_refused(nowhere, monkeypatch):
    (nowhere / "text").write_text("no library")
    with pytest.raises(fetifeti.NotFoundError, match="no shared library"):
        library.soname(nowhere / "text")
    monkeypatch.setenv("FETIFETI_LIBRARY", str(nowhere / "text"))
    with pytest.raises(fetifeti.NotFoundError, match="libfetifeti_step.so is not there, expected it beside"):
        library.load.__wrapped__(library.STEP_LIBRARY)
    other = next(Path("/lib").glob("*/libc.so.6"), None)
    if other is not None:
        monkeypatch.setenv("FETIFETI_LIBRARY", str(other))
        with pytest.raises(fetifeti.NotFoundError, match="calls itself 'libc.so.6', expected 'libfetifeti.so.0'"):
            library.load.__wrapped__()
