# SPDX-License-Identifier: Apache-2.0
"""The command file that 20-sim starts after an export, run by Wine's command interpreter."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.twenty_sim.generate import FOLDER
from tests.waiting import until

NAME = "open_in_epg.cmd"
needs_wine = pytest.mark.skipif(
    shutil.which("wine") is None, reason="Wine is not installed: sudo apt install --no-install-recommends wine wine64"
)


def windows(path: Path) -> str:
    return "Z:" + str(path).replace("/", "\\")


class Computer:
    """Windows, with programs that record their arguments."""

    def __init__(self, folder: Path) -> None:
        self.notes = folder / "notes.txt"
        self.programs = folder / "my programs"
        self.programs.mkdir(parents=True)
        self.export = folder / "My (x86) exports & more" / "100% $(HOME) %PATH% ^ ! Servo (1)"
        self.export.mkdir(parents=True)
        shutil.copy(FOLDER / NAME, self.export)
        self.environment = {**os.environ, "WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all"}
        self.environment.pop("XXSIM_SCRIPT_MODE", None)

    def install(self, program: str, first_words: str, folder: Path | None = None) -> None:
        """A program that acts only if its first arguments are ``first_words``."""
        checks = "".join(f'if not "%{i}"=="{word}" exit /b 1\r\n' for i, word in enumerate(first_words.split(), 1))
        text = f"@echo off\r\n{checks}echo {program} %*>> {windows(self.notes)}\r\nexit /b 0\r\n"
        ((folder or self.programs) / f"{program}.bat").write_bytes(text.encode())

    def run(
        self, *arguments: str, script: bool = False, folder: Path | None = None
    ) -> subprocess.CompletedProcess[str]:
        environment = {**self.environment, "WINEPATH": windows(self.programs)}
        if script:
            environment["XXSIM_SCRIPT_MODE"] = "1"
        name = NAME if folder is None else windows(self.export / NAME)
        command = ["wine", "cmd", "/c", name, *arguments]
        return subprocess.run(
            command,
            cwd=folder or self.export,
            env=environment,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )

    def noted(self) -> list[str]:
        """The recorded calls of programs, without the checks that they exist."""
        text = self.notes.read_text() if self.notes.exists() else ""
        return [line.strip() for line in text.splitlines() if "--version" not in line]


@pytest.fixture
def computer(tmp_path: Path) -> Iterator[Computer]:
    made = Computer(tmp_path)
    yield made
    subprocess.run(["wineserver", "-k"], env=made.environment, check=False)


@needs_wine
def test_epg_is_started_for_the_folder_of_the_export(computer: Computer) -> None:
    done = computer.run(script=True)
    assert done.returncode == 4 and "EPG is not installed" in done.stdout
    assert '  py -m pip install "folder of EPG"\n' in done.stdout.replace("\r", "")
    (home,) = (each for each in (computer.programs.parent / "wine/drive_c/users").iterdir() if each.name != "Public")
    scripts = home / "epg-environment/Scripts"
    scripts.mkdir(parents=True)
    computer.install("epg", "", scripts)
    assert computer.run(script=True).returncode == 0
    assert computer.noted() == ['epg exported "."']
    computer.notes.unlink()
    computer.install("py", "-3 -m epg")
    assert computer.run(script=True).returncode == 0
    assert computer.noted() == ['py -3 -m epg exported "."']
    computer.install("epg", "")
    assert computer.run("window").returncode == 0
    assert computer.noted()[1:] == ['epg exported "." --connect']  # in a window that the user sees
    assert computer.run().returncode == 0  # this opens a window and does not wait for it
    until(lambda: len(computer.noted()) > 2, seconds=60)
    assert computer.noted()[2:] == ['epg exported "." --connect']


@needs_wine
def test_the_folder_is_the_one_of_the_file(computer: Computer) -> None:
    """Independent of the current folder.  Wine, unlike Windows, expands %PATH% in a name: there is none here."""
    top = computer.programs.parent / "exports"
    top.mkdir()
    computer.export = Path(shutil.move(computer.export, top / "Servo $ 1"))
    computer.install("epg", "")
    program = computer.programs / "epg.bat"
    program.write_bytes(
        program.read_bytes().replace(b"echo epg", b"cd >> " + windows(computer.notes).encode() + b"\r\necho epg")
    )
    assert computer.run(script=True, folder=computer.programs).returncode == 0
    assert computer.noted()[-2:] == [windows(computer.export), 'epg exported "."']
