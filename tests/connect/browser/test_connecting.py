# SPDX-License-Identifier: Apache-2.0
"""Wires by pointer, by list and by keyboard; after Save, the bindings file has the wires that the page shows."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.connect.robots import jiwy_export_project, new_project

from .acts import drag, field, handle, port, save, until
from .conftest import Project, copy_jiwy
from .served import ROOT, Served

Open = Callable[..., Any]
UNBOUND = ("  position_tilt: encoder_tilt\n", "")
FREE = ("  pwm_tilt: pwm_tilt\n", "")


def check_says(tcf: Path | str, folder: Path, bindings: Path) -> list[dict[str, Any]]:
    """The diagnostics of ``epg check`` for the saved files."""
    command = [
        sys.executable, "-m", "epg", "check", "--json", "--tcf", str(tcf),
        "--model", str(folder / "model"), "--bindings", str(bindings),
    ]  # fmt: skip
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, encoding="utf-8", check=False)
    found: list[dict[str, Any]] = json.loads(done.stdout)["diagnostics"]
    return found


def test_shows_what_the_files_say(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address)
    state = jiwy.epg.state()
    page.locator(".wire-group").nth(len(state["wires"]) - 1).wait_for()
    assert page.locator(".wire-group").count() == 10
    for side in ("inputs", "outputs"):
        names = page.locator(f".ports.{side} .port-name").all_inner_texts()
        assert names == [each["name"] for each in state["model"][side]]
    assert {name: field(page, name).input_value() for name in state["wires"]} == {
        name: f":{ends[0]['reference']}" for name, ends in state["wires"].items()
    }
    assert page.get_by_text("No problems", exact=True).is_visible()
    assert "step 1 ms" in page.locator(".model-head").inner_text()
    assert not page.get_by_role("button", name="Save", exact=True).is_enabled()


@pytest.mark.parametrize("backwards", [False, True])
def test_connects_by_drag(jiwy: Project, open_page: Open, backwards: bool) -> None:
    """From the component to the model and back; during the drag, the page marks the ports that fit."""
    before = jiwy.write(UNBOUND)
    page = open_page(jiwy.address)
    ends = [handle(page, "sources", "encoder_tilt"), handle(page, "inputs", "position_tilt")]
    if backwards:
        ends.reverse()

    def marks() -> None:
        side = "sources" if backwards else "inputs"
        marked = page.locator(f'.port.fits[data-side="{side}"]')
        candidates = jiwy.epg.state()["fits"]
        if backwards:
            expected = set(candidates["position_tilt"])
        else:
            inputs = [each["name"] for each in jiwy.epg.state()["model"]["inputs"]]
            expected = {name for name in inputs if "encoder_tilt" in candidates[name]}
        assert {each.get_attribute("data-name") for each in marked.all()} == expected
        assert page.locator(".port.fits[data-side=sinks], .port.fits[data-side=outputs]").count() == 0
        assert page.locator("path.wire.held").count() == 1

    drag(page, *ends, halfway=marks)
    page.get_by_text("● Unsaved").wait_for()
    assert field(page, "position_tilt").input_value() == ":encoder_tilt"
    assert jiwy.text() == before, "nothing is written before Save"
    save(page)
    lines = jiwy.text().splitlines()
    assert "  position_tilt: encoder_tilt" in lines
    assert [line for line in lines if "position_tilt" not in line] == before.splitlines()


def test_drag_beside_a_port_changes_nothing(jiwy: Project, open_page: Open) -> None:
    jiwy.write(UNBOUND)
    page = open_page(jiwy.address)
    drag(page, handle(page, "sources", "encoder_tilt"), page.locator(".model-head h2"))
    drag(page, handle(page, "sources", "encoder_tilt"), handle(page, "sources", "encoder_pan"))
    page.mouse.move(5, 5)
    assert page.locator(".wire.held").count() == 0
    assert not jiwy.epg.state()["draft"]["changed"]


def test_drag_of_an_output_adds_an_end(jiwy: Project, open_page: Open) -> None:
    jiwy.write(("  tilt_logging: tilt_publisher\n", "  tilt_logging: unconnected\n"))
    page = open_page(jiwy.address, viewport={"width": 1280, "height": 1200})
    drag(page, handle(page, "outputs", "pan_logging"), handle(page, "sinks", "tilt_publisher"))
    page.get_by_role("combobox", name="pan_logging, end 2").wait_for()
    save(page)
    assert "  pan_logging: [pan_publisher, tilt_publisher]" in jiwy.text()


@pytest.mark.parametrize(
    ("side", "name", "other", "lines"),
    [
        ("sinks", "pan_publisher", "tilt_publisher", ["pan_logging: {to: tilt_publisher, scale: 2}"]),
        ("sources", "pan_subscriber", "encoder_pan", ["setpoint_pan: encoder_pan"]),
        ("inputs", "setpoint_pan", "setpoint_tilt", ["setpoint_tilt: pan_subscriber"]),
        ("outputs", "pan_logging", "pwm_tilt", ["pwm_tilt: [pwm_tilt, {to: pan_publisher, scale: 2}]"]),
    ],
)
def test_the_end_of_a_wire_is_moved(
    jiwy: Project, open_page: Open, side: str, name: str, other: str, lines: list[str]
) -> None:
    """By its handle, to a port of the same side, with its conversion.  A wire of the other port gives way."""
    jiwy.write(("  pan_logging: pan_publisher", "  pan_logging: {to: pan_publisher, scale: 2}"))
    page = open_page(jiwy.address, viewport={"width": 1280, "height": 1200})
    count = page.locator(".wire-group").count()
    drag(page, handle(page, side, name), handle(page, side, other))
    page.get_by_text("● Unsaved").wait_for()
    assert page.locator(".wire-group").count() == (count if name in ("pan_logging", "pan_subscriber") else count - 1)
    save(page)
    text = jiwy.text()
    assert all(f"  {line}\n" in text for line in lines), text
    page.get_by_role("button", name="Undo").click()
    until(page, f"document.querySelectorAll('.wire-group').length === {count}")


def test_a_new_wire_replaces_the_other_driver(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address, viewport={"width": 1280, "height": 1200})
    drag(page, handle(page, "outputs", "tilt_logging"), handle(page, "sinks", "pwm_tilt"))
    page.get_by_text("● Unsaved").wait_for()
    wires = jiwy.epg.state()["wires"]
    assert [end["reference"] for end in wires["tilt_logging"]] == ["tilt_publisher", "pwm_tilt"]
    assert "pwm_tilt" not in wires
    page.get_by_role("button", name="Undo").click()
    page.get_by_text("Saved", exact=True).wait_for()


def test_connects_by_list(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address)
    options = field(page, "position_tilt").locator("option").all_inner_texts()
    assert options[0] == "(not connected)"
    assert options[1:] == jiwy.epg.state()["candidates"]["position_tilt"], "all fit"
    field(page, "position_tilt").select_option("encoder_pan")
    page.get_by_text("● Unsaved").wait_for()
    field(page, "setpoint_pan").select_option("")
    field(page, "pan_logging").select_option("unconnected on purpose")
    page.get_by_role("button", name="Connect pwm_pan to another component").click()
    page.get_by_role("combobox", name="pwm_pan, end 2").select_option("pan_publisher")
    page.get_by_role("button", name="Connect pwm_pan to another component").wait_for()
    save(page)
    text = jiwy.text()
    for line in ("position_tilt: encoder_pan", "pan_logging: unconnected", "pwm_pan: [pwm_pan, pan_publisher]"):
        assert f"  {line}\n" in text
    assert "setpoint_pan" not in text
    assert text.startswith("# yaml-language-server"), "comments are kept"


def test_connects_by_keyboard(jiwy: Project, open_page: Open) -> None:
    """Picked up with Enter, moved with arrows, dropped with Enter; a screen reader announces each step."""
    jiwy.write(FREE)
    page = open_page(jiwy.address)
    start = handle(page, "outputs", "pan_logging")
    start.focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    assert page.evaluate("document.activeElement.dataset.name") == "pwm_tilt"
    page.keyboard.press("Enter")
    until(page, "document.getElementById('said').textContent.startsWith('pwm_tilt is picked up')")
    page.keyboard.press("ArrowDown")
    while page.evaluate("document.activeElement.dataset.name") != "pwm_tilt":
        page.keyboard.press("ArrowDown")
    assert page.evaluate("document.activeElement.dataset.side") == "sinks"
    until(page, "/sink pwm_tilt,.*: fits$/.test(document.getElementById('said').textContent)")
    page.keyboard.press("Enter")
    until(page, "document.getElementById('said').textContent.includes('is connected with pwm_tilt')")
    assert page.evaluate("document.activeElement.id") == "handle-outputs-pwm_tilt"
    page.keyboard.press("Control+s")
    page.get_by_text("Saved", exact=True).wait_for()
    assert "  pwm_tilt: pwm_tilt\n" in jiwy.text()

    page.keyboard.press("Enter")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Escape")
    assert page.evaluate("document.activeElement.dataset.side") == "outputs", "put back"
    page.keyboard.press("Delete")
    page.get_by_text("● Unsaved").wait_for()
    assert "pwm_tilt" not in jiwy.epg.state()["wires"]


def test_connects_by_two_clicks(jiwy: Project, open_page: Open) -> None:
    """For users who cannot drag, and for screen readers, whose activation is a click."""
    jiwy.write(FREE)
    page = open_page(jiwy.address)
    handle(page, "sinks", "pwm_tilt").click()
    assert handle(page, "sinks", "pwm_tilt").get_attribute("aria-pressed") == "true"
    page.locator(".model-head h2").click()
    assert handle(page, "sinks", "pwm_tilt").get_attribute("aria-pressed") == "false", "put back"
    handle(page, "sinks", "pwm_tilt").click()
    handle(page, "outputs", "pwm_tilt").click()
    until(page, "document.getElementById('ends-pwm_tilt-0').value === ':pwm_tilt'")
    assert page.locator(".holding").count() == 0


def test_takes_proposals(jiwy: Project, open_page: Open) -> None:
    jiwy.write(UNBOUND, FREE, ("  tilt_logging: tilt_publisher\n", ""))
    page = open_page(jiwy.address)
    page.locator("path.wire.proposed").nth(1).wait_for()
    proposed = jiwy.epg.state()["proposals"]
    assert page.locator("path.wire.proposed").count() == len(proposed) >= 2
    page.get_by_role("button", name="Accept encoder_tilt for position_tilt").click()
    page.locator(".ports .port[data-name=position_tilt] .handle.connected").wait_for()
    page.get_by_role("button", name="Accept all").click()
    page.locator("path.wire.proposed").first.wait_for(state="detached")
    save(page)
    assert "  position_tilt: encoder_tilt\n" in jiwy.text()
    assert "  pwm_tilt: pwm_tilt\n" in jiwy.text()


@pytest.mark.parametrize(
    ("side", "name", "other", "message"),
    [
        ("inputs", "position_tilt", "pwm_pan", "direction"),
        ("inputs", "setpoint_pan", "encoder_pan", "unit"),
        ("outputs", "tilt_logging", "pwm_tilt", "twice"),
    ],
)
def test_conflicts_have_the_words_of_the_command_line(
    jiwy: Project, open_page: Open, side: str, name: str, other: str, message: str
) -> None:
    """Shown at the port, in the list and in the header; the list's entry leads back to the port."""
    if message == "direction":
        jiwy.write(("  position_tilt: encoder_tilt", f"  position_tilt: {other}"))
        page = open_page(jiwy.address)
    elif message == "unit":
        jiwy.write((f"  {name}: pan_subscriber", f"  {name}: {{from: pan_subscriber, unit: V}}"))
        page = open_page(jiwy.address)
    else:
        page = open_page(jiwy.address, viewport={"width": 1280, "height": 1200})
        field(page, name).select_option(other)
        page.get_by_text("● Unsaved").wait_for()
        twice = port(page, other).get_by_text("already driven")
        twice.wait_for()  # at both ports: the user need not know which one comes first in the file
        save(page)
    found = check_says("host_jiwy.tcf", jiwy.folder, jiwy.file)
    assert found
    for each in found:
        if each["id"].startswith("unbound"):
            continue
        assert page.get_by_role("tabpanel").get_by_text(each["message"], exact=True).is_visible()
        assert page.get_by_role("tabpanel").get_by_text(each["hint"], exact=True).first.is_visible()
    listed = page.locator(".problem-list .message").all_inner_texts()
    assert listed == [each["message"] for each in found]
    errors = sum(each["severity"] == "error" for each in found)
    assert page.locator("#header .problems-count").inner_text().startswith(f"{errors} error")
    at_port = next(each for each in jiwy.epg.state()["diagnostics"] if each["port"] == name)
    assert port(page, name).get_by_text(at_port["message"]).is_visible()
    page.locator(".problem-list").get_by_text(at_port["message"], exact=True).click()
    assert page.evaluate("document.activeElement.id") == field(page, name).get_attribute("id")


