# SPDX-License-Identifier: Apache-2.0
"""Connecting ports as the page does: every action, through HTTP, on the files of a real project."""

from __future__ import annotations

import difflib
import itertools
import shutil
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest

from epg.connect.projects import find_jobs
from epg.connect.session import Session
from epg.generator.correction import correction
from epg.generator.diagnostics import Diagnostic, Diagnostics
from epg.generator.source import Span
from tests.connect.page import Denied, Page, serving, session_of
from tests.connect.robots import ROOT, one_axis_project


def test_a_port_is_connected_and_saved(page: Page, bindings: Path) -> None:
    before = bindings.read_text()
    state = page.state()
    assert state["phase"] == "connect" and state["editable"] and not state["draft"]["changed"]
    assert state["project"]["name"] == "robot" and state["project"]["targets"] == ["robot"]
    assert state["project"]["files"] == {"tcf": "robot.tcf", "model": "model", "bindings": "robot.bindings.yaml"}

    state = page.connect("setpoint_pan", "tilt_subscriber", scale="1/4", offset=0.5, limits=[-1, 1])
    assert bindings.read_text() == before
    assert state["wires"]["setpoint_pan"] == [
        {
            "reference": "tilt_subscriber",
            "scale": "1/4",
            "offset": "0.5",
            "limits": ["-1", "1"],
            "unit": "",
            "follows": "",
            "text": "×1/4 +0.5 in -1…1",
            "from_tcf": "in -0.05…1.6",
            "component_unit": "rad",
            "model_unit": "rad",
        }
    ]
    assert state["draft"]["changed"] and state["draft"]["can_undo"] and not state["draft"]["can_redo"]
    diff = state["draft"]["diff"].splitlines()
    assert "-  setpoint_pan: {from: pan_subscriber, follows: position_pan}" in diff
    assert "+  setpoint_pan: {from: tilt_subscriber, scale: 1/4, offset: 0.5, limits: [-1, 1]}" in diff

    state = page.post("save")
    assert not state["draft"]["changed"] and state["draft"]["diff"] == ""
    changed = [
        line for line in difflib.ndiff(before.splitlines(), bindings.read_text().splitlines()) if line[0] in "+-"
    ]
    assert changed == ["- " + diff_line(diff, "-"), "+ " + diff_line(diff, "+")]


def diff_line(diff: list[str], sign: str) -> str:
    return next(line[1:] for line in diff if line[0] == sign and line[:3] not in ("---", "+++"))


def test_messages_stand_at_the_port(page: Page) -> None:
    state = page.post("disconnect", port="position_pan")
    (message,) = [each for each in state["diagnostics"] if each["port"] == "position_pan"]
    assert (message["id"], message["severity"]) == ("unbound-input", "error")
    assert "position_pan" not in state["wires"]
    assert state["proposals"] == {"position_pan": "encoder_pan"}
    state = page.connect("pwm_pan", "pwm_tilt")
    (message,) = [each for each in state["diagnostics"] if each["id"] == "bound-twice"]
    assert message["port"] in ("pwm_pan", "pwm_tilt")
    assert not state["pictures"]["application"] and state["pictures"]["wiring"]
    state = page.connect("position_pan", "pwm_pan")
    assert [each["port"] for each in state["diagnostics"] if each["id"] == "wrong-direction"] == ["position_pan"]


def edit_of(state: dict[str, Any], id: str) -> dict[str, Any]:
    """The edit of the only message with this id."""
    (message,) = [each for each in state["diagnostics"] if each["id"] == id]
    (found,) = message["edits"]
    return cast("dict[str, Any]", found)


def apply(page: Page, edit: dict[str, Any]) -> dict[str, Any]:
    return page.post("apply", **{key: edit[key] for key in ("file", "line", "column", "new")})


