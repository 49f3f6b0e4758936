# SPDX-License-Identifier: Apache-2.0
"""The targets <name>_connect and <name>_live: they run in a build, and the first one starts that build again."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cmake.project import ROOT, Project, compiled
from tests.connect.builds import processes
from tests.connect.started import generate, started
from tests.waiting import until

GENERATORS = ["Ninja", "Unix Makefiles"]


def build_command(project: Project, target: str = "robot_connect", *more: str) -> list[str]:
    return ["cmake", "--build", str(project.build_folder), "--target", target, *more]


@pytest.fixture(params=GENERATORS)
def robot(request: pytest.FixtureRequest, tmp_path: Path) -> Project:
    made = Project(tmp_path / "a b", "robot")
    made.configure(generator=request.param)
    return made


def test_a_build_within_the_build(robot: Project) -> None:
    """Two builds with a change between that configures again; afterwards everything is up to date and complete."""
    with started(build_command(robot, "robot_connect", "-j2")) as (page, process):
        state = page.state()
        assert state["project"]["name"] == "robot" and state["phase"] == "connect"
        for end in ([], [{"reference": "position"}]):
            page.post("connect", port="log", ends=end)
            build = generate(page)
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
    with started(build_command(robot)) as (page, _):
        state = page.state()
        assert state["project"]["files"]["bindings"].endswith(name)
        assert not [d for d in state["diagnostics"] if d["severity"] == "error"]


def test_a_path_that_build_programs_would_replace_reaches_the_page(robot: Project) -> None:
    name = "$<1:x>#.yaml"
    rename_bindings(robot, name)
    robot.build("--target", "epg_runtime")
    for target in ("robot_connect", "robot_live"):
        with started(build_command(robot, target)) as (page, _):
            state = page.state()
            assert state["project"]["files"]["bindings"].endswith(name)
            assert (state["live"]["target"] is not None) == (target == "robot_live")


def test_live_runs_the_program_as_long_as_the_server(robot: Project) -> None:
    """It ends by Ctrl-C, and when the server is killed."""
    robot.edit("robot.tcf", "enable_at_start: true", "enable_at_start: false")
    for end in (signal.SIGKILL, signal.SIGINT):
        with started(build_command(robot, "robot_live")) as (page, process):
            state = page.state()
            assert state["program"]["state"] == "running" and state["live"]["opens"]
            target = state["live"]["target"]
            assert (target["name"], target["matches"], target["state"]["enabled"]) == ("robot", True, "0")
            assert programs(robot)
            os.killpg(process.pid, end)
            said = process.communicate(timeout=30)[0]
            assert "Traceback" not in said
            until(lambda: not programs(robot), "it still runs")


def programs(robot: Project) -> list[str]:
    program = str(robot.build_folder / "robot_host")
    return [command for command in processes(robot.build_folder) if command.startswith(program)]


def test_ctrl_c_ends_it(robot: Project) -> None:
    with started(build_command(robot)) as (page, process):
        page.state()
        os.killpg(process.pid, signal.SIGINT)
        said = process.communicate(timeout=30)[0]
        assert "Traceback" not in said
        with pytest.raises(OSError):
            page.state()


def test_where_configuring_fails_a_script_does_the_same(robot: Project) -> None:
    """CMake writes no build files then.

    The message names a script, and generating on the page corrects the mistake.
    """
    script = robot.build_folder / "epg" / "robot_connect.cmake"
    assert not script.exists()
    robot.edit("bindings.yaml", "go: button, ", "")
    said = robot.build("--target", "robot_connect", check=False)
    assert "[unbound-input]" in said
    command = re.search(r'cmake -P "(.*)"', said)
    assert command is not None and Path(command[1]) == script
    with started(["cmake", "-P", str(script)]) as (page, process):
        (problem,) = [d for d in page.state()["diagnostics"] if d["severity"] == "error"]
        assert (problem["id"], problem["port"]) == ("unbound-input", "go")
        page.post("connect", port="go", ends=[{"reference": "button"}])
        assert generate(page)["state"] == "done"
        page.post("done")
        process.communicate(timeout=30)
    assert not script.exists()
    assert compiled(robot.build()) == set()


def test_what_is_not_understood_is_said_at_once(tmp_path: Path) -> None:
    """The message comes before the page opens, because it is not about the target that the page shows."""
    app = shutil.copytree(ROOT / "examples" / "jiwy", tmp_path / "app", ignore=shutil.ignore_patterns("build*"))
    with (app / "CMakeLists.txt").open("a", encoding="utf-8") as file:
        file.write("epg_add_target(${other} TCF other.tcf MODEL model BINDINGS other.bindings.yaml)\n")
    command = [sys.executable, str(ROOT / "epg"), "connect", str(app)]
    with started(command) as (page, process):
        assert page.state()["project"]["name"] == "jiwy"
        page.post("done")
        rest = process.communicate(timeout=30)[0]
    assert "[cmake-not-understood]" not in rest