def test_what_does_not_fit_can_be_dropped(browser: Any, open_page: Open, tmp_path: Path) -> None:
    """A type and a unit that no list offers: marked during the drag, and judged with the command line's message."""
    (tmp_path / "model").mkdir()
    (tmp_path / "model/lamp.h").write_text(
        "#include <stdbool.h>\ntypedef struct { bool on; double volts; } in_t;\n"
        "typedef struct { double light; } out_t;\n"
        "void lamp(const in_t *in, out_t *out);\n",
        encoding="utf-8",
    )
    (tmp_path / "model/lamp.c").write_text('#include "lamp.h"\nvoid lamp(const in_t *in, out_t *out) {}\n', "utf-8")
    (tmp_path / "model/model.yaml").write_text(
        "version: 1\nstep: 1 ms\nheader: lamp.h\nsources: [lamp.c]\ntypes: {inputs: in_t, outputs: out_t}\n"
        "functions: {step: lamp}\ninputs: {on: {type: boolean}, volts: {unit: V}}\noutputs: {light: {}}\n",
        encoding="utf-8",
    )
    tcf, bindings = tmp_path / "lamp.tcf", tmp_path / "lamp.bindings.yaml"
    tcf.write_text(
        "version: 1\ntarget: host\nnode: lamp\ncontrol: {enable_at_start: true}\ncomponents:\n"
        "  knob: {kind: quadrature_encoder, counts_per_revolution: 400}\n"
        "  light: {kind: ros_publisher, topic: light}\n",
        encoding="utf-8",
    )
    bindings.write_text("version: 1\nmodel: model\noutputs: {light: light}\n", encoding="utf-8")
    with Served("--tcf", tcf, "--model", tmp_path / "model", "--bindings", bindings) as epg:
        page = open_page(epg.address)

        def marks() -> None:
            assert page.locator(".port.fits").count() == 0
            assert page.locator('.port.other[data-side="inputs"]').count() == 2

        for name in ("on", "volts"):
            assert port(page, name).locator("optgroup option").all_inner_texts() == ["knob"]
            drag(page, handle(page, "sources", "knob"), handle(page, "inputs", name), halfway=marks)
            until(page, f"document.getElementById('ends-{name}-0').value === ':knob'")
        save(page)
        found = check_says(tcf, tmp_path, bindings)
        assert {each["id"] for each in found} == {"wrong-port-type", "unit-mismatch"}
        for each, name in zip(found, ("on", "volts"), strict=True):
            assert port(page, name).get_by_text(each["message"]).is_visible()
            assert port(page, name).get_by_text(each["hint"]).is_visible()


