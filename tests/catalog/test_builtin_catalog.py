# SPDX-License-Identifier: Apache-2.0
"""EPG's own chips, boards, platforms, kinds and robots are valid, and agree with the data sheets."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from epg.generator.catalog.catalog import FOLDERS, Catalog, load_catalog
from epg.generator.check.compose import component_schema, typed_parameters
from epg.generator.check.configuration import check_configuration
from epg.generator.check.merge import merge_chain
from epg.generator.data import data_folder, targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.schema import validate
from epg.generator.documents.tcf import load_tcf_chain, settings_node
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.source import Span
from tests.catalog.everything import read_everything

TARGETS = data_folder("targets")
BOARDS = ("rpi_pico", "rpi_pico2")
WIRELESS = ("rpi_pico_w", "rpi_pico2_w")
NUCLEOS = ("nucleo_h743zi", "nucleo_h743zi2", "nucleo_f767zi")
PLATFORMS = ("bare_metal", "freertos", "zephyr")


def builtin() -> tuple[Catalog, Diagnostics]:
    problems = Diagnostics()
    catalog = load_catalog(targets_roots(), problems)
    return catalog, problems


def test_everything_is_right() -> None:
    catalog, problems = builtin()
    read_everything(catalog)
    assert [(p.span, p.message) for p in problems] == []
    folders = {
        path.parent.name
        for folder in FOLDERS.values()
        for root in targets_roots()
        for path in root.glob(f"{folder}/*/*")
    }
    shared = {"common"}  # shared by kinds
    assert {name for category in FOLDERS for name in catalog.names(category)} == folders - shared


def test_the_targets_of_the_thesis_and_those_without_a_board() -> None:
    catalog, _ = builtin()
    others = ["firmware", "host", "native_sim", "mps2_an385_zephyr"]
    assert catalog.target_names() == sorted(
        [*others, *(f"{board}_{name}" for board in (*BOARDS, *WIRELESS, *NUCLEOS) for name in PLATFORMS)]
    )
    assert all(catalog.find_target(name).platform.builds for name in catalog.target_names())


def test_the_kinds() -> None:
    catalog, _ = builtin()
    assert catalog.kind_names() == [
        "constant",
        "digital_input",
        "digital_output",
        "dual_pwm_h_bridge",
        "motion_guard",
        "pwm",
        "pwm_h_bridge",
        "quadrature_encoder",
        "ros_array_publisher",
        "ros_array_subscriber",
        "ros_echo",
        "ros_joint_state_publisher",
        "ros_joint_state_subscriber",
        "ros_message_publisher",
        "ros_message_subscriber",
        "ros_publisher",
        "ros_subscriber",
        "ros_twist_publisher",
        "ros_twist_subscriber",
        "timing_probe",
        "uart",
    ]


def test_drivers_name_all_their_files() -> None:
    """A C file that component.yaml does not list would not be compiled; a header would not be found."""
    catalog, _ = builtin()
    for name in catalog.kind_names():
        kind = catalog.find_kind(name)
        assert {path.name for path in kind.folder.glob("*.h")} == set(kind.headers)
        assert {path.name for path in kind.folder.glob("*.c")} == set(kind.sources)
        assert all(path.is_file() for path in kind.files)


def test_schemas_are_schemas_that_editors_understand() -> None:
    for category in FOLDERS:
        text = (data_folder("schemas") / f"{category}.schema.json").read_text(encoding="utf-8")
        schema = json.loads(text)
        Draft202012Validator.check_schema(schema)
        assert schema["$id"] == f"https://epg.dev/schemas/v1/{category}.schema.json"
        assert "unevaluated" not in text and "prefixItems" not in text


def test_composed_schemas_are_valid_and_have_no_keywords_of_their_own_but_annotations() -> None:
    catalog, _ = builtin()
    for name in catalog.kind_names():
        for with_pins in (True, False):
            schema = component_schema(catalog.find_kind(name), with_pins)
            Draft202012Validator.check_schema(schema)
            assert schema["additionalProperties"] is False
            assert ("pins" in schema["required"]) == (with_pins and bool(catalog.find_kind(name).pins))
            json.dumps(schema)


@pytest.mark.parametrize(("name", "slices", "blocks", "clock"), [("rpi_pico", 8, 2, 125), ("rpi_pico2", 12, 3, 150)])
def test_numbers_of_the_data_sheets(name: str, slices: int, blocks: int, clock: int) -> None:
    """RP2040 data sheet 3.1 and 4.5; RP2350 data sheet 11.1 and 12.5."""
    target = builtin()[0].find_target(f"{name}_bare_metal")
    soc = target.soc
    pwm, pio = soc.peripherals["pwm"], soc.peripherals["pio"]
    assert {clock.title: clock.frequency for clock in target.clocks.values()} == {
        "clk_sys": clock * 1_000_000,
        "clk_peri": clock * 1_000_000,
    }
    assert [(source.clock, source.factor) for source in soc.peripherals["uart"].sources] == [("peri", 4)] * 2
    assert (len(pwm.instances), pwm.slots, len(pio.instances), len(pio.slots)) == (slices, ("A", "B"), blocks, 4)
    assert soc.pins == tuple(str(pin) for pin in range(30))
    reached = {pin: place for place, pins in pwm.pins.items() for pin in pins}
    assert reached == {str(pin): (pin // 2 % 8, pin % 2) for pin in range(30)}
    assert target.board.pins == tuple(str(pin) for pin in (*range(23), 26, 27, 28))
    assert set(target.board.reserved) == {"23", "24", "29"}
    assert target.board.onboard["25"].classes == ("digital_output", "pwm")


def test_the_nucleos_differ_where_their_manuals_differ() -> None:
    """UM1974 (MB1137) and UM2407 (MB1364): LD2, the switch of the USB supply, and the Arduino connector."""
    boards = [builtin()[0].find_target(f"nucleo_h743zi{number}_zephyr").board for number in ("", "2")]
    assert [board.names["LD2"] for board in boards] == ["PB7", "PE1"]
    assert [{"PG6", "PD10"} & set(board.reserved) for board in boards] == [{"PG6"}, {"PD10"}]
    assert [{"PG6", "PD10", "PB7", "PE1"} & set(board.pins) for board in boards] == [{"PD10", "PE1"}, {"PG6", "PB7"}]
    assert [[board.names[name] for name in ("D0", "D2", "D7", "A3")] for board in boards] == [
        ["PG9", "PF15", "PF13", "PF3"],
        ["PB7", "PG14", "PG12", "PB1"],
    ]
    for board in boards:
        parts = [*board.pins, *board.onboard, *board.reserved]
        assert len(parts) == 114 == len(set(parts)), "each pin of the package with 144 pins has one meaning"
        assert {name for name in board.names if name[0] in "AD"} == {
            *(f"A{n}" for n in range(6)),
            *(f"D{n}" for n in (*range(17), 21, 28, 29)),
        }


def test_zephyr_has_the_clocks_of_its_devicetree() -> None:
    """Zephyr's nucleo_h743zi.dts: the core has 480 MHz.  Elsewhere, all revisions of the chip reach the clocks."""
    target = builtin()[0].find_target("nucleo_h743zi_zephyr")
    clocks = ("core", "apb1_timers", "apb2_timers", "uart1_6", "uart2_8")
    assert [target.clocks[name].frequency / 1_000_000 for name in clocks] == [480, 240, 240, 120, 120]
    assert [target.soc.clocks[name].frequency / 1_000_000 for name in clocks] == [400, 200, 200, 100, 100]
    assert target.soc.clocks["hse"].frequency is None and target.clocks["hse"].frequency == 8_000_000


