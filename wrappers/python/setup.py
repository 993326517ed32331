"""Puts the library into the package where none is installed: copied from the source tree, or built there by cargo.

FETIFETI_BUNDLE=0 in the environment: never; 1: also where a library is installed. Everything else is in pyproject.toml.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE / "src"))
from fetifeti.library import LIBRARY, PROGRAM, STEP_LIBRARY, NotFoundError, find_installed  # noqa: E402


def bundled() -> bool:
    """Whether the library goes into the package."""
    asked = os.environ.get("FETIFETI_BUNDLE")
    if asked in ("0", "1"):
        return asked == "1"
    if not (ROOT / "Cargo.toml").is_file() or not (ROOT / "wrappers" / "fetifeti.h").is_file():
        return False
    try:
        find_installed(LIBRARY)
        return False
    except NotFoundError:
        return built(LIBRARY).is_file() or shutil.which("cargo") is not None


def built(file: str) -> Path:
    """Where cargo puts a file."""
    return Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target") / "release" / file


def without_paths(file: Path) -> None:
    """Removes the directories of the crates and of the build, which panics name, as scripts/install.sh does.

    Each becomes "./////" of the same length, so that nothing moves."""
    cargo = Path(os.environ.get("CARGO_HOME") or Path.home() / ".cargo")
    text = file.read_bytes()
    for place in (ROOT / "vendor", cargo / "registry", built(LIBRARY).parents[1]):
        path = os.fsencode(place.absolute())
        text = text.replace(path + b"/", b"." + b"/" * len(path))
    file.write_bytes(text)


class Build(build_py):
    """Copies the Python sources, and the library if it is wanted.

    So are the program and the library of load steps, if cargo has made them."""

    def run(self) -> None:
        super().run()
        if not bundled():
            return
        if not built(LIBRARY).is_file():
            # The others need more than the library: `make install` makes all.
            cargo = ["cargo", "build", "--release", "--package", "fetifeti"]
            subprocess.run(cargo, cwd=ROOT, check=True)
        for file in (LIBRARY, STEP_LIBRARY, PROGRAM):
            if built(file).is_file():
                to = Path(self.build_lib) / "fetifeti" / file
                shutil.copy2(built(file), to)
                if shutil.which("strip"):
                    subprocess.run(["strip", "--strip-unneeded", str(to)], check=True)
                without_paths(to)


class Platform(Distribution):
    """A package with a library fits one kind of machine."""

    def has_ext_modules(self) -> bool:
        return bundled()


setup(cmdclass={"build_py": Build}, distclass=Platform)
