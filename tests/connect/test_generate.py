"""From the page to a program: a project for this computer is created, generated, broken and mended."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from epg.connect.session import Session
from tests.connect.page import Denied, Page, serving

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
    page.post("generate")
    assert "scale: 2" in (folder / "robot.bindings.yaml").read_text(), "generating saves first"
    with pytest.raises(Denied, match="a build is running") as refusal:
        page.post("generate")
    assert refusal.value.status == 409
    build = page.until(lambda state: state["build"]["state"] != "running", 120)["build"]
    log = page.json("api/log?from=0")
    assert build["state"] == "done", log["lines"][-20:]
    assert log["next"] == len(log["lines"]) == build["lines"] and log["lines"]
    assert page.json(f"api/log?from={log['next']}")["lines"] == []
    (product,) = [each for each in build["products"] if Path(each["path"]).name == "robot_host"]
    assert subprocess.run([product["path"], "--help"], capture_output=True, timeout=20).returncode == 0


def test_mistakes_are_not_built(host_page: Page) -> None:
    state = host_page.connect("pwm_pan", "encoder_pan")
    assert state["diagnostics"]
    with pytest.raises(Denied, match="still a mistake") as refusal:
        host_page.post("generate")
    assert refusal.value.status == 409 and host_page.state()["draft"]["changed"]


def test_a_message_of_the_build_finds_its_port(host_page: Page, tmp_path: Path) -> None:
    """An editor puts a mistake into the bindings after the build has begun."""
    page = host_page
    bindings = tmp_path / "a robot/robot.bindings.yaml"
    page.post("generate")
    bindings.write_text(bindings.read_text().replace("pwm_pan: pwm_pan", "pwm_pan: pwm_pam"))
    state = page.until(lambda state: state["build"]["state"] == "failed", 120)
    (message,) = [each for each in state["build"]["messages"] if each["id"] == "unknown-component"]
    assert message["port"] == "pwm_pan"
    source = page.json(f"api/source?file={message['file'].replace(' ', '%20')}&line={message['line']}")
    assert "pwm_pan: pwm_pam" in source["lines"][source["line"] - source["first"]]


def test_a_build_is_cancelled(host_page: Page) -> None:
    host_page.post("generate")
    time.sleep(0.5)
    host_page.post("cancel")
    assert host_page.until(lambda state: state["build"]["state"] != "running")["build"]["state"] == "cancelled"
