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

from tests.doubles.toolchain import arm_gcc, pico_sdk, skip_if_missing, tool
from tests.middlewares.client import Host
from tests.middlewares.test_console_docs import hold
from tests.zephyr.workspace import c_library, workspace
from tests.zephyr.workspace import run as in_workspace

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    "adding-a-board",
    "adding-a-class",
    "adding-a-component-kind",
    "adding-a-family",
    "adding-a-middleware",
    "adding-a-platform",
    "tutorial",
]
CONTINUED = {"adding-a-family": "adding-a-board"}
"""Pages that begin with the files of another page."""
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
        pytest.skip("Ninja is not installed: sudo apt install ninja-build")
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
    if name in CONTINUED:
        found = [step for step in steps(read(CONTINUED[name])[0]) if step.path] + found
    follow(found, tmp_path)


def test_tutorial_on_a_board(tmp_path: Path) -> None:
    """The firmware is built from the files of the simulation; the steps that ran on this computer do not run again."""
    skip_if_missing(pico_sdk, arm_gcc, lambda: tool("picotool"))  # without it, the SDK fetches one
    here, board = read("tutorial")
    found = steps(board)
    assert [step.command.split()[0] for step in found] == ["cmake", "cmake", "ls"]
    follow([step for step in steps(here) if step.path or step.command.startswith(("epg ", "cp "))] + found, tmp_path)


@pytest.mark.parametrize("project", ["pico", "stm32"])
def test_added_class_on_a_board(project: str, tmp_path: Path) -> None:
    """The image contains the class's C for the board's port layer, in the memory of the control cycle."""
    needs = {"pico": (pico_sdk, lambda: tool("picotool")), "stm32": (lambda: tool("cmsis_device_f7"),)}
    skip_if_missing(arm_gcc, *needs[project])
    follow([step for step in steps(read("adding-a-class")[0]) if step.path], tmp_path)
    run(f"cmake -S {project} -B build -DCMAKE_BUILD_TYPE=Release", tmp_path)
    run("cmake --build build", tmp_path)
    symbols = run(f"{arm_gcc().with_name('arm-none-eabi-nm')} build/dial_firmware.elf", tmp_path)
    assert re.search(r"^2\w{7} T analog_input_read$", symbols, re.MULTILINE), "the conversion is not in RAM"


def test_added_class_on_zephyr(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Zephyr compiles the class's C by its driver, and the target's code calls it."""
    follow([step for step in steps(read("adding-a-class")[0]) if step.path], tmp_path)
    monkeypatch.setenv("EPG_TARGETS_PATH", str(tmp_path / "targets"))
    skip_if_missing(lambda: workspace("rpi_pico"), c_library)
    here = workspace("rpi_pico")
    settings = {"ZEPHYR_MODULES": ";".join(map(str, here.modules)), "EPG_DIR": str(ROOT / "cmake"), **c_library()}
    options = [f"-D{name}={value}" for name, value in settings.items()]
    command = ["cmake", "-G", "Ninja", "-S", str(tmp_path / "zephyr"), "-B", str(tmp_path / "build"), *options]
    in_workspace(command, here)
    in_workspace(["ninja", "-C", str(tmp_path / "build"), "zephyr/zephyr.elf"], here)
    symbols = run(f"{arm_gcc().with_name('arm-none-eabi-nm')} build/zephyr/zephyr.elf", tmp_path)
    assert " T analog_input_read\n" in symbols


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
