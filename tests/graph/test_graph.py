# SPDX-License-Identifier: Apache-2.0
"""``epg graph``: the pictures are complete, nothing overlaps, and the same target gives the same bytes."""

from __future__ import annotations

import itertools
import os
import re
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.graph.svg import Picture
from tests.graph.pictures import Line, Svg

ROOT = Path(__file__).resolve().parents[2]
WHAT = ("application", "schedule", "wiring")
DOCUMENTED = {f"jiwy-{what}.svg": (what, "rpi_pico2_freertos_jiwy", "jiwy") for what in WHAT} | {
    "jiwy-wiring-rpi_pico.svg": ("wiring", "rpi_pico_freertos_jiwy", "jiwy"),
    "jiwy-wiring-nucleo_h743zi.svg": ("wiring", "nucleo_h743zi_bare_metal_jiwy", "jiwy"),
}

BIG = """version: 1
target: rpi_pico_bare_metal
node: big_robot
namespace: /somewhere
control: {period: 1 ms, enable_at_start: false}
communication: {middleware: console, transport: usb, period: 20 ms}
components:
  encoder_a: {kind: quadrature_encoder, counts_per_revolution: 4096, pins: {a: 16, b: 17}}
  encoder_b: {kind: quadrature_encoder, counts_per_revolution: 4096, pins: {a: 0, b: 1}, scale: 0.5, offset: 0.1}
  motor_a: {kind: pwm_h_bridge, pins: {value: 22, direction_a: 3, direction_b: 21}}
  motor_b: {kind: pwm_h_bridge, pins: {value: 28, direction_a: 4, direction_b: 5}}
  relay_1: {kind: digital_output, pins: {value: 6}}
  relay_2: {kind: digital_output, pins: {value: 7}}
  relay_3: {kind: digital_output, pins: {value: 8}}
  led: {kind: digital_output, pins: {value: LED}}
  button: {kind: digital_input, pins: {value: 15}}
"""


def example(robot: str) -> list[str]:
    folder = ROOT / "examples" / robot
    return ["--model", str(folder / "model"), "--bindings", str(folder / f"{robot}.bindings.yaml")]


