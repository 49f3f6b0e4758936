# SPDX-License-Identifier: Apache-2.0
"""`west epg`: the command line of EPG in a workspace whose manifest names its commands."""

from __future__ import annotations

import json
import os
import pty
import re
import select
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.connect.page import Page
from tests.doubles.toolchain import ROOT, skip_if_missing
from tests.waiting import until

from .workspace import workspace

COMMANDS = "zephyr_module/west/west-commands.yml"
MANIFEST = f"""manifest:
  projects:
    - {{name: epg, url: https://example.org/epg, revision: main, west-commands: {COMMANDS}}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace of west that contains only this EPG."""
    skip_if_missing(workspace)
    top = tmp_path_factory.mktemp("workspace")
    (top / "manifest").mkdir()
    (top / "manifest" / "west.yml").write_text(MANIFEST)
    (top / "epg").symlink_to(ROOT, target_is_directory=True)
    assert west(top, "init", "-l", "manifest").returncode == 0
    return top


def west(folder: Path, *words: str, **variables: str) -> subprocess.CompletedProcess[str]:
    here = workspace()
    environment = {**here.environment(), **variables}
    del environment["ZEPHYR_BASE"]  # west searches there first
    command = [str(here.python), "-m", "west", *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, env=environment, check=False)


def epg(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "epg"), *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, env=os.environ, check=False)


TCF = """version: 1
target: host
node: a_node
control: {period: 1 ms}
components:
  motor: {kind: pwm, frequency: 20 kHzz}
"""


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (0, ["--version"]),
        (0, ["--help"]),
        (0, ["check", "--help"]),
        (0, ["targets", "--json"]),
        (1, ["check", "--format", "json", "wrong.tcf"]),
        (1, ["check", "--", "wrong.tcf"]),
        (2, ["check", "--no-such-option"]),
        (2, ["-v"]),
    ],
)
def test_it_says_what_epg_says(status: int, words: list[str], folder: Path) -> None:
    """The same output on the same stream, and the same exit status: the options are EPG's, not west's."""
    (folder / "wrong.tcf").write_text(TCF)
    said, expected = west(folder, "epg", *words), epg(folder, *words)
    assert expected.returncode == status, expected.stderr
    assert (said.returncode, said.stdout, said.stderr) == (status, expected.stdout, expected.stderr)


def test_it_writes_where_west_was_called(folder: Path) -> None:
    """In a folder below the workspace, with a space in its name."""
    below = folder / "my robots"
    below.mkdir()
    model = ROOT / "examples" / "jiwy" / "model"
    said = west(below, "epg", "new", "--json", "--target", "host_jiwy", "--model", str(model), "jiwy")
    assert said.returncode == 0, said.stderr
    assert json.loads(said.stdout)["folder"] == "jiwy"
    assert (below / "jiwy" / "jiwy.tcf").is_file()


def test_west_lists_it_and_hands_over_help(folder: Path) -> None:
    assert "  epg:" in west(folder, "help").stdout
    assert west(folder, "help", "epg").stdout == epg(folder, "--help").stdout


def test_packages_that_the_python_of_west_lacks_are_asked_for(folder: Path, tmp_path: Path) -> None:
    """EPG runs in the Python of west: packages that are not there are reported if they may not be installed."""
    here = workspace()
    needs = [str(here.python), "-c", "import jinja2, jsonschema, yaml"]
    complete = subprocess.run(needs, capture_output=True, check=False, env=here.environment()).returncode == 0
    said = west(folder, "epg", "targets", EPG_CACHE=str(tmp_path), EPG_NO_INSTALL="1")
    assert said.returncode == (0 if complete else 4)
    assert complete or f"for {here.python}: their installation is turned off" in said.stderr


class Terminal:
    """`west epg connect` in a terminal, as a user types it."""

    def __init__(self, folder: Path, *words: str) -> None:
        here = workspace()
        hidden = ("ZEPHYR_BASE", "DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
        environment = {name: value for name, value in here.environment().items() if name not in hidden}
        self.process, self.screen = pty.fork()
        if self.process == 0:
            os.chdir(folder)
            os.execve(here.python, [str(here.python), "-m", "west", "epg", "connect", *words], environment)
        self.text = ""

    def read_until(self, pattern: str, seconds: float = 60) -> re.Match[str]:
        def match() -> re.Match[str] | None:
            if select.select([self.screen], [], [], 0.2)[0]:
                self.text += os.read(self.screen, 4096).decode(errors="replace")
            return re.search(pattern, self.text)

        found = re.search(pattern, self.text) or until(match, lambda: self.text, seconds, pause=0.0)
        assert found is not None
        return found

    def type(self, text: str) -> None:
        os.write(self.screen, text.encode())

    def wait(self) -> int:
        """The exit status; reads the output until the end."""
        try:
            while data := os.read(self.screen, 4096):
                self.text += data.decode(errors="replace")
        except OSError:  # on Linux, when no process has the terminal open any more
            pass
        os.close(self.screen)
        return os.waitstatus_to_exitcode(os.waitpid(self.process, 0)[1])


@pytest.fixture
def application(folder: Path) -> Path:
    there = folder / "application"
    if not there.exists():
        ignored = shutil.ignore_patterns("build*")
        shutil.copytree(ROOT / "examples" / "existing_zephyr_application", there, ignore=ignored)
    return there


def test_connect_knows_the_application_it_is_called_in(application: Path) -> None:
    """Ctrl-C reaches both west and EPG, and ends both."""
    terminal = Terminal(application)
    address = terminal.read_until(r"http://127\.0\.0\.1:\d+/#\S+\s")[0]
    project = Page(address.strip()).state()["project"]
    assert (project["name"], project["folder"]) == ("turntable", str(application))
    terminal.type("\x03")
    assert terminal.wait() in (0, 130)
    assert "Traceback" not in terminal.text


def test_connect_asks_in_the_terminal_of_west(application: Path) -> None:
    terminal = Terminal(application, "--terminal")
    terminal.read_until("q to quit")
    terminal.type("q\n")
    assert terminal.wait() == 0