def test_the_f767_has_the_board_of_the_h743() -> None:
    """UM1974 describes MB1137 for both chips.  Zephyr's nucleo_f767zi.dts has the chip's own clocks."""
    catalog, _ = builtin()
    target, other = (catalog.find_target(f"nucleo_{name}_bare_metal") for name in ("f767zi", "h743zi"))
    assert (target.board.pins, target.board.names) == (other.board.pins, other.board.names)
    assert (target.board.reserved, target.board.onboard) == (other.board.reserved, other.board.onboard)
    assert target.soc.pins == other.soc.pins
    clocks = ("core", "apb1_timers", "apb2_timers", "usart1", "usart3", "hse")
    for found in (target, catalog.find_target("nucleo_f767zi_zephyr")):
        assert [found.clocks[name].frequency / 1_000_000 for name in clocks] == [216, 108, 216, 108, 54, 8]


ROBOTS = ("jiwy.tcf", "relbot.tcf")
WIRINGS = ("rpi_pico", "nucleo_h743zi", "nucleo_h743zi_stlink")
WITHOUT_TARGET = (*ROBOTS, *(f"{wiring}_{robot}" for wiring in WIRINGS for robot in ROBOTS))


@pytest.mark.parametrize("name", builtin()[0].configuration_names())
def test_predefined_configurations(name: str) -> None:
    """Configurations with a target are valid; robots and wirings are valid once the missing keys are set."""
    catalog, problems = builtin()
    chain = load_tcf_chain(name, targets_roots(), problems)
    missing = "target" not in merge_chain(chain)
    texts = ["target=host", "communication.middleware=files", "communication.transport=null"] if missing else []
    settings = settings_node([(text, Span("settings")) for text in texts], problems)
    assert check_configuration(chain, settings, catalog, problems) is not None
    assert [(p.span, p.message) for p in problems] == []
    assert missing == (name in WITHOUT_TARGET)


