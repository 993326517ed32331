"""The steps of a running program, from its events: a file with a line of JSON for each, written when the step ends."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any


class Steps:
    """Passes steps on to a callback, each once."""

    def __init__(self, events: Path, on_step: Callable[[dict[str, Any]], Any]) -> None:
        self._events, self._on_step = events, on_step
        self._read = 0

    def look(self) -> None:
        """Passes on what is new in the file."""
        try:
            with self._events.open("rb") as file:
                file.seek(self._read)
                new = file.read()
        except FileNotFoundError:
            return
        # The last line may be under way.
        whole = new[: new.rfind(b"\n") + 1]
        self._read += len(whole)
        for line in whole.splitlines():
            self._on_step(json.loads(line))
