"""The steps of a running program, from its checkpoints.

A checkpoint is written anew after every step of the contact loop, as a whole or not at all, and has the records of all
steps before it. So none is missed, however seldom one looks. The file begins as src/checkpoint says: a word, the
version (u32), the length (u64), then in the format "postcard" a title, the scene's fingerprint, the load step, and the
records as JSON.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

_MAGIC = b"fetifeti checkpoint\n"
_VERSION = 3


class Steps:
    """Passes steps on to a callback, each once."""

    def __init__(self, checkpoint: Path, on_step: Callable[[dict[str, Any]], Any]) -> None:
        self._checkpoint, self._on_step = checkpoint, on_step
        self._seen: Any = None
        self._done = 0

    def look(self) -> None:
        """Passes on what is new in the checkpoint."""
        try:
            now = self._checkpoint.stat()
            if (now.st_ino, now.st_mtime_ns) == self._seen:
                return
            self._seen = now.st_ino, now.st_mtime_ns
            content = self._checkpoint.read_bytes()
        except FileNotFoundError:
            return
        # Empty while the program tests that it can write there.
        if content:
            self.rest(records(content)["outer"])

    def rest(self, steps: list[dict[str, Any]]) -> None:
        """Passes on those of all steps so far that were not yet."""
        for step in steps[self._done :]:
            self._done += 1
            self._on_step(step)


def records(content: bytes) -> dict[str, Any]:
    """The records of a checkpoint: ``outer``, the steps of the contact loop, and ``load_steps``.

    Raises
    ------
    ValueError
        It is none, or has another version.
    """
    if not content.startswith(_MAGIC):
        raise ValueError("the file is no checkpoint of fetifeti")
    at = len(_MAGIC)
    version = int.from_bytes(content[at : at + 4], "little")
    if version != _VERSION:
        raise ValueError(f"the checkpoint has version {version}, expected {_VERSION}: program and package differ")
    at += 12

    def number() -> int:
        """Seven bits in each byte, the lowest first."""
        nonlocal at
        value = shift = 0
        while True:
            byte = content[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    title = number()
    at += title
    _scene, _load_step, length = number(), number(), number()
    return json.loads(content[at : at + length])