@pytest.mark.parametrize("robot", ["host_jiwy", "rpi_pico_bare_metal_jiwy", "rpi_pico2_freertos_jiwy"])
def test_jiwy_is_the_thesis_robot(robot: str) -> None:
    """Names, topics and counts of the thesis's robot; the same on each target."""
    catalog, problems = builtin()
    configuration = check_configuration(load_tcf_chain(robot, targets_roots(), problems), [], catalog, problems)
    assert (configuration.node, configuration.control.period) == ("JIWY_node", Fraction(1, 1000))
    assert not configuration.control.enable_at_start, "nothing moves before the target is enabled"
    assert configuration.communication.period == Fraction(33, 1000)
    topics = {name: c.parameters["topic"] for name, c in configuration.components.items() if c.kind.communication}
    assert topics == {name: name for name in ("pan_subscriber", "tilt_subscriber", "pan_publisher", "tilt_publisher")}
    spans = {axis: configuration.components[f"encoder_{axis}"].parameters["span"] for axis in ("pan", "tilt")}
    assert {axis: span["counts"] for axis, span in spans.items()} == {"pan": 1112, "tilt": 221}
    assert spans["pan"]["angle"] == pytest.approx(3.141592653589793, abs=0)


def test_relbot_has_exact_gears_and_a_right_wheel_that_counts_backwards() -> None:
    catalog, problems = builtin()
    chain = load_tcf_chain("rpi_pico2_freertos_relbot", targets_roots(), problems)
    configuration = check_configuration(chain, [], catalog, problems)
    wheels = {side: configuration.components[f"encoder_{side}"].parameters for side in ("left", "right")}
    assert {wheel["gear"] for wheel in wheels.values()} == {Fraction(5625, 361)}
    assert {side: wheel["invert"] for side, wheel in wheels.items()} == {"left": False, "right": True}


def typed(kind_name: str, text: str) -> tuple[dict[str, object], Diagnostics]:
    """The typed parameters of a component whose YAML is ``text``."""
    catalog, _ = builtin()
    problems = Diagnostics()
    kind = catalog.find_kind(kind_name)
    node = parse_yaml(text, "robot.tcf", problems)
    assert validate(node, component_schema(kind, False), problems), [p.message for p in problems]
    return dict(typed_parameters(kind, node, problems)), problems


def test_parameters_are_typed_and_have_their_defaults() -> None:
    values, problems = typed(
        "quadrature_encoder", "{kind: quadrature_encoder, counts_per_revolution: 4096, gear: 5625/361}"
    )
    assert list(problems) == []
    assert values == {
        "counts_per_revolution": 4096.0,
        "gear": Fraction(5625, 361),
        "span": None,
        "invert": False,
        "preset": 0,
        "pull_up": False,
        "counter_bits": 32,
        "max_speed": None,
    }
    values, _ = typed("pwm_h_bridge", "{kind: pwm_h_bridge, pins: {value: 1, direction_a: 2, direction_b: GP3}}")
    assert values == {
        "frequency": Fraction(20_000),
        "invert": False,
        "max_duty": 1.0,
        "zero": "coast",
        "safe": "coast",
        "dead_time": Fraction(1, 1_000_000),
    }
    values, _ = typed("ros_subscriber", "{kind: ros_subscriber, topic: x, timeout: 500 ms}")
    assert values["timeout"] == Fraction(1, 2) and values["rate_limit"] is None