def test_edits_of_messages_are_applied(page: Page, project: Path, bindings: Path) -> None:
    """Each is one step of the draft, in the bindings and in the .tcf; nothing is written before the user saves."""
    tcf = project / "robot.tcf"
    right, right_tcf = bindings.read_text(), tcf.read_text()
    wrong = right.replace("pwm_pan: pwm_pan", "pwm_pan: pwn_pan")
    bindings.write_text(wrong)
    tcf.write_text(right_tcf.replace("enable_at_start", "enable_at_strat"))
    state = apply(page, edit_of(page.state(), "unknown-key"))
    assert "+  enable_at_start: false  # motors stay off until the target is enabled" in state["draft"]["diff"]
    edit = edit_of(state, "unknown-component")
    assert (edit["old"], edit["new"]) == ("pwn_pan", "pwm_pan")
    state = apply(page, edit)
    assert state["diagnostics"] == [] and bindings.read_text() == wrong
    assert edit_of(page.post("undo"), "unknown-component") == edit
    page.post("redo")
    page.post("save")
    assert (bindings.read_text(), tcf.read_text()) == (right, right_tcf)


def test_only_edits_of_present_messages_are_applied(page: Page, bindings: Path) -> None:
    right = bindings.read_text()
    bindings.write_text(right.replace("pwm_pan: pwm_pan", "pwm_pan: pwn_pan"))
    edit = edit_of(page.state(), "unknown-component")
    for wrong in ({"new": "encoder_pan"}, {"line": edit["line"] + 1}, {"file": "/etc/passwd"}):
        with pytest.raises(Denied, match="no message proposes this change"):
            apply(page, edit | wrong)
    bindings.write_text(right)
    with pytest.raises(Denied, match="no message proposes this change"):
        apply(page, edit)
    assert bindings.read_text() == right


def test_an_edit_that_another_program_has_overtaken(page: Page, bindings: Path) -> None:
    """The line has moved: the unsaved change does not fit the new text, and is not made elsewhere."""
    wrong = bindings.read_text().replace("pwm_pan: pwm_pan", "pwm_pan: pwn_pan")
    bindings.write_text(wrong)
    apply(page, edit_of(page.state(), "unknown-component"))
    bindings.write_text(f"# mine\n{wrong}")
    conflict = page.until(lambda state: state["draft"]["conflict"])["draft"]["conflict"]
    assert "there is no 'pwn_pan' any more that 'pwm_pan' could replace" in conflict["message"]


def test_a_line_is_inserted_and_taken_back(page: Page, bindings: Path) -> None:
    """The line comes to the place that it had, and does not follow a text that another program has moved."""
    right = bindings.read_text()
    line = "  position_tilt: encoder_tilt\n"
    assert line in right
    bindings.write_text(right.replace(line, ""))
    edit = edit_of(page.state(), "unbound-input")
    assert (edit["old"], edit["new"]) == ("", "\n" + line.rstrip("\n"))
    state = apply(page, edit)
    assert state["diagnostics"] == []
    page.post("undo")
    apply(page, edit)
    bindings.write_text("# mine\n" + right.replace(line, ""))
    conflict = page.until(lambda state: state["draft"]["conflict"])["draft"]["conflict"]
    assert "there is no such line: add 'inputs: {position_tilt: encoder_tilt}'" in conflict["message"]
    page.post("reload")
    apply(page, edit_of(page.state(), "unbound-input"))
    page.post("save")
    assert bindings.read_text() == "# mine\n" + right


def test_edits_of_files_of_epg_are_not_offered(tmp_path: Path) -> None:
    """A user's .tcf extends a file of EPG; a mistake in the extended file would not be the user's to correct."""
    session = session_of(ROOT / "examples/jiwy")
    assert session.state()["diagnostics"] == []
    editor = session._editor
    assert editor is not None and not editor.owns_tcf
    editor.loaded = replace(
        editor.loaded,
        diagnostics=(
            Diagnostic("x", "error", Span(str(editor.draft.tcf.path), 1, 1, 8), "m", correction("version", "api")),
        ),
    )
    assert editor.proposed_edits() == [[]]


def test_parts_that_no_port_uses_are_left_out(one_axis: Path) -> None:
    """A controller of one axis on a robot of two: without this, homing is an error in a file of EPG."""
    with serving(session_of(one_axis)) as page:
        state = page.state()
        assert {each["id"] for each in state["diagnostics"] if each["severity"] == "error"} == {"needs-bound"}
        assert state["unused"] == [
            *("encoder_tilt", "pwm_tilt", "guard_tilt", "tilt_subscriber", "pan_publisher", "tilt_publisher"),
            "guard_pan.homing",
        ]
        state = page.post("leave_out")
        assert state["diagnostics"] == [] and state["unused"] == []
        assert [each["name"] for each in state["components"]] == [
            "encoder_pan",
            "pwm_pan",
            "guard_pan",
            "pan_subscriber",
        ]
        page.post("save")
        assert "components:\n  encoder_tilt: null\n" in (one_axis / "robot.tcf").read_text()
        with pytest.raises(Denied, match="no part of the robot is unused"):
            page.post("leave_out")


