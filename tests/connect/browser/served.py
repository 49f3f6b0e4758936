"""``epg connect`` as a user starts it, and what it says over HTTP.

>>> # with Served(folder) as epg: epg.address, epg.state(), epg.act("undo")
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any

ROOT = Path(__file__).resolve().parents[3]


class Served:
    """A process that serves the page: for a folder with a project or a bare model, or for what options name."""

    def __init__(self, *arguments: Path | str) -> None:
        command = [sys.executable, "-m", "epg", "connect", *map(str, arguments), "--no-browser"]
        packages = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(packages), "EPG_PATH": str(ROOT)}
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, encoding="utf-8", env=environment)
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        assert line.startswith("epg connect: http://127.0.0.1:"), line
        self.address = line.split()[-1]

    def __enter__(self) -> Served:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()

    def end(self) -> None:
        """As Ctrl-C does."""
        self._process.terminate()
        self._process.wait(timeout=10)
        assert self._process.stdout is not None
        self._process.stdout.close()

    def wait(self) -> int:
        """The exit code of a process that ends by itself."""
        return self._process.wait(timeout=10)

    def state(self) -> dict[str, Any]:
        with urllib.request.urlopen(f"{self.address}api/state?after=0", timeout=30) as answer:
            state: dict[str, Any] = json.loads(answer.read())
        return state

    def act(self, action: str, **body: Any) -> dict[str, Any]:
        request = urllib.request.Request(
            f"{self.address}api/{action}", json.dumps(body).encode(), {"Content-Type": "application/json"}
        )
        with urllib.request.urlopen(request, timeout=30) as answer:
            state: dict[str, Any] = json.loads(answer.read())
        return state

    def until(self, reached: Callable[[dict[str, Any]], bool], seconds: float = 20) -> dict[str, Any]:
        """The first state that is as wanted."""
        end = time.monotonic() + seconds
        while True:
            state = self.state()
            if reached(state):
                return state
            assert time.monotonic() < end, state
            time.sleep(0.1)