def test_a_message_without_a_port_shows_its_line(jiwy: Project, open_page: Open) -> None:
    jiwy.write(("  encoder_reset_tilt: encoder_tilt.reset\n", "  encoder_reset_tilt: unconnected\n"))
    page = open_page(jiwy.address)
    page.locator(".problem-list").get_by_text("'homing' needs").click()
    dialog = page.get_by_role("dialog")
    dialog.wait_for()
    assert "homing: {travel: 110 deg, time: 10 s}" in dialog.locator(".line.here").first.inner_text()
    assert dialog.locator("pre").count() == 1, "no file of the user's extends it"
    page.keyboard.press("Escape")
    dialog.wait_for(state="detached")


def test_a_proposed_edit_is_applied(jiwy: Project, open_page: Open) -> None:
    right = jiwy.text()
    jiwy.write(("  pwm_tilt: pwm_tilt\n", "  pwm_tilt: pwm_tlit\n"))
    page = open_page(jiwy.address)
    page.get_by_role("button", name="Apply: replace pwm_tlit by pwm_tilt").click()
    page.get_by_text("No problems", exact=True).wait_for()
    assert page.get_by_role("button", name="Apply: replace").count() == 0
    save(page)
    assert jiwy.text() == right


def test_each_remedy_of_homing_is_a_button(open_page: Open, tmp_path: Path) -> None:
    """A controller without an output for the reset has one remedy for each guard, one that has it two."""
    folder = jiwy_export_project(tmp_path)
    with Served(folder) as served:
        served.post("accept")
        page = open_page(served.address)
        apply = page.get_by_role("button", name="Apply: ")
        for name in ("guard_pan", "guard_tilt"):
            assert apply.all_inner_texts() == ["Apply"] * (2 if name == "guard_pan" else 1)
            page.get_by_role("button", name=f"Apply: write 'homing: null' in '{name}' of robot.tcf").click()
            page.get_by_role("button", name=f"Apply: write 'homing: null' in '{name}'").wait_for(state="detached")
        assert {each["severity"] for each in served.state()["diagnostics"]} == {"warning"}
        save(page)
    assert "guard_pan: {homing: null}\n  guard_tilt: {homing: null}\n" in (folder / "robot.tcf").read_text()