def test_the_simulated_robot_keeps_its_parts(tmp_path: Path) -> None:
    folder = one_axis_project(tmp_path, "host_jiwy")
    with serving(session_of(folder)) as page:
        assert page.state()["unused"] == [
            *("tilt_subscriber", "pan_publisher", "tilt_publisher"),
            *("guard_pan.homing", "guard_tilt.homing"),
        ]
        assert page.post("leave_out")["diagnostics"] == []


def test_values_of_the_configuration_are_set(tmp_path: Path) -> None:
    folder = one_axis_project(tmp_path, "rpi_pico_bare_metal_jiwy")
    original = (folder / "robot.tcf").read_text()
    period, pin = ["control", "period"], ["components", "pwm_pan", "pins", "value"]
    with serving(session_of(folder)) as page:
        state = page.post("fill", changes=[{"path": period, "text": "2 ms"}, {"path": pin, "text": "GP0"}])
        assert "+  pwm_pan: {pins: {value: GP0}}\n" in state["draft"]["diff"]
        assert "+  period: 2 ms\n" in state["draft"]["diff"]
        assert any("GP0" in row["pins"] for row in state["hardware"] if row["component"] == "pwm_pan")
        state = page.post("unset", paths=[pin])
        assert "+  period: 2 ms\n" in state["draft"]["diff"] and "GP0" not in state["draft"]["diff"]
        page.post("undo")
        page.post("undo")
        page.post("save")
        assert (folder / "robot.tcf").read_text() == original
        for changes in ([{"text": "1"}], [{"path": [], "text": "1"}], [{"path": [1], "text": "1"}], "period"):
            with pytest.raises(Denied) as refusal:
                page.post("fill", changes=changes)
            assert refusal.value.status == 400
        with pytest.raises(Denied, match="on one line"):
            page.post("fill", changes=[{"path": period, "text": "1 ms\nnode: x"}])


def test_files_of_epg_are_not_changed(tmp_path: Path) -> None:
    folder = tmp_path / "jiwy"
    shutil.copytree(ROOT / "examples/jiwy", folder)
    with serving(session_of(folder)) as page, pytest.raises(Denied, match="this file cannot be changed"):
        page.post("fill", changes=[{"path": ["control", "period"], "text": "2 ms"}])


def test_outputs_can_have_several_ends_or_none(page: Page, bindings: Path) -> None:
    state = page.connect("pan_logging", "pan_publisher", "tilt_publisher")
    assert [end["reference"] for end in state["wires"]["pan_logging"]] == ["pan_publisher", "tilt_publisher"]
    state = page.connect("tilt_logging")
    assert state["wires"]["tilt_logging"] == []
    assert not any(each["severity"] == "error" for each in state["diagnostics"])
    page.post("save")
    assert "  tilt_logging: unconnected\n" in bindings.read_text()
    with pytest.raises(Denied) as refusal:
        page.connect("position_pan")
    assert refusal.value.status == 400 and "one component" in refusal.value.message


def test_proposals_are_accepted(page: Page, bindings: Path) -> None:
    original = bindings.read_text()
    ports = ["position_pan", "pwm_tilt", "tilt_logging"]
    for port in ports:
        page.post("disconnect", port=port)
    assert set(page.state()["proposals"]) == set(ports)
    state = page.post("accept", ports=["pwm_tilt"])
    assert set(state["proposals"]) == {"position_pan", "tilt_logging"}
    state = page.post("accept")
    assert state["proposals"] == {} and state["diagnostics"] == []
    page.post("save")
    assert sorted(bindings.read_text().split()) == sorted(original.split())
    with pytest.raises(Denied, match="no proposal for 'pwm_tilt'"):
        page.post("accept", ports=["pwm_tilt"])