def draw(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    capsys.readouterr()
    assert main(["graph", *arguments]) == 0, capsys.readouterr().err
    return capsys.readouterr().out


@pytest.fixture
def big(tmp_path: Path) -> Path:
    path = tmp_path / "big.tcf"
    path.write_text(BIG, encoding="utf-8")
    return path


def assert_readable(svg: Svg) -> None:
    assert svg.overlaps() == []
    assert svg.outside() == []


def assert_lines_apart(lines: list[Line]) -> None:
    """Lines may cross, but must not overlap; ground lines may, because they are one net."""
    for one, other in itertools.combinations(lines, 2):
        if one.style == other.style == "earth":
            continue
        for (a, b), (c, d) in itertools.product(one.parts, other.parts):
            for axis in (0, 1):
                same = a[axis] == b[axis] == c[axis] == d[axis]
                first, second = sorted((a[1 - axis], b[1 - axis])), sorted((c[1 - axis], d[1 - axis]))
                overlap = min(first[1], second[1]) - max(first[0], second[0])
                assert not (same and overlap > 0), f"{one.title} lies on {other.title}"


@pytest.mark.parametrize("robot", ["jiwy", "relbot"])
@pytest.mark.parametrize("what", WHAT)
@pytest.mark.parametrize("target", ["rpi_pico2_freertos", "rpi_pico_bare_metal", "host"])
def test_pictures_are_readable(what: str, target: str, robot: str, capsys: pytest.CaptureFixture[str]) -> None:
    if target == "host" and what == "wiring":
        assert main(["graph", f"host_{robot}", "--what", "wiring"]) == 1
        return
    text = draw(capsys, f"{target}_{robot}", "--what", what, *example(robot))
    svg = Svg(text)
    assert_readable(svg)
    assert svg.root.attrib["role"] == "img"
    titles = {element.attrib["id"]: element.text for element in svg.root if "id" in element.attrib}
    assert titles.keys() == set(svg.root.attrib["aria-labelledby"].split())
    assert all(titles.values())
    assert "@media screen and (prefers-color-scheme: dark)" in text
    _, _, wide, high = svg.box
    assert f"size: A4 {'landscape' if wide > high else 'portrait'}" in text
    assert draw(capsys, f"{target}_{robot}", "--what", what, *example(robot)) == text


def test_every_wire_goes_from_its_contact_to_its_component(capsys: pytest.CaptureFixture[str]) -> None:
    svg = Svg(draw(capsys, "rpi_pico2_freertos_jiwy", "--what", "wiring"))
    wanted = {
        "encoder_pan a": 14,
        "encoder_pan b": 15,
        "encoder_tilt a": 16,
        "encoder_tilt b": 17,
        "pwm_pan value": 4,
        "pwm_pan direction_a": 10,
        "pwm_pan direction_b": 11,
        "pwm_tilt value": 6,
        "pwm_tilt direction_a": 7,
        "pwm_tilt direction_b": 9,
    }
    wires = [line for line in svg.lines if line.title]
    grounds = {f"ground of {name}" for name in ("encoder_pan", "encoder_tilt", "pwm_pan", "pwm_tilt")}
    assert {line.title.partition(":")[0] for line in wires} == wanted.keys() | grounds
    numbers = {text.text: text for text in svg.texts if text.text.isdigit()}
    assert len(numbers) == 40
    for name, contact in wanted.items():
        wire = svg.line(name)
        assert abs((numbers[str(contact)].top + numbers[str(contact)].bottom) / 2 - wire.points[0][1]) < 3
        signal = name.split()[1]
        ends = [text for text in svg.texts if text.text == signal and abs(text.bottom - wire.points[-1][1]) < 12]
        assert len(ends) == 1
        label = next(text for text in svg.texts if text.text == name)
        assert wire.points[1][0] < label.left and label.right < wire.points[0][0]
        assert label.bottom <= wire.points[0][1] < label.bottom + 5
    assert len({svg.line(ground).points[0] for ground in grounds}) == 4  # each has its own contact
    assert_lines_apart(wires)


def test_both_sides_few_grounds_and_what_is_on_the_board(big: Path, capsys: pytest.CaptureFixture[str]) -> None:
    svg = Svg(draw(capsys, str(big), "--what", "wiring"))
    assert_readable(svg)
    wires = [line for line in svg.lines if line.title]
    assert len(wires) == 14 + 10  # signals; a ground for each component on each side it has
    assert_lines_apart(wires)
    assert svg.line("motor_a value").points[0][0] > 0 > svg.line("motor_a direction_a").points[0][0]
    assert svg.words.count("pwm_h_bridge (part)") == 4
    assert "led value: GP25, the LED on the board" in svg.words
    assert svg.words.count("10 kΩ to ground") == 7


@pytest.mark.parametrize("name", ["rpi_pico", "rpi_pico2_w", "nucleo_f767zi", "nucleo_h743zi", "nucleo_h743zi2"])
def test_each_pin_of_a_board_has_one_contact(name: str) -> None:
    target = load_catalog(targets_roots([]), Diagnostics()).find_target(f"{name}_zephyr")
    assert target is not None and target.board.layout is not None
    shown = [contact.pin for row in target.board.layout.rows for contact in row.contacts]
    assert sorted(pin for pin in shown if pin in target.board.pins) == sorted(target.board.pins)


@pytest.mark.parametrize("board", ["nucleo_f767zi", "nucleo_h743zi", "nucleo_h743zi2"])
@pytest.mark.parametrize("robot", ["jiwy", "relbot"])
def test_boards_with_many_contacts_are_drawn_too(board: str, robot: str, capsys: pytest.CaptureFixture[str]) -> None:
    svg = Svg(draw(capsys, f"{board}_freertos_{robot}", "--what", "wiring"))
    assert_readable(svg)
    wires = [line for line in svg.lines if line.title]
    signals = [line for line in wires if line.style != "earth"]
    assert len(signals) == 10  # those of the ST-LINK's serial port are on the board
    assert_lines_apart(wires)
    assert any(word.endswith(", not to scale") for word in svg.words)
    assert "PE9 D6" in svg.words
    assert ("3V3" in svg.words) == (board != "nucleo_h743zi2")  # no open data describe its connectors
    assert any(word.endswith("PD8, the serial port of the ST-LINK") for word in svg.words)


def test_a_board_without_a_layout_gets_its_pins_in_rows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    board = tmp_path / "boards" / "plain"
    board.mkdir(parents=True)
    board.joinpath("board.yaml").write_text(
        "api: 1\nboard: plain\nsummary: a plain board\nsoc: rp2040\nsdks: {pico_sdk: pico}\npins: [0-4]\n",
        encoding="utf-8",
    )
    robot = tmp_path / "robot.tcf"
    robot.write_text(
        "version: 1\ntarget: plain_bare_metal\nnode: me\ncommunication: {middleware: none}\n"
        "components:\n  led: {kind: digital_output, pins: {value: 4}}\n",
        encoding="utf-8",
    )
    monkeypatch.setenv("EPG_TARGETS_PATH", str(tmp_path))
    svg = Svg(draw(capsys, str(robot), "--what", "wiring"))
    assert_readable(svg)
    assert {"0", "1", "2", "3", "4", "a plain board, not to scale"} <= set(svg.words)
    assert svg.line("led value").points[0][0] > 0


FOUR_SIDES = """\
api: 1
board: four_sides
summary: a board with contacts on all sides
soc: rp2040
pins: [0-22, 26-28]
layout:
  top: USB
  rows:
    - {side: left, first: 1, columns: 2, contacts: [0, 1, 2, GND, 3, 4]}
    - {side: right, first: 7, columns: 2, contacts: [5, 6, 7, 3V3, GND, 8]}
    - {side: top, title: J1, first: 1, columns: 2, contacts: [9, 10, 11, GND, 12, 13, 14, GND, 15, 16]}
    - {side: bottom, title: J2, first: 1, contacts: [17, 18, 19, GND, 20, 21, 22, 26]}
  supplies:
    GND: {role: ground, title: ground}
    3V3: {role: supply, title: output, feeds_components: true}
"""


def test_contacts_on_four_sides_and_side_by_side(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    board = tmp_path / "boards/four_sides/board.yaml"
    board.parent.mkdir(parents=True)
    board.write_text(FOUR_SIDES, encoding="utf-8")
    robot = tmp_path / "robot.tcf"
    robot.write_text(
        "version: 1\nextends: four_sides_bare_metal_jiwy.tcf\ncomponents:\n"
        "  encoder_pan: {pins: {a: 10, b: 11}}\n  encoder_tilt: {pins: {a: 18, b: 19}}\n"
        "  pwm_pan: {pins: {value: 2, direction_a: 14, direction_b: 15}}\n"
        "  pwm_tilt: {pins: {value: 20, direction_a: 5, direction_b: 6}}\n",
        encoding="utf-8",
    )
    monkeypatch.setenv("EPG_TARGETS_PATH", str(tmp_path))
    svg = Svg(draw(capsys, str(robot), "--what", "wiring"))
    assert_readable(svg)
    wires = [line for line in svg.lines if line.title]
    assert len([wire for wire in wires if wire.style != "earth"]) == 10
    assert_lines_apart(wires)
    begin = {each: svg.line(each).points[0] for each in ("pwm_tilt direction_a", "pwm_tilt direction_b")}
    (inner, y), (outer, other) = begin.values()
    assert (0 < inner < outer, abs(y - other) < 12) == (True, True)  # GP5 and GP6 are side by side
    top, bottom = svg.line("encoder_pan a").points, svg.line("encoder_tilt a").points
    assert max(y for _, y in top[-4:-2]) < top[0][1] < 0 < bottom[0][1] < max(y for _, y in bottom)
    assert top[0][0] < 0 < svg.line("pwm_tilt value").points[0][0]  # each goes to the nearer side
    assert {"J1", "J2", "GP9" if "GP9" in svg.words else "9"} <= set(svg.words)


def test_the_contacts_show_supplies_and_the_names_on_the_board(capsys: pytest.CaptureFixture[str]) -> None:
    svg = Svg(draw(capsys, "rpi_pico2_freertos_jiwy", "--what", "wiring"))
    assert "VSYS (39): input: 1.8 V to 5.5 V for the board; output: the voltage that supplies the board" in svg.words
    assert "VCC of encoders and other sensors: 3V3 (36). Motors need a separate supply." in svg.words
    signs = [line for line in svg.lines if line.style == "sign"]
    assert len(signs) == 2 * (3 + 3) + 4 + 4  # crosses on the supplies and in the legend; strokes on the others


def test_the_application_shows_every_port_and_its_way(capsys: pytest.CaptureFixture[str]) -> None:
    svg = Svg(draw(capsys, "rpi_pico2_freertos_jiwy", *example("jiwy")))
    for word in (
        "position_pan {rad}",
        "encoder_pan",
        "encoder_pan.reset",
        "a GP10, b GP11",
        "PIO block 0, state machine 0",
        "pan_subscriber",
        "std_msgs/msg/Float64",
        "value GP2, direction_a GP7, direction_b GP8",
        "motion_guard, actuator pwm_pan, encoder encoder_pan",
        "node JIWY_node, rpi_pico2_freertos, xrce over usb, control period 1 ms",
    ):
        assert word in svg.words
    assert len([line for line in svg.lines if line.title]) == 4 * 2 + 4 * 2 + 2  # a reset has no line to the board


def test_conversions_and_outputs_without_a_binding(big: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bindings = big.parent / "b.yaml"
    bindings.write_text(
        "version: 1\nmodel: JIWY_Control\ninputs:\n  position_pan: {from: encoder_b, limits: [-1, 1]}\n"
        "  position_tilt: encoder_a\n  setpoint_pan: button\n  setpoint_tilt: button\n"
        "outputs:\n  pwm_pan: {to: motor_a, scale: 0.25}\n  pwm_tilt: motor_b\n  encoder_reset_pan: encoder_b.reset\n"
        "  encoder_reset_tilt: encoder_a.reset\n  pan_logging: relay_1\n  tilt_logging: unconnected\n",
        encoding="utf-8",
    )
    model = ["--model", str(ROOT / "examples/jiwy/model"), "--bindings", str(bindings)]
    svg = Svg(draw(capsys, str(big), *model))
    assert_readable(svg)
    assert {"×0.5 +0.1 in -1…1", "×0.25", "unconnected"} <= set(svg.words)
    assert "node /somewhere/big_robot, rpi_pico_bare_metal, console over usb, control period 1 ms" in svg.words


def test_the_schedule_is_in_the_order_of_the_generated_code(capsys: pytest.CaptureFixture[str]) -> None:
    svg = Svg(draw(capsys, "rpi_pico2_freertos_jiwy", "--what", "schedule", *example("jiwy")))
    stages = ["sample", "commands", "inputs", "model", "wait", "outputs", "hand over"]
    heads = [text for text in svg.texts if text.text in stages and text.style == "bold"]
    assert [text.text for text in sorted(heads, key=lambda text: text.left)] == stages
    assert {"until 500 us", "newest pan_subscriber", "check guard_pan", "encoder_pan.reset = encoder_reset_pan"} <= set(
        svg.words
    )
    assert "every 2 cycles" in Svg(draw(capsys, "host_relbot", "--what", "schedule", *example("relbot"))).words


def test_wrong_command_lines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["graph", "rpi_pico2_freertos_jiwy"]) == 2
    assert "--what application needs --model" in capsys.readouterr().err
    assert main(["graph", "nothing.tcf", "--what", "wiring"]) == 1
    file = tmp_path / "pictures" / "wiring.svg"
    assert main(["graph", "rpi_pico2_freertos_jiwy", "--what", "wiring", "--output", str(file)]) == 0
    assert Svg(file.read_text(encoding="utf-8")).words


def test_text_is_escaped() -> None:
    picture = Picture('<a> & "b"', "]]> --> &amp; </desc>")
    picture.text(0, 0, "</text><script>&", style="bold")
    picture.box(0, 0, 10, 10, "box", "<title>")
    svg = Svg(picture.render())
    assert svg.words == ["</text><script>&"]
    assert [element.text for element in svg.root if "id" in element.attrib] == ['<a> & "b"', "]]> --> &amp; </desc>"]


@pytest.mark.parametrize("name", DOCUMENTED)
def test_the_pictures_in_the_documentation_are_what_epg_draws(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """``EPG_UPDATE_GOLDEN=1`` draws them again: review them."""
    what, target, robot = DOCUMENTED[name]
    text = draw(capsys, target, "--what", what, *example(robot))
    path = ROOT / "docs/pictures" / name
    if os.environ.get("EPG_UPDATE_GOLDEN"):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")
    assert path.read_bytes().decode() == text
    assert not re.search(r"/(?:home|root|tmp|work)/", text)