def test_two_remedies_are_two_buttons(open_page: Open, tmp_path: Path) -> None:
    folder = new_project(tmp_path / "robot", "host_jiwy")
    bindings = folder / "robot.bindings.yaml"
    right = bindings.read_text()
    bindings.write_text(right.replace("encoder_tilt.reset", "unconnected"))
    sentences = ["write 'encoder_reset_tilt: encoder_tilt.reset'", "write 'homing: null' in 'guard_tilt' of robot.tcf"]
    with Served(folder) as served:
        page = open_page(served.address)
        buttons = page.get_by_role("button", name="Apply: ")
        buttons.first.wait_for()
        assert buttons.all_inner_texts() == [f"Apply: {sentence}" for sentence in sentences]
        buttons.first.click()
        page.get_by_text("No problems", exact=True).wait_for()
        save(page)
    assert bindings.read_text() == right


def test_conversion(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address)
    page.get_by_role("button", name="Conversion from encoder_pan to position_pan: none").click()
    dialog = page.get_by_role("dialog", name="encoder_pan → position_pan")
    assert page.evaluate("document.activeElement.name") == "scale"
    assert dialog.get_by_role("status").inner_text() == "0 rad → 0 rad, 1 rad → 1 rad"
    dialog.get_by_label("Unit").fill("deg")
    assert dialog.get_by_role("status").inner_text() == "0 rad → 0 deg, 1 rad → 57.2958 deg"
    dialog.get_by_label("Unit").fill("")
    dialog.get_by_label("Scale").fill("one half")
    assert dialog.get_by_role("status").inner_text() == ""
    dialog.get_by_role("button", name="Apply").click()
    dialog.get_by_role("alert").wait_for()
    (wrong,) = jiwy.epg.state()["diagnostics"]
    assert wrong["message"] in dialog.get_by_role("alert").inner_text()
    dialog.get_by_label("Scale").fill("1/2")
    dialog.get_by_label("Offset").fill("0.1")
    dialog.get_by_label("Lowest").fill("-1")
    dialog.get_by_role("button", name="Apply").click()
    dialog.get_by_text("Limits need both").wait_for()
    dialog.get_by_label("Highest").fill("1")
    assert dialog.get_by_role("status").inner_text() == "0 rad → 0.1 rad, 1 rad → 0.6 rad"
    page.keyboard.press("Enter")
    dialog.wait_for(state="detached")
    assert page.locator(".wire-label").filter(has_text="×1/2 +0.1 in -1…1").is_visible()
    save(page)
    written = yaml.safe_load(jiwy.text())["inputs"]["position_pan"]
    assert written == {"from": "encoder_pan", "scale": "1/2", "offset": 0.1, "limits": [-1, 1]}