def test_everything_can_be_undone_and_done_again(page: Page, bindings: Path) -> None:
    original = bindings.read_text()
    states = [page.state()["wires"]]
    states.append(page.connect("pwm_pan", "pwm_tilt", scale=0.5)["wires"])
    states.append(page.post("disconnect", port="position_tilt")["wires"])
    states.append(page.post("accept")["wires"])
    for earlier in reversed(states[:-1]):
        state = page.post("undo")
        assert state["wires"] == earlier
    assert not state["draft"]["changed"] and not state["draft"]["can_undo"]
    for later in states[1:]:
        state = page.post("redo")
        assert state["wires"] == later
    assert not state["draft"]["can_redo"]
    with pytest.raises(Denied, match="nothing to redo"):
        page.post("redo")
    page.post("save")
    page.post("undo")
    page.post("undo")
    page.post("undo")
    page.post("save")
    assert bindings.read_text() == original


def test_reload_throws_the_draft_away(page: Page) -> None:
    before = page.state()["wires"]
    page.connect("pwm_pan", "pwm_tilt")
    state = page.post("reload")
    assert state["wires"] == before and not state["draft"]["changed"] and not state["draft"]["can_undo"]


def test_two_pages_see_the_same(pages: Callable[[], Page]) -> None:
    page, other = pages(), pages()
    version = other.until(lambda state: state["configurations"])["version"]
    seen = {}
    waiting = threading.Thread(target=lambda: seen.update(other.state(version)))
    waiting.start()
    done = page.connect("pwm_pan", "pwm_tilt")
    waiting.join(10)
    assert seen == done == page.state()


