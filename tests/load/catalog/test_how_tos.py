# SPDX-License-Identifier: Apache-2.0
"""The how-tos are right: their files are written and their commands run as they stand there.

A block that follows a line ending in "`path`:" is that file.  In a ``console`` block a line ``$ command`` is run, and
what follows it is what it prints; a line ``...`` stands for any lines.
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

ROOT = Path(__file__).resolve().parents[3]
PAGES = ["adding-a-board", "adding-a-component-kind", "adding-a-middleware", "adding-a-platform"]
_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"`([^`\s]+)`[^`\n]*:\s*\Z")


@dataclass(frozen=True)
class Step:
    """A file to write (``command`` is empty) or a command to run with what it prints."""

    path: str
    command: str
    text: str


def steps(page: str) -> list[Step]:
    """The files and commands of a page in their order."""
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
    """What a command prints; ``epg`` is the one of this checkout."""
    words = shlex.split(command)
    if words[0] == "epg":
        words[:1] = [sys.executable, str(ROOT / "epg")]
    elif words[0] == "cmake" and "--build" not in words:
        words += ["-G", "Ninja", f"-DEPG_DIR={ROOT / 'cmake'}", f"-DPython3_EXECUTABLE={sys.executable}"]
    environment = {**os.environ, "EPG_TARGETS_PATH": "targets"}
    if words[0] == "cmake":
        environment["EPG_TARGETS_PATH"] = str(folder / "targets")
    done = subprocess.run(
        words, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300
    )
    assert "Traceback" not in done.stdout
    return done.stdout


def matches(output: str, expected: str) -> bool:
    """Whether ``output`` is ``expected``, in which a line ``...`` stands for any lines."""
    parts = [re.escape(part) for part in re.split(r"^\.\.\.\n", expected, flags=re.MULTILINE)]
    return re.fullmatch(r"(?:.*\n)*?".join(parts), output) is not None


@pytest.mark.parametrize("name", PAGES)
def test_how_to(name: str, tmp_path: Path) -> None:
    found = steps((ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8"))
    assert any(step.path for step in found) and any(step.command for step in found)
    if any(step.command.startswith("cmake") for step in found) and not shutil.which("ninja"):
        pytest.skip("ninja is missing: apt install ninja-build")
    for step in found:
        if step.path:
            path = tmp_path / step.path
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(step.text, encoding="utf-8")
            continue
        output = run(step.command, tmp_path)
        assert matches(output, step.text), f"$ {step.command}\n{output}"


def test_a_page_that_is_wrong_is_noticed() -> None:
    """The test above can fail."""
    page = "A file `a/b.yaml`:\n\n```yaml\nx: 1\n```\n\n```console\n$ epg check x\none\n...\ntwo\n$ epg y\n```\n"
    assert steps(page) == [
        Step("a/b.yaml", "", "x: 1\n"),
        Step("", "epg check x", "one\n...\ntwo\n"),
        Step("", "epg y", ""),
    ]
    assert matches("one\nand a half\ntwo\n", "one\n...\ntwo\n")
    assert matches("one\ntwo\n", "one\n...\ntwo\n")
    assert not matches("one\nthree\n", "one\n...\ntwo\n")