def test_conversions_of_the_tcf_and_of_units(jiwy: Project, open_page: Open, tmp_path: Path) -> None:
    """Conversions of the .tcf are shown at the component, those of the wire on the wire, with the units between."""
    tcf = tmp_path / "deg.tcf"
    tcf.write_text(
        "version: 1\nextends: host_jiwy.tcf\ncomponents:\n  encoder_pan: {unit: deg}\n  pwm_pan: {scale: 0.5}\n",
        encoding="utf-8",
    )
    with Served("--tcf", tcf, "--model", jiwy.folder / "model", "--bindings", jiwy.file) as epg:
        page = open_page(epg.address)
        wires = epg.state()["wires"]
        (pan,), (duty,) = wires["position_pan"], wires["pwm_pan"]
        assert pan["text"] == "deg → rad" and duty["from_tcf"] == "×0.5"
        assert port(page, "position_pan").locator(".wire-label").inner_text() == pan["text"]
        source = page.locator('.sources .port[data-name="encoder_pan"]')
        assert source.locator(".unit").inner_text() == "deg"
        assert source.locator(".tcf-label").inner_text() == f".tcf: {pan['from_tcf']}"
        assert page.locator('.sinks .port[data-name="pwm_pan"] .tcf-label').inner_text() == ".tcf: ×0.5"
        port(page, "pwm_pan").locator(".wire-label").click()
        assert "×0.5" in page.get_by_role("dialog", name="pwm_pan → pwm_pan").inner_text()


