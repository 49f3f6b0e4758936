# SPDX-License-Identifier: Apache-2.0
"""The how-tos are correct: the tests write their files and run their commands exactly as printed there.

A block after a line that ends in "`path`:" is that file.  In a ``console`` block, a line ``$ command`` is run, and the
lines after it are its output; a line ``...`` matches any lines.  A ``session`` block is a dialogue with the console.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.emulator.toolchain import arm_gcc, pico_sdk, skip_if_missing, tool
from tests.middlewares.client import Host
from tests.middlewares.test_console_docs import hold

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    "adding-a-board",
    "adding-a-component-kind",
    "adding-a-family",
    "adding-a-middleware",
    "adding-a-platform",
    "tutorial",
]
NEEDS_PICO_SDK = "<!-- from here on the commands need the Pico SDK -->\n"
_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"`([^`\s]+)`[^`\n]*:\s*\Z")


@dataclass(frozen=True)
class Step:
    """A file to write (``command`` is empty), or a command to run with its output."""

    path: str
    command: str
    text: str


def steps(page: str) -> list[Step]:
    """The files and commands of a page, in their order."""
    result: list[Step] = []
    end = 0
    for block in _BLOCK.finditer(page):
        before, end = page[end : block.start()], block.end()
        if block[1] == "console":
            for part in re.split(r"^\$ ", block[2], flags=re.MULTILINE)[1:]:
                command, _, output = part.partition("\n")
                result.append(Step("", command, output))
            continue
        named = _FILE.search(before)
        if named:
            result.append(Step(named[1], "", block[2]))
    return result


def run(command: str, folder: Path) -> str:
    """The output of a shell command; ``epg`` is the program of this checkout."""
    environment = {name: value for name, value in os.environ.items() if name not in ("EPG_PATH", "EPG_TARGETS_PATH")}
    first = command.split()[0]
    if first == "cmake" and "--build" not in command:
        command += f" -G Ninja '-DEPG_DIR={ROOT / 'cmake'}' '-DPython3_EXECUTABLE={sys.executable}'"
    if (folder / "targets").is_dir():
        environment["EPG_TARGETS_PATH"] = str(folder / "targets") if first == "cmake" else "targets"
    epg = f'epg() {{ {shlex.quote(sys.executable)} {shlex.quote(str(ROOT / "epg"))} "$@"; }}'
    done = subprocess.run(
        ["sh", "-c", f"{epg}\n{command}"],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=300,
    )
    assert "Traceback" not in done.stdout
    assert done.returncode == 0 or first == "epg", f"$ {command}\n{done.stdout}"
    return done.stdout


def matches(output: str, expected: str) -> bool:
    """True if ``output`` is ``expected``, in which a line ``...`` matches any lines."""
    parts = [re.escape(part) for part in re.split(r"^\.\.\.\n", expected, flags=re.MULTILINE)]
    return re.fullmatch(r"(?:.*\n)*?".join(parts), output) is not None


def follow(found: list[Step], folder: Path) -> None:
    """Writes the files and runs the commands; each must print the output on the page."""
    if any(step.command.startswith("cmake") for step in found) and not shutil.which("ninja"):
        pytest.skip("ninja is missing: apt install ninja-build")
    for step in found:
        if step.path:
            path = folder / step.path
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(step.text, encoding="utf-8")
            continue
        output = run(step.command, folder)
        assert matches(output, step.text), f"$ {step.command}\n{output}"


def read(name: str) -> tuple[str, str]:
    """A page in two parts: the commands of the second one need the Pico SDK."""
    here, _, board = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8").partition(NEEDS_PICO_SDK)
    return here, board


@pytest.mark.parametrize("name", PAGES)
def test_how_to(name: str, tmp_path: Path) -> None:
    found = steps(read(name)[0])
    assert any(step.path for step in found) and any(step.command for step in found)
    follow(found, tmp_path)


def test_tutorial_on_a_board(tmp_path: Path) -> None:
    """The firmware is built from the files of the simulation; the steps that ran on this computer do not run again."""
    skip_if_missing(pico_sdk, arm_gcc, lambda: tool("picotool"))  # without it, the SDK fetches one
    here, board = read("tutorial")
    found = steps(board)
    assert [step.command.split()[0] for step in found] == ["cmake", "cmake", "ls"]
    follow([step for step in steps(here) if step.path or step.command.startswith(("epg ", "cp "))] + found, tmp_path)


def test_tutorial_in_real_time(tmp_path: Path) -> None:
    """The page's first session on the board, held with the simulated robot."""
    here, board = read("tutorial")
    (session,) = re.findall(r"^```session\n(.*?)^```$", board, re.MULTILINE | re.DOTALL)
    follow([step for step in steps(here) if "build/stop" not in step.command], tmp_path)
    with Host(tmp_path / "build" / "turntable_host") as console:
        console.ask("version")
        hold(console, session)


def test_a_page_that_is_wrong_is_noticed() -> None:
    """The test above is able to fail."""
    page = "A file `a/b.yaml`:\n\n```yaml\nx: 1\n```\n\n```console\n$ epg check x\none\n...\ntwo\n$ epg y\n```\n"
    assert steps(page) == [
        Step("a/b.yaml", "", "x: 1\n"),
        Step("", "epg check x", "one\n...\ntwo\n"),
        Step("", "epg y", ""),
    ]
    assert matches("one\nand a half\ntwo\n", "one\n...\ntwo\n")
    assert matches("one\ntwo\n", "one\n...\ntwo\n")
    assert not matches("one\nthree\n", "one\n...\ntwo\n")
