# SPDX-License-Identifier: Apache-2.0
"""Clocks: their frequencies come from chip, board and ``.tcf``, and each instance divides its own clock."""

from __future__ import annotations

from pathlib import Path

import hardware_of_text as hardware
import pytest

TARGETS = Path(__file__).with_name("targets")
"""The chip ``timers``: TIM1 divides the clock ``bus`` of 100 MHz; TIM2 and TIM3 divide ``slow``, which follows it."""


def allocated(folder: Path, clocks: str, *components: str, more: str = "") -> hardware.Outcome:
    """The hardware of components on the board with the chip ``timers``."""
    lines = ["version: 1", more, "target: timer_board_loop", "node: robot", "control: {period: 1 ms}"]
    lines += [f"clocks: {clocks}" if clocks else "", "components:", *(f"  {line}" for line in components)]
    (folder / "robot.tcf").write_text("\n".join(line for line in lines if line) + "\n", encoding="utf-8")
    return hardware.allocate_file("robot.tcf", [TARGETS], folder)


def pwm(name: str, pin: str) -> str:
    return f"{name}: {{kind: pwm, frequency: 20 kHz, pins: {{value: {pin}}}}}"


@pytest.mark.parametrize(
    ("clocks", "bus", "slow"),
    [("", 100, 100), ("{bus: 84 MHz}", 84, 84), ("{slow: 50 MHz}", 100, 50), ("{bus: 200 MHz, slow: 84 MHz}", 200, 84)],
)
def test_each_instance_divides_its_clock(tmp_path: Path, clocks: str, bus: int, slow: int) -> None:
    found = allocated(tmp_path, clocks, pwm("one", "PA2"), pwm("other", "PA4")).assignments
    assert found is not None
    one, other = found["one", "pwm"], found["other", "pwm"]
    assert (one.instance_name, other.instance_name) == ("TIM1", "TIM3")
    assert (one.clock, other.clock) == (bus * 1_000_000, slow * 1_000_000)
    assert (one.settings["top"], other.settings["top"]) == (bus * 50 - 1, slow * 50 - 1)
    assert one.frequency == other.frequency == 20_000


def test_a_claim_gets_an_instance_whose_clock_can_make_its_frequency(tmp_path: Path) -> None:
    """PA0 and PA1 are pins of TIM1 and of TIM2; the clock of TIM2 is too slow."""
    components = [pwm("one", "PA0"), pwm("other", "PA1")]
    assert allocated(tmp_path, "", *components).ids == []
    found = allocated(tmp_path, "{slow: 10 kHz}", *components)
    assert found.resources() == {"one.pwm": "timer TIM1, channel CH1", "other.pwm": "timer TIM1, channel CH2"}
    found = allocated(tmp_path, "{slow: 10 kHz}", *components, pwm("third", "PB0"))
    assert [(p.id, p.hint) for p in found.problems] == [
        ("frequency-out-of-range", "a timer counts at most 65536 x 65535 periods of 10 kHz")
    ]


def test_users_of_an_instance_still_share_a_frequency(tmp_path: Path) -> None:
    """PA2 leads to TIM1 only, PA1 also to TIM2: both fit TIM1, although only one of them can have another clock."""
    encoder = "encoder: {kind: quadrature_encoder, counts_per_revolution: 100, pins: {a: PB0, b: PB1}}"
    found = allocated(tmp_path, "{slow: 84 MHz}", encoder, pwm("one", "PA2"), pwm("other", "PA1"))
    assert found.resources() == {
        "encoder.encoder": "timer TIM2",
        "one.pwm": "timer TIM1, channel CH1",
        "other.pwm": "timer TIM1, channel CH2",
    }


def test_files_that_extend_each_other(tmp_path: Path) -> None:
    """Clocks are merged by their names; null deletes one."""
    robot = "version: 1\nclocks: {bus: 50 MHz, slow: 25 MHz}\n"
    (tmp_path / "base.tcf").write_text(robot, encoding="utf-8")
    expected = {"{bus: 80 MHz}": (80, 25), "{slow: null}": (50, 50), "null": (100, 100)}
    for clocks, (bus, slow) in expected.items():
        found = allocated(tmp_path, clocks, pwm("one", "PA2"), pwm("other", "PA4"), more="extends: base.tcf")
        assert found.assignments is not None
        assert [found.assignments[name, "pwm"].clock for name in ("one", "other")] == [bus * 10**6, slow * 10**6]


def test_a_board_sets_clocks_and_a_tcf_replaces_them(tmp_path: Path) -> None:
    board = tmp_path / "targets" / "boards" / "fast_pico"
    board.mkdir(parents=True)
    text = "api: 1\nboard: fast_pico\nsummary: a fast board\nextends: rpi_pico\nclocks: {sys: 200 MHz}\n"
    (board / "board.yaml").write_text(text, encoding="utf-8")
    head = "version: 1\nextends: jiwy.tcf\ntarget: fast_pico_bare_metal\n"
    pins = "components:\n  link: {kind: uart, pins: {tx: 16, rx: 17}}\ncommunication: {transport: link}\n"
    for clocks, sys, peri in (
        ("", 200, 200),
        ("clocks: {sys: 150 MHz}\n", 150, 150),
        ("clocks: {peri: 48 MHz}\n", 200, 48),
    ):
        (tmp_path / "robot.tcf").write_text(
            f"{head}{clocks}{pins}".replace("jiwy.tcf", "rpi_pico_bare_metal_jiwy.tcf"), encoding="utf-8"
        )
        found = hardware.allocate_file("robot.tcf", [tmp_path / "targets"], tmp_path)
        assert found.assignments is not None, [problem.message for problem in found.problems]
        assert found.assignments["", "tick"].clock == sys * 10**6
        assert found.assignments["link", "uart"].clock == 4 * peri * 10**6
        assert found.assignments["", "tick"].frequency == 1000


def test_a_simulated_target_ignores_the_clocks_of_a_board(tmp_path: Path) -> None:
    """As it ignores pins: the host and the board have one .tcf."""
    text = "version: 1\nextends: rpi_pico_bare_metal_jiwy.tcf\nclocks: {sys: 150 MHz}\n"
    (tmp_path / "board.tcf").write_text(text, encoding="utf-8")
    robot = "version: 1\nextends: board.tcf\ntarget: host\ncommunication: {middleware: none, transport: null}\n"
    (tmp_path / "robot.tcf").write_text(f"{robot}  # no console\n", encoding="utf-8")
    found = hardware.allocate_file("robot.tcf", beside=tmp_path)
    assert found.assignments is not None, [problem.message for problem in found.problems]
    assert found.assignments["pwm_pan", "pwm"].clock == 125_000_000
