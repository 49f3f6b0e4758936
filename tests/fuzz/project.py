# SPDX-License-Identifier: Apache-2.0
"""A project in its own folder, a run of EPG on it in this process, and the promises that hold for all files.

:meth:`Project.generate` asserts after every run that EPG ends in time, with status 0 (and no error) or 1 (and at least
one error with a position); that there is no traceback; that nothing outside the output folder has changed; that a run
that fails leaves the output folder unchanged; that a run that succeeds leaves exactly the files it lists, complete and
in UTF-8.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shutil
import signal
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from epg.cli.main import main

OUTPUT = "output"
MESSAGE = re.compile(r"(?P<place>.+?)(?::\d+(?::\d+)?)?: (?P<severity>error|warning): (?P<text>.+) \[[a-z0-9.-]+\]")
_EXCERPT = re.compile(r" *\d* \| |hint: |.+: note: ")
_OWN = {".epg-outputs.json", ".epg-warnings.txt"}


@dataclass(frozen=True)
class Outcome:
    """The result of a run of EPG; ``files`` are those of the output folder."""

    status: int
    printed: str
    messages: str
    files: Mapping[str, str]

    @property
    def good(self) -> bool:
        return self.status == 0

    @property
    def errors(self) -> list[str]:
        return [line for line in self.messages.splitlines() if ": error: " in line]


class TookTooLong(BaseException):
    """EPG computes for too long.  EPG has no exception handler that catches this class."""


class Project:
    """The files of one project and the command that generates from them, with paths relative to the folder.

    ``arguments`` are those of ``epg generate``; if ``--tcf`` is not among them, those of ``epg generate-model``.
    """

    def __init__(self, folder: Path, files: Mapping[str, bytes], arguments: Sequence[str], name: str = "robot") -> None:
        self.folder = folder
        self.name = name
        self.command = ["generate" if "--tcf" in arguments else "generate-model", name, *arguments]
        self.files = dict(files)
        if folder.exists():
            shutil.rmtree(folder)
        for file, data in files.items():
            path = folder / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)

    def generate(self, seconds: float = 10.0, targets: str = "") -> Outcome:
        """Runs ``epg generate`` in the folder and checks the promises that this module's docstring lists."""
        before = _tree(self.folder)
        command = [*self.command, "--output", OUTPUT, "--source-dir", str(self.folder)]
        status, printed, messages = run_epg(command, self.folder, seconds, targets)
        after = _tree(self.folder)
        told = f"status {status}\n{messages[-4000:]}"
        assert status in (0, 1), told
        assert "Traceback" not in messages, told
        check_messages(messages)
        inside = f"{OUTPUT}/"
        assert {k: v for k, v in after.items() if not k.startswith(inside)} == {
            k: v for k, v in before.items() if not k.startswith(inside)
        }, told
        if status == 1:
            assert any(": error: " in line for line in messages.splitlines()), told
            assert after == before, told
            return Outcome(status, printed, messages, {})
        assert ": error: " not in messages, told
        files = {k.removeprefix(inside): v.decode("utf-8") for k, v in after.items() if k.startswith(inside)}
        listed = set(json.loads(files[".epg-outputs.json"]))
        assert files.keys() - _OWN == listed, told
        for file, text in files.items():
            if file.endswith(".json"):
                json.loads(text, parse_constant=_refuse)
        return Outcome(status, printed, messages, files)


def project_files(folder: Path, inside: str = "") -> dict[str, bytes]:
    """All files below ``folder`` by their path, which begins with ``inside``."""
    return {
        (Path(inside) / path.relative_to(folder)).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def run_epg(command: Sequence[str], folder: Path, seconds: float, targets: str = "") -> tuple[int, str, str]:
    """Status, output and messages of ``epg`` in ``folder``.  Raises TookTooLong if it takes more than ``seconds``."""
    output, messages = io.StringIO(), io.StringIO()
    here = Path.cwd()
    os.environ["EPG_TARGETS_PATH"] = targets
    os.chdir(folder)
    try:
        with time_limit(seconds), contextlib.redirect_stdout(output), contextlib.redirect_stderr(messages):
            status = main(list(command))
    finally:
        os.chdir(here)
        del os.environ["EPG_TARGETS_PATH"]
    return status, output.getvalue(), messages.getvalue()


def check_messages(messages: str) -> None:
    """Each line belongs to a diagnostic and is printable; a diagnostic begins with a position and ends with its id."""
    for line in messages.split("\n"):
        assert all(char.isprintable() or char == "\t" for char in line), line
        assert not line or MESSAGE.fullmatch(line) or _EXCERPT.match(line), line


@contextlib.contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raises :class:`TookTooLong` in the block after so many seconds of processor time, independent of the load."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def expired(_number: int, _frame: object) -> None:
        raise TookTooLong(f"EPG took longer than {seconds} s")

    previous = signal.signal(signal.SIGPROF, expired)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, previous)


def _tree(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not path.is_symlink()
    }


def _refuse(constant: str) -> object:
    raise AssertionError(f"{constant} is no JSON")
