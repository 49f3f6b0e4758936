# SPDX-License-Identifier: Apache-2.0
"""From the page to a program: a project for this computer is created, generated, broken and corrected."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from epg.connect.build import consent
from epg.connect.session import Session
from tests.connect.page import Denied, Page, serving, session_of

ROOT = Path(__file__).resolve().parent.parent.parent


@pytest.fixture
def host_page(tmp_path: Path) -> Iterator[Page]:
    with serving(Session([], model=ROOT / "examples/jiwy/model")) as page:
        page.post("create", configuration="host_jiwy", folder=str(tmp_path / "a robot"), name="robot")
        yield page


def test_a_program_is_made_and_runs(host_page: Page, tmp_path: Path) -> None:
    page = host_page
    folder = tmp_path / "a robot"
    assert page.state()["build"]["state"] == "idle"
    page.connect("pan_logging", "pan_publisher", scale=2)
    page.generate()
    assert "scale: 2" in (folder / "robot.bindings.yaml").read_text(), "generating saves first"
    with pytest.raises(Denied, match="a build is running") as refusal:
        page.post("generate")
    assert refusal.value.status == 409
    build = page.until(lambda state: state["build"]["state"] != "running", 120)["build"]
    log = page.json("api/log?from=0")
    assert build["state"] == "done", log["lines"][-20:]
    assert len(log["lines"]) == build["lines"] > 0
    assert page.json(f"api/log?from={build['lines']}")["lines"] == []
    (product,) = [each for each in build["products"] if Path(each["path"]).name == "robot_host"]
    assert subprocess.run([product["path"], "--help"], capture_output=True, timeout=20).returncode == 0


def test_what_is_run_is_said_once_for_a_folder(
    host_page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    page, folder = host_page, tmp_path / "a robot"
    page.connect("pan_logging", "pan_publisher", scale=2)
    for wrong in ({}, {"run": "0" * 64}):
        build = page.post("generate", **wrong)["build"]
        assert build["state"] == "idle" and page.state()["draft"]["changed"], "nothing was started or saved"
    ask = build["ask"]
    assert ask["folder"] == str(folder) and len(ask["commands"]) == 2
    assert ask["commands"][0].startswith(f"{shutil.which('cmake')} --preset release -B '{folder}/build'")
    assert ask["commands"][1].startswith(f"{shutil.which('cmake')} --build '{folder}/build'")
    assert shutil.which("cmake") in ask["programs"] and len(ask["programs"]) == 2
    assert not (folder / "build").exists()
    page.post("generate", run=ask["key"])
    build = page.until(lambda state: state["build"]["state"] not in ("idle", "running"), 120)["build"]
    assert build["state"] == "done" and build["ask"] is None
    consent._agreed.clear()
    with serving(session_of(folder)) as later:
        assert later.post("generate")["build"]["state"] == "running", "another session does not ask again"
        later.post("cancel")


def test_a_program_of_the_build_folder_is_not_started_before_it_is_named(
    host_page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A folder from another person may contain a build folder, whose cache can name any program."""
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    folder, started = tmp_path / "a robot", tmp_path / "started"
    program = tmp_path / "evil"
    program.write_text(f"#!/bin/sh\ntouch '{started}'\n")
    program.chmod(0o755)
    (folder / "build").mkdir()
    (folder / "build/CMakeCache.txt").write_text(
        f"CMAKE_HOME_DIRECTORY:INTERNAL={folder}\nCMAKE_MAKE_PROGRAM:FILEPATH={program}\n"
        f"CMAKE_C_COMPILER:FILEPATH={program}\nCMAKE_CXX_COMPILER:FILEPATH={program}\nPICO_SDK_PATH:PATH={folder}\n"
    )
    with serving(session_of(folder)) as page:
        ask = page.post("generate")["build"]["ask"]
    assert str(program) in ask["programs"] and not started.exists()


def test_mistakes_are_not_built(host_page: Page) -> None:
    state = host_page.connect("pwm_pan", "encoder_pan")
    assert state["diagnostics"]
    with pytest.raises(Denied, match="there is an error") as refusal:
        host_page.post("generate")
    assert refusal.value.status == 409 and host_page.state()["draft"]["changed"]


def test_a_message_of_the_build_finds_its_port(host_page: Page, tmp_path: Path) -> None:
    """An editor makes a mistake in the bindings after the build has begun."""
    page = host_page
    bindings = tmp_path / "a robot/robot.bindings.yaml"
    page.generate()
    bindings.write_text(bindings.read_text().replace("pwm_pan: pwm_pan", "pwm_pan: pwm_pam"))
    state = page.until(lambda state: state["build"]["state"] == "failed", 120)
    (message,) = [each for each in state["build"]["messages"] if each["id"] == "unknown-component"]
    assert message["port"] == "pwm_pan"
    source = page.json(f"api/source?file={message['file'].replace(' ', '%20')}&line={message['line']}")
    assert "pwm_pan: pwm_pam" in source["lines"][source["line"] - source["first"]]
