# SPDX-License-Identifier: Apache-2.0
"""A test's end of a console."""

from __future__ import annotations

import os
import select
import subprocess
from pathlib import Path

from tests.waiting import until

PATIENCE = 20.0  # seconds to wait for an answer, on a machine that also runs other programs


class Lines:
    """Lines that are written to one file descriptor and read from another."""

    def __init__(self, read: int, write: int) -> None:
        self._read, self._write = read, write
        self._text = b""
        self.lines: list[str] = []

    def send(self, text: str | bytes) -> None:
        data = text.encode() if isinstance(text, str) else text
        while data:
            select.select([], [self._write], [], PATIENCE)
            data = data[os.write(self._write, data[:4096]) :]

    def receive(self, seconds: float) -> list[str]:
        """The lines that arrive; returns after that time without a byte, or as soon as there are some."""
        found: list[str] = []
        while not found and select.select([self._read], [], [], seconds)[0]:
            data = os.read(self._read, 65536)
            if not data:
                break
            self._text += data
            *whole, self._text = self._text.split(b"\n")
            found = [line.decode("ascii").rstrip("\r") for line in whole]
        self.lines += found
        return found

    def until(self, *beginnings: str) -> list[str]:
        """The lines up to and including the first that begins with one of ``beginnings``."""

        def came() -> list[str]:
            for number, line in enumerate(self.lines):
                if line.startswith(beginnings):
                    got = self.lines[: number + 1]
                    del self.lines[: number + 1]
                    return got
            self.receive(0.5)
            return []

        return until(came, lambda: f"no line begins with {beginnings}: {self.lines}", pause=0.0)

    def ask(self, command: str) -> list[str]:
        """The answer to a command, whose first word names the answer; other lines are skipped."""
        word = command.split()[0]
        self.send(command + "\n")
        word = "setpoint" if "=" in word else word
        got = self.until(f"ok {word}", f"error {word}")
        return [line for line in got if not line.startswith(("watch ", "state ", "ready "))]


class Host(Lines):
    """A host executable whose console is its standard input and output."""

    def __init__(self, program: Path, *options: str) -> None:
        command = [str(program), "--realtime", "--console", *options]
        self.process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            bufsize=0,
            cwd=program.parent,
        )
        assert self.process.stdin is not None and self.process.stdout is not None
        super().__init__(self.process.stdout.fileno(), self.process.stdin.fileno())
        self.until("ready ")

    def close(self) -> tuple[int, str]:
        """Ends its input; returns the exit status and stderr."""
        assert self.process.stdin is not None and self.process.stderr is not None
        self.process.stdin.close()
        status = self.process.wait(PATIENCE)
        return status, self.process.stderr.read().decode()

    def __enter__(self) -> Host:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()


def values(line: str) -> dict[str, float]:
    """The numbers in ``watch 0.033 name=value ...``, by name."""
    return {name: float(value) for name, value in (word.split("=") for word in line.split()[2:])}


def stat(lines: list[str], name: str) -> str:
    """One value of the answer to ``stats``."""
    found = [word for line in lines for word in line.split() if word.startswith(f"{name}=")]
    assert len(found) == 1, (name, lines)
    return found[0].partition("=")[2]