def test_pictures_stay_while_there_are_errors(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address)
    page.get_by_role("tab", name="Application").click()
    until(page, "document.querySelector('img.picture')?.naturalWidth > 0")
    field(page, "position_pan").select_option("")
    page.get_by_text("This is the picture before them").wait_for()
    assert page.locator("img.picture.old").is_visible()
    page.get_by_role("tab", name="Schedule").click()
    page.get_by_text("The picture is drawn when the errors are corrected.").wait_for()
    page.get_by_role("button", name="Undo").click()
    until(page, "document.querySelector('img.picture:not(.old)')?.naturalWidth > 0")


def test_undo_and_redo(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address)
    field(page, "position_tilt").select_option("encoder_pan")
    page.get_by_text("● Unsaved").wait_for()
    page.keyboard.press("Control+z")
    page.get_by_text("Saved", exact=True).wait_for()
    assert field(page, "position_tilt").input_value() == ":encoder_tilt"
    page.keyboard.press("Control+y")
    page.get_by_text("● Unsaved").wait_for()
    assert field(page, "position_tilt").input_value() == ":encoder_pan"
    page.get_by_role("button", name="Undo").click()
    page.get_by_text("Saved", exact=True).wait_for()
    page.get_by_role("button", name="Redo").click()
    page.get_by_text("● Unsaved").wait_for()
    page.get_by_role("tab", name="Changes").click()
    assert "+  position_tilt: encoder_pan" in page.get_by_role("tabpanel").inner_text()


def test_edits_outside_are_noticed(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address)
    jiwy.file.write_text(jiwy.text().replace("tilt: encoder_tilt", "tilt: encoder_pan"), encoding="utf-8")
    until(page, "document.getElementById('ends-position_tilt-0').value === ':encoder_pan'")
    notice = page.get_by_role("region", name="Notices")
    assert notice.inner_text()
    notice.get_by_role("button", name="Dismiss").click()
    page.locator(".bar").wait_for(state="detached")

    # There is an unsaved change: it is kept and applied to the new text.
    field(page, "pan_logging").select_option("unconnected on purpose")
    page.get_by_text("● Unsaved").wait_for()
    jiwy.file.write_text(jiwy.text().replace("tilt: encoder_pan", "tilt: encoder_tilt"), encoding="utf-8")
    until(page, "document.getElementById('ends-position_tilt-0').value === ':encoder_tilt'")
    assert field(page, "pan_logging").input_value() == "unconnected"
    save(page)
    assert "  pan_logging: unconnected\n" in jiwy.text() and "  position_tilt: encoder_tilt\n" in jiwy.text()


