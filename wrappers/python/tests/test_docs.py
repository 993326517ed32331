"""The examples of docs/python.md run."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from fetifeti.scene import environment

SOURCES = Path(os.environ.get("FETIFETI_SOURCES") or Path(__file__).resolve().parents[3])
BLOCKS = re.findall(r"```python\n(.*?)```", (SOURCES / "docs" / "python.md").read_text(), re.S)


@pytest.mark.skipif(int(os.environ.get("OMPI_COMM_WORLD_SIZE", 1)) > 1, reason="they start processes of their own")
@pytest.mark.parametrize("block", range(4))
def test_example(block):
    run = [sys.executable, "-c", BLOCKS[block]]
    done = subprocess.run(run, cwd=SOURCES, env=environment(), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    out = done.stdout
    assert out.strip(), "it prints something"
    if block == 3:
        # The closed form: the pull less what the bar takes at the gap.
        assert out.startswith("True") and "[0.9375]" in out


def test_there_are_four():
    assert len(BLOCKS) == 4
