"""The target <name>_connect: it runs in a build, and starts that build again."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.cmake.project import Project, compiled

GENERATORS = ["Ninja", "Unix Makefiles"]


class Page:
    """What a browser would do at the address that was printed."""

    def __init__(self, address: str) -> None:
        self.address = address

    def state(self) -> Any:
        return self._ask(urllib.request.Request(f"{self.address}api/state"))

    def post(self, action: str, **data: object) -> Any:
        headers = {"Content-Type": "application/json"}
        url = f"{self.address}api/{action}"
        return self._ask(urllib.request.Request(url, json.dumps(data).encode(), headers, method="POST"))

    def generate(self) -> Any:
        """Builds, and waits for the end; what the build says of itself."""
        self.post("generate")
        end = time.monotonic() + 120
        while time.monotonic() < end:
            build = self.state()["build"]
            if build["state"] not in ("idle", "running"):
                return build
            time.sleep(0.1)
        raise AssertionError(build)

    def _ask(self, request: urllib.request.Request) -> Any:
        with urllib.request.urlopen(request, timeout=60) as answer:
            return json.load(answer)


@contextmanager
def connected(command: list[str]) -> Iterator[tuple[Page, subprocess.Popen[str]]]:
    """Runs what starts the page in a process group of its own, as a shell does."""
    hidden = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
    environment = {name: value for name, value in os.environ.items() if name not in hidden}
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment, start_new_session=True
    )
    assert process.stdout is not None
    said = ""
    try:
        for line in process.stdout:
            said += line
            if match := re.search(r"http://127\.0\.0\.1:\d+/\S+/", line):
                yield Page(match[0]), process
                return
        raise AssertionError(said)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def build_command(project: Project, *more: str) -> list[str]:
    return ["cmake", "--build", str(project.build_folder), "--target", "robot_connect", *more]


@pytest.fixture(params=GENERATORS)
def robot(request: pytest.FixtureRequest, tmp_path: Path) -> Project:
    made = Project(tmp_path / "a b", "robot")
    made.configure(generator=request.param)
    return made


def test_a_build_within_the_build(robot: Project) -> None:
    """Twice with a change between, which configures again; afterwards everything is up to date, and nothing is lost."""
    with connected(build_command(robot, "-j2")) as (page, process):
        state = page.state()
        assert state["project"]["name"] == "robot" and state["phase"] == "connect"
        for end in ([], [{"reference": "position"}]):
            page.post("connect", port="log", ends=end)
            build = page.generate()
            assert build["state"] == "done", build
        page.post("done")
        said = process.communicate(timeout=30)[0]
        assert process.returncode == 0, said
    assert compiled(robot.build()) == set()
    log = robot.build_folder / ".ninja_log"
    if log.exists():
        lines = log.read_text().splitlines()
        assert lines[0].startswith("# ninja log v") and all(line.count("\t") == 4 for line in lines[1:])
        check = ["ninja", "-C", str(robot.build_folder), "-n", "-d", "explain"]
        assert "no work to do" in subprocess.run(check, capture_output=True, text=True, check=True).stdout


def rename_bindings(robot: Project, name: str) -> None:
    (robot.source / "bindings.yaml").rename(robot.source / name)
    robot.edit("CMakeLists.txt", "BINDINGS bindings.yaml", f"BINDINGS [=[{name}]=]")


def test_what_the_target_was_told_is_what_the_page_shows(robot: Project) -> None:
    name = "my $bindings %PATH% 100%.yaml"
    rename_bindings(robot, name)
    with connected(build_command(robot)) as (page, _):
        state = page.state()
        assert state["project"]["files"]["bindings"].endswith(name)
        assert not [d for d in state["diagnostics"] if d["severity"] == "error"]


def test_a_path_that_build_programs_would_replace_breaks_no_build(robot: Project) -> None:
    rename_bindings(robot, "$(PWD)$<1:x>.yaml")
    robot.build("--target", "epg_runtime")
    assert "robot_connect" not in robot.build("--target", "help")


def test_ctrl_c_ends_it(robot: Project) -> None:
    with connected(build_command(robot)) as (page, process):
        page.state()
        os.killpg(process.pid, signal.SIGINT)
        said = process.communicate(timeout=30)[0]
        assert "Traceback" not in said
        with pytest.raises(OSError):
            page.state()


def test_where_configuring_fails_a_script_does_the_same(robot: Project) -> None:
    """CMake writes no build files then: the message names a script, and what is generated in the page is the mend."""
    script = robot.build_folder / "epg" / "robot_connect.cmake"
    assert not script.exists()
    robot.edit("bindings.yaml", "go: button, ", "")
    said = robot.build("--target", "robot_connect", check=False)
    assert "[unbound-input]" in said
    command = re.search(r'cmake -P "(.*)"', said)
    assert command is not None and Path(command[1]) == script
    with connected(["cmake", "-P", str(script)]) as (page, process):
        (problem,) = [d for d in page.state()["diagnostics"] if d["severity"] == "error"]
        assert (problem["id"], problem["port"]) == ("unbound-input", "go")
        page.post("connect", port="go", ends=[{"reference": "button"}])
        assert page.generate()["state"] == "done"
        page.post("done")
        process.communicate(timeout=30)
    assert not script.exists()
    assert compiled(robot.build()) == set()