@pytest.mark.parametrize("choice", ["Load the file", "Overwrite the file"])
def test_conflict_with_an_edit_outside(jiwy: Project, open_page: Open, choice: str) -> None:
    page = open_page(jiwy.address)
    field(page, "position_tilt").select_option("encoder_pan")
    page.get_by_text("● Unsaved").wait_for()
    broken = jiwy.text().replace("inputs:\n", "inputs: [\n")
    jiwy.file.write_text(broken, encoding="utf-8")
    button = page.get_by_role("button", name=choice)
    button.wait_for()
    conflict = jiwy.epg.state()["draft"]["conflict"]
    assert page.get_by_role("alert").get_by_text(conflict["message"]).is_visible()
    button.click()
    button.wait_for(state="detached")
    if choice == "Overwrite the file":
        assert "  position_tilt: encoder_pan\n" in jiwy.text()
        assert page.get_by_text("Saved", exact=True).is_visible()
    else:
        assert jiwy.text() == broken
        page.get_by_text("Connections cannot be changed here").wait_for()


def test_state_elsewhere_keeps_focus_scroll_and_what_is_typed(jiwy: Project, open_page: Open) -> None:
    """The page is drawn again for every state, which must not disturb the user's actions."""
    page = open_page(jiwy.address, viewport={"width": 1280, "height": 620})
    page.get_by_role("button", name="Conversion from encoder_pan to position_pan").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Offset").fill("0.2")
    page.evaluate("document.getElementById('main').scrollTop = 60")
    page.evaluate("window.before = document.getElementById('ends-position_pan-0')")
    jiwy.epg.post("connect", port="position_tilt", ends=[{"reference": "encoder_pan"}])
    until(page, "document.getElementById('ends-position_tilt-0').value === ':encoder_pan'")
    assert dialog.get_by_label("Offset").input_value() == "0.2"
    assert page.evaluate("document.activeElement.name") == "offset"
    assert page.evaluate("document.getElementById('main').scrollTop") == 60
    assert page.evaluate("window.before === document.getElementById('ends-position_pan-0')")


def test_several_targets_of_one_project(browser: Any, open_page: Open, tmp_path: Path) -> None:
    """The page shows one target at a time; unsaved changes prevent a switch to another one."""
    folder = tmp_path / "two"
    copy_jiwy(folder)
    with (folder / "CMakeLists.txt").open("a", encoding="utf-8") as cmake:
        cmake.write("epg_add_target(second TCF host_jiwy.tcf MODEL model BINDINGS second.bindings.yaml)\n")
    text = (folder / "jiwy.bindings.yaml").read_text(encoding="utf-8")
    second = text.replace("pan_logging: pan_publisher", "pan_logging: unconnected")
    (folder / "second.bindings.yaml").write_text(second, encoding="utf-8")
    with Served(folder) as epg:
        page = open_page(epg.address)
        chooser = page.get_by_role("combobox", name="Project")
        assert chooser.locator("option").all_inner_texts() == ["jiwy", "second"]
        assert field(page, "pan_logging").input_value() == ":pan_publisher"
        field(page, "position_tilt").select_option("encoder_pan")
        page.get_by_text("● Unsaved").wait_for()
        chooser.select_option("second")
        page.get_by_role("alert").get_by_text("unsaved changes").wait_for()
        assert chooser.input_value() == "jiwy"
        save(page)
        chooser.select_option("second")
        until(page, "document.getElementById('ends-pan_logging-0').value === 'unconnected'")
        assert page.title() == "second – EPG"


def test_a_model_that_cannot_be_read(browser: Any, open_page: Open, tmp_path: Path) -> None:
    """The page shows the error, and works again when the model is corrected."""
    folder = tmp_path / "jiwy"
    copy_jiwy(folder)
    (folder / "model").rename(folder / "away")
    with Served(folder) as epg:
        page = open_page(epg.address)
        page.get_by_text("The model cannot be read. The tab Problems").wait_for()
        assert page.locator(".problem-list .message").count() == len(epg.state()["diagnostics"]) >= 1
        (folder / "away").rename(folder / "model")
        page.locator(".ports .port").first.wait_for()