@pytest.mark.parametrize(
    ("kind", "text", "ids"),
    [
        ("quadrature_encoder", "{kind: quadrature_encoder}", ["exactly-one"]),
        ("quadrature_encoder", "{kind: quadrature_encoder, counts_per_revolution: 1, gear: 0}", ["out-of-range"]),
        ("quadrature_encoder", "{kind: quadrature_encoder, counts_per_revolution: 1, preset: 1 ms}", ["wrong-unit"]),
        ("pwm", "{kind: pwm, frequency: 0 Hz}", ["out-of-range"]),
        ("constant", "{kind: constant, value: .nan}", ["wrong-value"]),
        ("ros_subscriber", "{kind: ros_subscriber, topic: x, timeout: -1 s}", ["out-of-range"]),
    ],
)
def test_values_that_a_schema_cannot_judge(kind: str, text: str, ids: list[str]) -> None:
    assert [p.id for p in typed(kind, text)[1]] == ids


def test_names_that_do_not_exist() -> None:
    catalog, problems = builtin()
    span = Span("robot.tcf", 1, 1, 2)
    assert catalog.kind("quadratur_encoder", span, problems) is None
    assert catalog.target("rpi_pico_freertoss", span, problems) is None
    assert catalog.target("freertos", span, problems) is None
    assert catalog.target("host_host", span, problems) is None
    own = "EPG also searches the folders in EPG_TARGETS_PATH"
    assert [(p.id, p.hint) for p in problems][:2] == [
        ("unknown-kind", f"did you mean 'quadrature_encoder'? {own}"),
        (
            "unknown-target",
            f"did you mean 'rpi_pico_freertos'? {own}; docs/adding-a-board.md explains how to add a board",
        ),
    ]
    assert len(problems.items) == 4


def test_a_users_folder_comes_first_and_a_missing_one_is_said(tmp_path: Path) -> None:
    board = (TARGETS / "boards" / "rpi_pico" / "board.yaml").read_text(encoding="utf-8")
    (tmp_path / "mine" / "boards" / "rpi_pico").mkdir(parents=True)
    (tmp_path / "mine" / "boards" / "rpi_pico" / "board.yaml").write_text(
        board.replace("summary: Raspberry Pi Pico", "summary: mine"), encoding="utf-8"
    )
    problems = Diagnostics()
    catalog = load_catalog(targets_roots([tmp_path / "mine", tmp_path / "missing"]), problems)
    assert catalog.find_target("rpi_pico_freertos").board.summary == "mine"
    assert [p.id for p in problems] == ["targets-not-found", "shadowed-item"]


def test_only_what_is_asked_for_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """A target reads only the files of its board, of the boards that this extends, of chip, platform and family."""
    from epg.generator.catalog import catalog as module

    read: list[str] = []
    load = module.load_yaml
    monkeypatch.setattr(module, "load_yaml", lambda path, *rest: read.append(path.parent.name) or load(path, *rest))
    catalog, _ = builtin()
    catalog.find_target("rpi_pico2_freertos")
    catalog.find_kind("pwm")
    catalog.find_kind("pwm")
    assert sorted(read) == ["freertos", "pwm", "rp2", "rp2040", "rp2350", "rpi_pico", "rpi_pico2"]


def test_a_board_that_extends_others() -> None:
    """The Pico 2 W extends the Pico W, which extends the Pico: values are replaced, added and deleted."""
    board = builtin()[0].find_target("rpi_pico2_w_bare_metal").board
    assert [path.parent.name for path in board.files] == ["rpi_pico", "rpi_pico2_w", "rpi_pico_w"]
    assert board.pins == builtin()[0].find_target("rpi_pico_bare_metal").board.pins
    assert (board.names, board.onboard, sorted(board.reserved)) == ({}, {}, ["23", "24", "25", "29"])
    assert board.sdks == {"pico_sdk": "pico2_w", "zephyr": "rpi_pico2/rp2350a/m33"}
    assert sorted(board.devicetree) == ["adc", "i2c0", "i2c1", "uart0"]
    assert [path.parent.name for path in builtin()[0].find_target("mps2_an385_zephyr").soc.files] == [
        "emulated",
        "native_sim",
    ]


