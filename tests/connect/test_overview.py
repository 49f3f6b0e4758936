# SPDX-License-Identifier: Apache-2.0
"""A system in a session: its targets, connections and messages, and the way to a target and back."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.connect.overview import Overview
from epg.connect.projects import find_jobs, find_systems, system_jobs
from epg.connect.session import Refused, Session
from epg.generator.diagnostics import Diagnostics
from tests.connect.test_terminal import talk
from tests.waiting import until

ROOT = Path(__file__).resolve().parents[2]
SYSTEM = """version: 1
system: pair
targets:
  leader: {tcf: leader.tcf, model: model, bindings: leader.bindings.yaml}
  follower: {tcf: rpi_pico2_bare_metal_jiwy, model: model, bindings: jiwy.bindings.yaml}
connections:
  - {from: leader/pan_logging, to: follower/pan_subscriber}
  - {from: leader/tilt_publisher, to: follower/tilt_subscriber}
world:
  sends: [leader/setpoint_pan, leader/tilt_subscriber]
"""


@pytest.fixture
def system(tmp_path: Path) -> Path:
    return write_pair(tmp_path)


def write_pair(folder: Path) -> Path:
    """Writes two JIWYs.  The leader has two ports that the system connects, and no components for them."""
    shutil.copytree(ROOT / "examples/jiwy/model", folder / "model")
    text = (ROOT / "examples/jiwy/jiwy.bindings.yaml").read_text()
    (folder / "jiwy.bindings.yaml").write_text(text)
    for line in ("  setpoint_pan: pan_subscriber\n", "  pan_logging: pan_publisher\n"):
        assert line in text
        text = text.replace(line, "")
    (folder / "leader.bindings.yaml").write_text(text)
    parts = "components: {pan_subscriber: null, pan_publisher: null}"
    (folder / "leader.tcf").write_text(f"version: 1\nextends: rpi_pico_freertos_jiwy.tcf\n{parts}\n")
    path = folder / "pair.system.yaml"
    path.write_text(SYSTEM)
    return path


def edit(path: Path, before: str, after: str) -> None:
    text = path.read_text()
    assert text.count(before) == 1, before
    path.write_text(text.replace(before, after))


def test_targets_and_connections(system: Path) -> None:
    state = Overview(system, ()).show()
    assert (state["phase"], state["project"]["name"], state["diagnostics"]) == ("system", "pair", [])
    shown = state["system"]
    assert shown["targets"][0] == {
        "name": "leader", "target": "rpi_pico_freertos", "middleware": "xrce", "period": "1 ms",
        "model": "JIWY_Control",
    }  # fmt: skip
    connection = shown["connections"][0]
    assert connection["from"] == {"target": "leader", "component": "pan_logging", "port": "pan_logging"}
    assert (connection["topic"], connection["unit"]) == ("/pair/leader/pan_logging", "rad")
    assert (connection["sent"], connection["age"]) == ("every 33 ms", "34 ms")
    assert [end["topic"] for end in shown["world"]] == ["/pair/leader/setpoint_pan", "/pair/leader/tilt_subscriber"]


MISTAKES = {
    "a target": ("leader.bindings.yaml", "pwm_tilt: pwm_tilt", "pwm_tilt: pwm_tlt", ["leader"]),
    "a connection": ("pair.system.yaml", "to: follower/tilt_subscriber", "to: leader/tilt_subscriber", []),
    "an input without sender": ("pair.system.yaml", ", leader/tilt_subscriber]", "]", []),
    "both": ("model", "", "", ["leader", "follower"]),
    "a key of the file": ("pair.system.yaml", "system: pair", "sytem: pair", []),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_messages_are_those_of_the_command_line(name: str, system: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, before, after, targets = MISTAKES[name]
    path = system.parent / file
    if before:
        edit(path, before, after)
    else:
        shutil.rmtree(path)
    state = Overview(system, ()).show()
    main(["check", "--json", str(system)])
    said = json.loads(capsys.readouterr().out)["diagnostics"]
    added = ("port", "ports", "component", "path", "targets")
    shown = state["diagnostics"]
    assert said
    shown_here = [{key: value for key, value in each.items() if key not in added} for each in shown]
    assert shown_here == [{key: value for key, value in each.items() if key != "edits"} for each in said]
    assert next(each["targets"] for each in shown if each["severity"] == "error") == targets
    if name == "a key of the file":
        assert state["system"] is None
    else:
        assert [target["name"] for target in state["system"]["targets"]] == ["leader", "follower"]


def test_to_a_target_and_back(system: Path) -> None:
    session = Session([], system=system)
    state = session.act("open", {"target": "leader"})
    assert (state["phase"], state["project"]["name"], state["project"]["system"]) == ("connect", "leader", "pair")
    assert state["diagnostics"] == []
    topics = {"setpoint_pan": "/pair/leader/setpoint_pan", "pan_logging": "/pair/leader/pan_logging"}
    assert (state["by_system"], state["proposals"], state["unused"]) == (topics, {}, [])
    session.act("disconnect", {"port": "pwm_tilt"})
    with pytest.raises(Refused, match="unsaved"):
        session.act("overview", {})
    session.act("save", {})
    assert "pwm_tilt" not in (system.parent / "leader.bindings.yaml").read_text()
    state = session.act("overview", {})
    assert state["phase"] == "system"
    (unbound,) = state["diagnostics"]  # its hint names the motor that now stands still: no second message does
    assert (unbound["id"], unbound["targets"]) == ("unbound-output", ["leader"])
    assert unbound["hint"] == "write 'pwm_tilt: pwm_tilt', or write 'pwm_tilt: unconnected'"
    assert session.picture("system").startswith("<svg")
    with pytest.raises(Refused, match="no target of the system is open"):
        session.act("save", {})


def test_edits_by_other_programs(system: Path) -> None:
    session = Session([], system=system)
    edit(system, "  follower: {", "  second: {count: 2, ")
    edit(system, "to: follower/pan_subscriber", "to: second/pan_subscriber")
    edit(system, "to: follower/tilt_subscriber", "to: second/tilt_subscriber")
    state = session.act("open", {"target": "second_2"})
    assert state["project"]["targets"] == ["leader", "second_1", "second_2"]
    edit(system, "tcf: rpi_pico2_bare_metal_jiwy", "tcf: rpi_pico_zephyr_jiwy")
    until(lambda: session.wait(session.state()["version"], 1)["draft"]["external"])
    state = session.state()
    assert state["project"]["files"]["tcf"].endswith("rpi_pico_zephyr_jiwy.tcf")
    assert state["draft"]["external"] == "another program changed pair.system.yaml; EPG has read it again"


def test_the_project_of_a_system(system: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = system.parent
    with pytest.raises(Refused, match="no project") as refused:
        session = Session([], system=system)
        session.act("open", {"target": "follower"})
        session.act("generate", {})
    assert "epg new . --system pair.system.yaml" in refused.value.hint
    assert find_systems(folder) == [system]
    assert main(["new", str(folder / "robots"), "--system", str(system)]) == 0
    assert find_systems(folder / "robots") == [system]
    (job, _) = system_jobs(system, folder / "robots")
    assert (job.source_dir, job.build_dir) == (folder / "robots", folder / "robots/build")
    assert job.executables == ("pair",)
    capsys.readouterr()


def test_a_firmware_project_with_a_target_of_a_system(system: Path) -> None:
    board = system.parent / "board"
    board.mkdir()
    text = "project(board C)\nepg_add_target(leader SYSTEM ../pair.system.yaml)\n"
    (board / "CMakeLists.txt").write_text(text + "epg_add_executable(firmware EPG::leader)\n")
    (job,) = find_jobs(board, Diagnostics())
    assert (job.request.name, job.executables, job.source_dir) == ("leader", ("firmware",), board)
    state = Session([job], folder=board).state()
    assert (state["diagnostics"], sorted(state["by_system"])) == ([], ["pan_logging", "setpoint_pan"])
    (board / "CMakeLists.txt").write_text(text.replace("leader", "leeder"))
    problems = Diagnostics()
    assert find_jobs(board, problems) == []
    assert [problem.message for problem in problems] == [
        "the system 'pair.system.yaml' of this target has no target 'leeder'"
    ]


def test_in_the_terminal(system: Path) -> None:
    status, said = talk(Session([], system=system), "leader", "", "n")
    assert status == 0, said
    assert "leader/pan_logging -> follower/pan_subscriber  every 33 ms" in said
    assert "0 of them to connect" in said
    assert "topic /pair/leader/setpoint_pan, by the system" in said
