# SPDX-License-Identifier: Apache-2.0
"""`epg connect` as a separate program, started by any command, until it prints its address."""

from __future__ import annotations

import os
import re
import signal
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from tests.connect.page import Page


@contextmanager
def started(command: Sequence[str], folder: Path | None = None) -> Iterator[tuple[Page, subprocess.Popen[str]]]:
    """Runs ``command`` in its own process group, as a shell does, without a browser."""
    hidden = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
    environment = {name: value for name, value in os.environ.items() if name not in hidden}
    process = subprocess.Popen(
        command,
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=environment,
        start_new_session=True,
    )
    assert process.stdout is not None
    said = ""
    try:
        for line in process.stdout:
            said += line
            if match := re.search(r"http://127\.0\.0\.1:\d+/#\S+", line):
                yield Page(match[0]), process
                return
        raise AssertionError(said)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        process.stdout.close()


def generate(page: Page, seconds: float = 120) -> dict[str, object]:
    """Builds and waits for the end; returns the build's report."""
    page.generate()
    state = page.until(lambda state: state["build"]["state"] not in ("idle", "running"), seconds)
    return dict(state["build"])