def test_a_kind_of_a_user_shares_parameters_with_those_of_epg(tmp_path: Path) -> None:
    """A kind's own parameter replaces a shared one, and the user's file one of EPG's with the same name."""
    kind, common = tmp_path / "components" / "speed", tmp_path / "components" / "common"
    for folder in (kind, common):
        folder.mkdir(parents=True)
    topic = "{type: string, required: true, description: a topic}"
    qos = "{type: string, enum: [best_effort], default: best_effort, description: mine}"
    head = "api: 1\nkind: speed\nsummary: a speed\ncommunication: publish\n"
    shared = "parameters_from: [quality_of_service, publication]\n"
    text = f"{head}{shared}parameters:\n  topic: {topic}\n  qos: {qos}\n"
    (kind / "component.yaml").write_text(text, encoding="utf-8")
    (kind / "code.c.j2").write_text("", encoding="utf-8")
    every = "api: 1\nparameters:\n  every: {type: integer, description: mine}\n"
    (common / "publication.yaml").write_text(every, encoding="utf-8")
    problems = Diagnostics()
    found = load_catalog(targets_roots([tmp_path]), problems).find_kind("speed")
    assert found is not None and not list(problems)
    assert [p.name for p in found.parameters] == ["topic", "qos", "depth", "durability", "deadline", "every"]
    assert {p.name: p.description for p in found.parameters if p.name in ("qos", "every")} == {
        "qos": "mine",
        "every": "mine",
    }
    read = {path.relative_to(path.parents[1]).as_posix() for path in found.files}
    assert read == {
        "speed/component.yaml",
        "speed/code.c.j2",
        "common/publication.yaml",
        "common/quality_of_service.yaml",
    }


def test_what_is_wrong_is_reported_once(tmp_path: Path) -> None:
    """A kind that cannot be read is not also reported as unknown, however often it is used."""
    (tmp_path / "components" / "broken").mkdir(parents=True)
    (tmp_path / "components" / "broken" / "component.yaml").write_text("api: 1\nkind: [", encoding="utf-8")
    problems = Diagnostics()
    catalog = load_catalog(targets_roots([tmp_path]), problems)
    for line in (1, 2):
        assert catalog.kind("broken", Span("robot.tcf", line, 1, 2), problems) is None
    assert [p.id for p in problems] == ["yaml-syntax"]


@pytest.mark.parametrize(("kind", "name"), [("pwm_h_bridge", "single_states"), ("dual_pwm_h_bridge", "dual_states")])
def test_safe_states_of_bridges_are_those_that_their_test_tries(kind: str, name: str) -> None:
    """Compared with tests/runtime/c/outputs_tests.c."""
    catalog, _ = builtin()
    found = catalog.find_kind(kind)
    assert found is not None
    claims = [claim.name for claim in found.claims]

    def masks(state: Mapping[str, str]) -> tuple[int, int]:
        low, high = (sum(1 << claims.index(c) for c in state if state[c] == level) for level in ("low", "high"))
        return low, high

    source = (TARGETS.parent / "tests" / "runtime" / "c" / "outputs_tests.c").read_text(encoding="utf-8")
    written = re.search(rf"{name}\[\] = \{{(.*)\}};", source)
    assert written is not None
    values = [dict(re.findall(r"\.(low|high) = (\d)", one)) for one in written[1].split("}")[:-1]]
    assert [(int(v.get("low", 0)), int(v.get("high", 0))) for v in values] == [masks(s) for s in found.safe_states]


def test_a_mistake_in_a_file_that_others_extend_concerns_each_of_them(tmp_path: Path) -> None:
    """It is reported once, but no chip, board or target with this file can be used."""
    for category, name in (("socs", "rp2040"), ("boards", "rpi_pico")):
        (tmp_path / category / name).mkdir(parents=True)
    chip = (TARGETS / "socs" / "rp2040" / "soc.yaml").read_text(encoding="utf-8")
    wrong = chip.replace("signals: {tx: TX, rx: RX}", "signals: {tx: TXD, rx: RX}")
    (tmp_path / "socs" / "rp2040" / "soc.yaml").write_text(wrong, encoding="utf-8")
    problems = Diagnostics()
    catalog = load_catalog(targets_roots([tmp_path]), problems)
    assert [catalog.find_target(f"{board}_zephyr") for board in BOARDS] == [None, None]
    assert [p.id for p in problems] == ["unknown-name"]

    (tmp_path / "socs" / "rp2040" / "soc.yaml").unlink()
    board = (TARGETS / "boards" / "rpi_pico" / "board.yaml").read_text(encoding="utf-8")
    (tmp_path / "boards" / "rpi_pico" / "board.yaml").write_text(f"{board}clocks: {{sys: 130 Mhz}}\n", encoding="utf-8")
    problems = Diagnostics()
    catalog = load_catalog(targets_roots([tmp_path]), problems)
    targets = [f"{board}_{platform}" for board in ("rpi_pico", "rpi_pico_w") for platform in PLATFORMS]
    assert [catalog.find_target(name) for name in targets] == [None] * 6
    assert [p.id for p in problems if p.severity == "error"] == ["wrong-unit"]