def test_two_pages_at_once_lose_nothing(pages: Callable[[], Page]) -> None:
    """Each page changes its own ports, both at the same time."""
    problems: list[BaseException] = []

    def change(port: str, count: int) -> None:
        try:
            page = pages()
            for number in range(1, count + 1):
                page.connect(port, "pan_subscriber", scale=number)
        except BaseException as problem:
            problems.append(problem)

    threads = [threading.Thread(target=change, args=(port, 8)) for port in ("setpoint_pan", "setpoint_tilt")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert not problems
    page = pages()
    wires = page.state()["wires"]
    assert [wires[port][0]["scale"] for port in ("setpoint_pan", "setpoint_tilt")] == ["8", "8"]
    for _ in range(16):
        page.post("undo")
    assert not page.state()["draft"]["changed"]


def test_an_edit_outside_is_noticed(page: Page, bindings: Path) -> None:
    version = page.until(lambda state: state["configurations"])["version"]
    bindings.write_text(bindings.read_text().replace("pwm_pan: pwm_pan", "pwm_pan: {to: pwm_pan, scale: 0.25}"))
    state = page.state(version)
    assert state["wires"]["pwm_pan"][0]["scale"] == "0.25"
    assert state["draft"]["external"] == "another program changed 'robot.bindings.yaml'; EPG has read the new text"
    assert not state["draft"]["changed"]


def test_changes_are_applied_to_what_was_edited_outside(page: Page, bindings: Path) -> None:
    page.connect("setpoint_pan", "tilt_subscriber")
    page.connect("pan_logging", "pan_publisher", scale=2)
    bindings.write_text("# by an editor\n" + bindings.read_text().replace("pwm_pan: pwm_pan", "pwm_pan: unconnected"))
    state = page.until(lambda state: state["draft"]["external"])
    assert "your 2 changes were applied" in state["draft"]["external"]
    assert state["wires"]["pwm_pan"] == [] and state["wires"]["pan_logging"][0]["scale"] == "2"
    page.post("save")
    text = bindings.read_text()
    assert text.startswith("# by an editor\n") and "pwm_pan: unconnected" in text
    assert "setpoint_pan: tilt_subscriber" in text and "pan_logging: {to: pan_publisher, scale: 2}" in text
    state = page.post("undo")
    assert state["wires"]["pan_logging"][0]["scale"] == "" and state["wires"]["pwm_pan"] == []


def test_a_conflict_is_the_users_to_solve(page: Page, bindings: Path) -> None:
    page.connect("setpoint_pan", "tilt_subscriber")
    broken = bindings.read_text().replace("inputs:", "inputs: {")
    bindings.write_text(broken)
    conflict = page.until(lambda state: state["draft"]["conflict"])["draft"]["conflict"]
    assert "do not fit the new text" in conflict["message"] and "reload" in conflict["hint"]
    for action in ("save", "generate", "disconnect"):
        with pytest.raises(Denied) as refusal:
            page.post(action, port="pwm_pan")
        assert refusal.value.status == 409 and refusal.value.message == conflict["message"]
    assert bindings.read_text() == broken
    # configurations arrive later, in a new version
    version = page.until(lambda state: state["configurations"])["version"]
    time.sleep(1.2)  # two looks at the files, without an event
    assert page.json(f"api/state?after={version - 1}")["version"] == version, "a conflict is told once"
    state = page.post("save", anyway=True)
    assert state["draft"]["conflict"] is None and not state["draft"]["changed"]
    assert "setpoint_pan: tilt_subscriber" in bindings.read_text()


def test_what_was_saved_and_undone_is_not_lost(page: Page, bindings: Path) -> None:
    """An undo of a saved change cannot be applied to a text from outside: the user decides."""
    page.connect("pan_logging", "pan_publisher", scale=2)
    page.post("save")
    page.post("undo")
    page.connect("tilt_logging", "tilt_publisher", scale=3)
    bindings.write_text(bindings.read_text() + "# by an editor\n")
    state = page.until(lambda state: state["draft"]["conflict"] or state["draft"]["external"])
    assert state["draft"]["conflict"] and "undone" in state["draft"]["conflict"]["message"]
    scales = [state["wires"][port][0]["scale"] for port in ("pan_logging", "tilt_logging")]
    assert scales == ["", "3"], "the draft is as it was"
    page.post("save", anyway=True)
    assert "by an editor" not in bindings.read_text() and "scale: 3" in bindings.read_text()


def test_a_change_that_changes_nothing_is_none(page: Page) -> None:
    state = page.connect("pwm_pan", "pwm_pan")
    assert not state["draft"]["changed"] and not state["draft"]["can_undo"]
    page.post("disconnect", port="pwm_pan")
    page.post("disconnect", port="pwm_pan")
    assert not page.post("undo")["draft"]["can_undo"]


def test_a_conflict_ends_by_reloading(page: Page, bindings: Path) -> None:
    good = bindings.read_text()
    page.connect("setpoint_pan", "tilt_subscriber")
    bindings.write_text("inputs: {")
    page.until(lambda state: state["draft"]["conflict"])
    state = page.post("reload")
    assert state["draft"]["conflict"] is None and not state["editable"]
    assert "robot.bindings.yaml" in state["why_not"]
    with pytest.raises(Denied, match=r"robot\.bindings\.yaml"):
        page.connect("setpoint_pan", "tilt_subscriber")
    bindings.write_text(good)
    assert page.until(lambda state: state["editable"])["diagnostics"] == []


def test_nothing_is_saved_over_what_nobody_has_seen(page: Page, bindings: Path) -> None:
    """An edit from outside between the last read and the save is applied first and not lost."""
    page.connect("setpoint_pan", "tilt_subscriber")
    bindings.write_text(bindings.read_text() + "# the last moment\n")
    page.post("save")
    assert bindings.read_text().endswith("# the last moment\n")
    assert "setpoint_pan: tilt_subscriber" in bindings.read_text()


def test_a_model_that_was_exported_again(project: Path, bindings: Path) -> None:
    shutil.rmtree(project / "model")
    model = Path(shutil.copytree(ROOT / "examples/ping_pong/model", project / "model"))
    bindings.write_text("version: 1\nmodel: Idle\noutputs: {steps: pan_publisher}\n")
    with serving(session_of(project)) as page:
        assert [port["name"] for port in page.state()["model"]["outputs"]] == ["steps"]
        header, description = model / "idle.h", model / "model.yaml"
        header.write_text(header.read_text().replace("double steps;", "double steps;\n    double angle;"))
        description.write_text(description.read_text() + "  angle: {unit: rad}\n")
        state = page.until(lambda state: state["model"] and len(state["model"]["outputs"]) == 2)
        assert state["model"]["outputs"][1] == {"name": "angle", "unit": "rad", "type": "real", "description": ""}
        assert "'model.yaml'" in state["draft"]["external"] and not state["draft"]["changed"]
        assert [each["port"] for each in state["diagnostics"] if each["id"] == "unbound-output"] == ["angle"]
        assert "tilt_publisher" in state["candidates"]["angle"]
        page.connect("angle", "tilt_publisher")

        description.write_text(description.read_text().replace("  steps: {}\n", ""))
        state = page.until(lambda state: state["model"] and len(state["model"]["outputs"]) == 1)
        assert [each["port"] for each in state["diagnostics"] if each["id"] == "unknown-port"] == ["steps"]
        assert "steps" not in page.post("disconnect", port="steps")["wires"]
        page.post("save")
    assert bindings.read_text() == "version: 1\nmodel: Idle\noutputs: {angle: tilt_publisher}\n"


def test_a_file_of_the_model_that_comes_to_lie_beside_it(page: Page, project: Path) -> None:
    (project / "model" / "xxtypes.h").rename(project / "types.bak")
    state = page.until(lambda state: state["model"] is None)
    assert {each["id"] for each in state["diagnostics"]} == {"model-file-missing"}
    (project / "common").mkdir()
    (project / "types.bak").rename(project / "common" / "xxtypes.h")
    state = page.until(lambda state: state["model"] is not None)
    assert [(each["severity"], each["id"]) for each in state["diagnostics"]] == [("note", "model-neighbour")]


def test_bindings_that_are_not_there_yet(project: Path, bindings: Path) -> None:
    bindings.unlink()
    with serving(session_of(project)) as page:
        state = page.state()
        assert state["editable"] and state["wires"] == {} and len(state["proposals"]) == 10
        assert {each["id"] for each in state["diagnostics"]} == {"unbound-input", "unbound-output", "needs-bound"}
        state = page.post("accept")
        assert state["diagnostics"] == []
        page.post("save")
    assert bindings.read_text().startswith("version: 1\nmodel: JIWY_Control\ninputs:\n")


def test_another_configuration_is_chosen(page: Page, project: Path) -> None:
    state = page.until(lambda state: state["configurations"])
    by_name = {each["name"]: each for each in state["configurations"]}
    assert [name for name, each in by_name.items() if each["chosen"]] == ["rpi_pico_bare_metal_jiwy"]
    assert by_name["rpi_pico_bare_metal_jiwy"]["matches"] == 10 and by_name["rpi_pico_bare_metal_jiwy"]["ports"] == 10
    assert by_name["rpi_pico_bare_metal_relbot"]["possible"]
    assert by_name["rpi_pico_freertos_jiwy"]["possible"] and by_name["host_jiwy"]["possible"]
    assert "components of a robot" in by_name["rpi_pico_bare_metal"]["reason"]
    original = (project / "robot.tcf").read_text()
    state = page.post("choose", configuration="rpi_pico_bare_metal_relbot")
    assert (project / "robot.tcf").read_text() == original
    assert [each["name"] for each in state["configurations"] if each["chosen"]] == ["rpi_pico_bare_metal_relbot"]
    assert {each["id"] for each in state["diagnostics"]} >= {"unknown-component"}
    page.post("save")
    changed = (project / "robot.tcf").read_text()
    assert changed == original.replace(
        "extends: rpi_pico_bare_metal_jiwy.tcf", "extends: rpi_pico_bare_metal_relbot.tcf"
    )
    page.post("undo")
    page.post("save")
    assert (project / "robot.tcf").read_text() == original
    with pytest.raises(Denied) as refusal:
        page.post("choose", configuration="rpi_pico_bare_metal")
    assert refusal.value.status == 409 and "components of a robot" in refusal.value.hint


def test_configurations_of_the_user_are_listed(project: Path, tmp_path: Path) -> None:
    """Valid ones can be chosen, invalid ones show the reason, and parts that others extend are not offered."""
    robots = tmp_path / "targets/robots/mine"
    robots.mkdir(parents=True)
    (robots / "mine.tcf").write_text("version: 1\nextends: rpi_pico_bare_metal_jiwy.tcf\nnode: mine\n")
    (robots / "wrong.tcf").write_text("version: 1\nextends: rpi_pico_bare_metal_jiwy.tcf\nnodes: mine\n")
    (robots / "part.tcf").write_text("version: 1\nnode: mine\n")
    (robots / "broken.tcf").write_text("{")
    (robots / "loop.tcf").write_text("version: 1\nextends: loop.tcf\n")
    jobs = find_jobs(project, Diagnostics())
    jobs = [replace(job, request=replace(job.request, user_roots=(tmp_path / "targets",))) for job in jobs]
    with serving(Session(jobs, user_roots=(tmp_path / "targets",))) as page:
        state = page.until(lambda state: state["configurations"])
        mine = {each["name"]: each for each in state["configurations"] if each["robot"] == "mine"}
        assert set(mine) == {"mine", "wrong"}
        assert mine["mine"]["possible"] and mine["mine"]["components"] == 10
        assert not mine["wrong"]["possible"] and "unknown key 'nodes'" in mine["wrong"]["reason"]
        assert not mine["wrong"]["picture"] and mine["wrong"]["matches"] == 0
        page.get("picture/wiring.svg?configuration=mine")
        for name in ("wrong", "part", "jiwy", "nothing"):
            with pytest.raises(Denied) as refusal:
                page.get(f"picture/wiring.svg?configuration={name}")
            assert refusal.value.status == 404
        state = page.post("choose", configuration="mine")
        assert [each["name"] for each in state["configurations"] if each["chosen"]] == ["mine"]
        assert state["diagnostics"] == []


def test_a_predefined_configuration_stays() -> None:
    with serving(session_of(ROOT / "examples/jiwy")) as page:
        state = page.until(lambda state: state["configurations"])
        reasons = {each["reason"] for each in state["configurations"] if not each["chosen"]}
        assert all("extends: host_jiwy.tcf" in reason for reason in reasons)


def test_a_project_is_created_for_a_model(tmp_path: Path) -> None:
    model = Path(shutil.copytree(ROOT / "examples/jiwy/model", tmp_path / "pan tilt"))
    with serving(Session([], model=model)) as page:
        state = page.until(lambda state: state["configurations"])
        assert state["phase"] == "choose" and state["project"] is None
        assert state["create"] == {"folder": str(tmp_path / "pan tilt_project"), "name": "pan_tilt_project"}
        assert state["model"]["name"] == "JIWY_Control"
        possible = {each["name"] for each in state["configurations"] if each["possible"]}
        assert {"rpi_pico_bare_metal_jiwy", "host_jiwy", "rpi_pico_bare_metal"} <= possible
        svg, headers = page.get("picture/wiring.svg?configuration=rpi_pico_bare_metal_jiwy")
        assert svg.startswith(b"<svg") and headers["Content-Type"] == "image/svg+xml"
        with pytest.raises(Denied, match="choose a target") as refusal:
            page.connect("position_pan", "encoder_pan")
        assert refusal.value.status == 409

        folder = tmp_path / "new robot"
        for body, words in (
            ({"configuration": "rpi_pico_bare_metal_jiwy", "folder": str(folder), "name": "int"}, "int"),
            ({"configuration": "rpi_pico", "folder": str(folder), "name": "robot"}, "no target 'rpi_pico'"),
            ({"configuration": "host_jiwy", "folder": "", "name": "robot"}, "'folder' is empty"),
        ):
            with pytest.raises(Denied, match=words):
                page.post("create", **body)
            assert not folder.exists()
        state = page.post("create", configuration="rpi_pico_bare_metal_jiwy", folder=str(folder), name="robot")
        assert state["phase"] == "connect" and state["project"]["folder"] == str(folder)
        assert state["diagnostics"] == [] and state["create"] is None
        assert (folder / "CMakeLists.txt").is_file() and (folder / "model").is_dir()
        state = page.connect("setpoint_pan", "tilt_subscriber")
        page.post("save")
        assert "setpoint_pan: tilt_subscriber" in (folder / "robot.bindings.yaml").read_text()


def test_a_project_of_topics_is_created_for_a_target(tmp_path: Path) -> None:
    """Without a robot, every port is a topic, until the user describes the parts that are wired to the board."""
    with serving(Session([], model=ROOT / "examples/jiwy/model")) as page:
        body = {"configuration": "rpi_pico_bare_metal", "folder": str(tmp_path / "pico"), "middleware": "console"}
        state = page.post("create", name="robot", **body)
        assert state["phase"] == "connect" and state["diagnostics"] == [] and len(state["wires"]) == 10
        state = page.until(lambda state: state["configurations"])
        assert [each["name"] for each in state["configurations"] if each["chosen"]] == ["rpi_pico_bare_metal"]
        for each in state["configurations"]:
            expected = "this project has components of its own" if each["robot"] else ""
            assert each["reason"].split(":")[0] == expected


def test_creating_replaces_nothing(tmp_path: Path) -> None:
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot/CMakeLists.txt").write_text("mine")
    with serving(Session([], model=ROOT / "examples/jiwy/model")) as page:
        with pytest.raises(Denied, match=r"CMakeLists\.txt: this file exists") as refusal:
            page.post("create", configuration="host_jiwy", folder=str(tmp_path / "robot"), name="robot")
        assert "does not replace files" in refusal.value.hint
        assert page.state()["phase"] == "choose"
    assert [path.name for path in (tmp_path / "robot").iterdir()] == ["CMakeLists.txt"]


def test_another_target_of_the_project_is_opened(project: Path) -> None:
    lists = project / "CMakeLists.txt"
    call = "epg_add_target(second TCF robot.tcf MODEL model BINDINGS second.bindings.yaml)\n"
    lists.write_text(lists.read_text() + call)
    with serving(session_of(project)) as page:
        assert page.state()["project"]["targets"] == ["robot", "second"]
        page.connect("setpoint_pan", "tilt_subscriber")
        with pytest.raises(Denied, match="unsaved changes"):
            page.post("open", target="second")
        page.post("save")
        state = page.post("open", target="second")
        assert state["project"]["name"] == "second" and state["wires"] == {}
        with pytest.raises(Denied) as refusal:
            page.post("open", target="third")
        assert refusal.value.status == 404


def test_a_target_whose_call_is_edited(page: Page, project: Path) -> None:
    lists = project / "CMakeLists.txt"
    (project / "other.bindings.yaml").write_text("version: 1\nmodel: JIWY_Control\n")
    lists.write_text(lists.read_text().replace("BINDINGS robot.bindings.yaml", "BINDINGS other.bindings.yaml"))
    state = page.until(lambda state: state["wires"] == {})
    assert state["project"]["files"]["bindings"] == "other.bindings.yaml"
    assert "CMakeLists.txt" in state["draft"]["external"]

    page.connect("pwm_pan", "pwm_pan")
    lists.write_text(lists.read_text().replace("BINDINGS other.bindings.yaml", "BINDINGS robot.bindings.yaml"))
    state = page.until(lambda state: state["draft"]["external"])
    assert "save or reload" in state["draft"]["external"] and list(state["wires"]) == ["pwm_pan"]
    state = page.post("save")
    assert "pwm_pan: pwm_pan" in (project / "other.bindings.yaml").read_text()
    assert len(state["wires"]) == 10


@pytest.mark.parametrize(
    "body",
    [
        {"port": "pwm_pan"},
        {"port": "pwm_pan", "ends": "pwm_pan"},
        {"port": "pwm_pan", "ends": ["pwm_pan"]},
        {"port": "pwm_pan", "ends": [{"reference": 1}]},
        {"port": "pwm_pan", "ends": [{"reference": "a\nb"}]},
        {"port": "pwm_pan", "ends": [{"reference": "pwm_pan", "limits": [1]}]},
        {"port": "pwm_pan", "ends": [{"reference": "pwm_pan", "scale": []}]},
        {"port": "pwm_pan", "ends": [{"reference": "\ud800"}]},
        {"port": "no_port", "ends": [{"reference": "pwm_pan"}]},
        {"port": 5, "ends": []},
        {"ends": []},
    ],
)
def test_what_makes_no_sense_changes_nothing(page: Page, body: dict[str, object]) -> None:
    with pytest.raises(Denied) as refusal:
        page.post("connect", **body)
    assert refusal.value.status == 400
    assert not page.state()["draft"]["changed"]


def test_an_answer_comes_at_once(tmp_path: Path) -> None:
    """Each step checks the whole target, but so fast that a user who drags a wire does not wait."""
    folder = Path(shutil.copytree(ROOT / "examples/jiwy", tmp_path / "jiwy"))
    text = (folder / "CMakeLists.txt").read_text()
    (folder / "CMakeLists.txt").write_text(text.replace('"${CMAKE_CURRENT_SOURCE_DIR}/../.."', f'"{ROOT.as_posix()}"'))
    with serving(session_of(folder)) as page:
        page.until(lambda state: state["configurations"])
        times = []
        for number in range(9):
            times.append(time.process_time())  # processor time of an edit, with the server's threads
            page.connect("setpoint_pan", "tilt_subscriber", scale=number + 1)
        assert min(after - before for before, after in itertools.pairwise(times)) < 0.5
