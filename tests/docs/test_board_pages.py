# SPDX-License-Identifier: Apache-2.0
"""The pages of the boards have the wiring and limits that EPG computes from its own configurations.

``EPG_UPDATE_GOLDEN=1`` rewrites the tables.
"""

from __future__ import annotations

import json
import os
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from epg.cli.main import main
from epg.generator.catalog.catalog import Computer, load_catalog
from epg.generator.catalog.hardware import Divider
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.quantity import show
from epg.generator.resolve.divider import clock_range, divide

ROOT = Path(__file__).resolve().parent.parent.parent
BOARDS = ("rpi_pico", "rpi_pico2")
WIRELESS = {"rpi_pico_w": "rpi_pico", "rpi_pico2_w": "rpi_pico2"}
"""Boards whose pages refer to the tables of another board."""
NUCLEOS = {"nucleo_h743zi": "Nucleo-H743ZI", "nucleo_h743zi2": "Nucleo-H743ZI2"}
ROBOTS = ("jiwy", "relbot")
PLATFORMS = ("bare_metal", "freertos")
FREQUENCIES = (1_000, 5_000, 10_000, 20_000, 25_000, 50_000, 100_000)


def page(board: str) -> Path:
    return ROOT / f"docs/boards/{board}.md"


def target(board: str) -> Computer:
    found = load_catalog(targets_roots(), Diagnostics()).find_target(f"{board}_bare_metal")
    assert found is not None
    return found


def timers(found: Computer) -> Fraction:
    """The clock of an STM32's timers on APB2, which TIM1 divides."""
    frequency = found.clocks["apb2_timers"].frequency
    assert frequency is not None
    return frequency


def clk_sys(found: Computer) -> Fraction:
    frequency = found.clocks["sys"].frequency
    assert frequency is not None
    return frequency


def board_pin(gpio: int) -> int:
    """The number of a GPIO's pin at the edge of the board: Pico data sheet, 2.1; the Pico 2 has the same numbers."""
    edge = [0, 1, None, 2, 3, 4, 5, None, 6, 7, 8, 9, None, 10, 11, 12, 13, None, 14, 15]
    edge += [16, 17, None, 18, 19, 20, 21, None, 22, "RUN", 26, 27, None, 28]
    return edge.index(gpio) + 1


def hardware(name: str, capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    """The output of `epg check --hardware` for a predefined configuration."""
    capsys.readouterr()
    assert main(["check", name, "--hardware", "--json"]) == 0
    (found,) = json.loads(capsys.readouterr().out)["hardware"].values()
    return list(found)


def same_wiring(board: str, capsys: pytest.CaptureFixture[str]) -> list[tuple[str, dict[str, Any]]]:
    """The rows of both robots on both platforms, which differ in the names of components only."""
    tables = [hardware(f"{board}_{platform}_{robot}", capsys) for robot in ROBOTS for platform in PLATFORMS]
    names = [[row.pop("component") for row in table] for table in tables]
    assert all(table == tables[0] for table in tables), "one table for both robots and both platforms"
    assert names[0] == names[1] and names[2] == names[3]
    cells = [" ".join(f"`{name}`" for name in dict.fromkeys((one, other))) for one, other in zip(names[0], names[2])]
    return list(zip(cells, tables[0]))


def wiring(board: str, capsys: pytest.CaptureFixture[str]) -> str:
    lines = [
        "| JIWY, RELbot | wire | GPIO | pin of the board | pull-down | hardware |",
        "|---|---|---|---|---|---|",
    ]
    for component, row in same_wiring(board, capsys):
        resource = row["resource"]
        driven = not resource.startswith("PIO")
        if not row["pins"]:
            lines.append(f"| (control loop) | | | | | {resource} |")
        for signal, gpio in row["pins"].items():
            wire = signal if not driven or row["claim"] == "pwm" else row["claim"]
            is_pin = resource.startswith("pin ")
            cells = [component, wire, f"GP{gpio}", str(board_pin(gpio)), "10 kΩ" if driven else ""]
            lines.append(f"| {' | '.join([*cells, 'GPIO' if is_pin else resource])} |".replace("|  |", "| |"))
    return "\n".join(lines) + "\n"


def nucleo_wiring(capsys: pytest.CaptureFixture[str]) -> str:
    """The pins of both Nucleo boards, which have one connector with different pins of the chip."""
    both = [same_wiring(board, capsys) for board in NUCLEOS]
    printed = [{pin: name for name, pin in target(board).board.names.items()} for board in NUCLEOS]
    lines = [
        f"| JIWY, RELbot | wire | name | {' | '.join(NUCLEOS.values())} | pull-down | hardware |",
        "|---|---|---|---|---|---|---|",
    ]
    for (component, one), (_, other) in zip(*both):
        resource = one["resource"]
        if not one["pins"]:
            lines.append(f"| (control loop) | | | | | | {resource} |")
        for signal, pin in one["pins"].items():
            wire = signal if one["claim"] in ("encoder", "uart", "pwm") else one["claim"]
            names = [names.get(at, "") for names, at in zip(printed, (pin, other["pins"][signal]))]
            assert names[0] == names[1]
            driven = one["claim"] == "pwm" or resource.startswith("pin ")
            cells = [component, wire, names[0], pin, other["pins"][signal], "10 kΩ" if driven else ""]
            lines.append(f"| {' | '.join([*cells, 'GPIO' if resource.startswith('pin ') else resource])} |")
    return "\n".join(line.replace("|  |", "| |") for line in lines) + "\n"


def nucleo_pwm(board: str) -> str:
    found = target(board)
    return steps(timers(found), found.soc.classes["pwm"].counter, found.soc.peripherals["timer"].divider)


def pwm(board: str) -> str:
    return steps(clk_sys(target(board)), None, target(board).soc.peripherals["pwm"].divider)


def steps(clock: Fraction, counter: tuple[int, int] | None, divider: Divider | None) -> str:
    """The number of steps of a duty cycle for each frequency."""
    assert divider is not None
    divider = Divider(divider.prescaler, counter or divider.counter)
    lines = ["| frequency | steps | reached |", "|---|---|---|"]
    for frequency in FREQUENCIES:
        found = divide(clock / frequency, divider, exact=False)
        assert found is not None
        reached = show(clock / found.clocks, "frequency")
        lines.append(f"| {show(Fraction(frequency), 'frequency')} | {found.counter} | {reached} |")
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("board", BOARDS)
def test_tables_are_true(board: str, capsys: pytest.CaptureFixture[str]) -> None:
    compare(board, {"wiring": wiring(board, capsys), "pwm": pwm(board)})


@pytest.mark.parametrize(("board", "other"), WIRELESS.items())
def test_tables_of_another_board_are_true(board: str, other: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert f"({other}.md#wiring)" in page(board).read_text(encoding="utf-8")
    assert wiring(board, capsys) == wiring(other, capsys)
    assert pwm(board) == pwm(other)


def test_tables_of_the_nucleos_are_true(capsys: pytest.CaptureFixture[str]) -> None:
    compare("nucleo_h743zi", {"wiring": nucleo_wiring(capsys), "pwm": nucleo_pwm("nucleo_h743zi")})
    compare("nucleo_f767zi", {"pwm": nucleo_pwm("nucleo_f767zi")})


def compare(board: str, wanted: dict[str, str]) -> None:
    """The blocks of a page are the wanted ones."""
    text = page(board).read_text(encoding="utf-8")
    blocks = re.findall(r"<!-- (\w[\w ]*) -->\n(.*?)<!-- end -->", text, re.DOTALL)
    assert [name for name, _ in blocks] == list(wanted)
    if os.environ.get("EPG_UPDATE_GOLDEN"):
        for name, old in blocks:
            text = text.replace(f"<!-- {name} -->\n{old}<!-- end -->", f"<!-- {name} -->\n{wanted[name]}<!-- end -->")
        page(board).write_text(text, encoding="utf-8")
        blocks = list(wanted.items())
    assert dict(blocks) == wanted


@pytest.mark.parametrize("board", BOARDS)
def test_numbers_in_the_text_are_true(board: str) -> None:
    text = page(board).read_text(encoding="utf-8")
    found = target(board)
    soc, clock = found.soc, clk_sys(found)
    pio, slices = soc.peripherals["pio"], soc.peripherals["pwm"]
    assert f"`PICO_BOARD` | `{found.board.sdks['pico_sdk']}`" in text
    assert f"{clock // 1_000_000} MHz" in text
    assert f"{len(pio.instances) * len(pio.slots)}: 4 for each of {len(pio.instances)} PIO blocks" in text
    assert found.board.pins == tuple(str(pin) for pin in (*range(23), 26, 27, 28)), "the row of pins for components"
    assert slices.divider is not None
    longest = Fraction(clock_range(slices.divider)[1]) / clock
    assert f"| control period | up to {show(longest, 'time', -1)};" in text
    clocks_per_edge = 10  # targets/libraries/pico_quadrature/src/pico_quadrature.pio
    assert f"{float(clock / clocks_per_edge / 1_000_000):g} million edges per second" in text
    reached = {slice_ for slice_, _ in slices.pins}
    assert len(reached) == 8 and "16 channels on 8 slices" in text
    extra = len(slices.instances) - len(reached)
    assert (f"{extra} more slices" in text) == (extra > 0)


def test_numbers_of_the_nucleos_are_true() -> None:
    text = page("nucleo_h743zi").read_text(encoding="utf-8")
    found = target("nucleo_h743zi")
    soc = found.soc
    for name in ("core", "apb1_timers"):
        assert f"{soc.clocks[name].frequency // 1_000_000} MHz" in text  # type: ignore[operator]
        assert f"{soc.clocks[name].maximum // 1_000_000} MHz" in text  # type: ignore[operator]
    assert f"{len(soc.classes['quadrature'].instances)}: TIM1 to TIM5 and TIM8" in text
    divider = soc.peripherals["timer"].divider
    assert divider is not None
    longest = Fraction(clock_range(divider)[1]) / timers(found)
    assert f"| control period | up to {show(longest, 'time', -1)};" in text
    assert found.platform.family is not None and found.platform.family.own == ("TIM7",)
    fast = re.search(r"clocks: (\{core: .*?\})", text)
    assert fast is not None
    assert dict(re.findall(r"(\w+): (\d+ MHz)", fast[1])) == {
        name: str(node.value) for name, node in target_of_zephyr().board_clocks.items() if name != "hse"
    }


def test_numbers_of_the_f767_are_true(capsys: pytest.CaptureFixture[str]) -> None:
    """Clocks and limits; the pins are those of the Nucleo-H743ZI."""
    text = page("nucleo_f767zi").read_text(encoding="utf-8")
    found = target("nucleo_f767zi")
    clocks = dict(found.clocks)
    for names, mhz in re.findall(r"^\| (`.*`) \| (\d+) MHz", text, re.MULTILINE):
        for name in re.findall(r"`(\w+)`", names):
            assert clocks.pop(name).frequency == int(mhz) * 1_000_000
    assert set(clocks) == {"hse"}
    divider = found.soc.peripherals["timer"].divider
    assert divider is not None
    longest = Fraction(clock_range(divider)[1]) / 108_000_000
    assert f"| control period | up to {show(longest, 'time', -1)};" in text
    pins = [
        [(row["component"], row["pins"]) for row in hardware(f"{board}_bare_metal_{robot}", capsys)]
        for board in ("nucleo_f767zi", "nucleo_h743zi")
        for robot in ROBOTS
    ]
    assert pins[:2] == pins[2:]
    (loop,) = [row["resource"] for row in hardware("nucleo_f767zi_freertos_jiwy", capsys) if not row["pins"]]
    assert f"chooses {loop.removeprefix('timer ')} for the control loop" in " ".join(text.split())


def target_of_zephyr() -> Computer:
    found = load_catalog(targets_roots(), Diagnostics()).find_target("nucleo_h743zi_zephyr")
    assert found is not None
    return found


@pytest.mark.parametrize("board", WIRELESS)
def test_the_radio_s_pins_are_nobody_s(board: str) -> None:
    """Pico W data sheet, 2.1: GPIO 23, 24, 25 and 29 belong to the radio, and the LED is a pin of the radio."""
    text = page(board).read_text(encoding="utf-8")
    found, other = target(board).board, target(board.removesuffix("_w")).board
    assert sorted(found.reserved) == ["23", "24", "25", "29"]
    assert "| pins of the radio | GP23, GP24, GP25, GP29: EPG refuses them |" in text
    assert found.pins == other.pins == tuple(str(pin) for pin in (*range(23), 26, 27, 28))
    assert not found.onboard and not found.names
    assert f"| `PICO_BOARD` | `{found.sdks['pico_sdk']}` |" in text
    assert found.sdks["zephyr"] == other.sdks["zephyr"]
    for shared in ("chip", "encoders"):
        line = re.search(rf"^\| {shared} \|.*$", text, re.M)
        assert line is not None and line[0] in page(board.removesuffix("_w")).read_text(encoding="utf-8")


@pytest.mark.parametrize("page", [*sorted((ROOT / "docs/boards").glob("*.md")), ROOT / "docs/any-firmware.md"])
def test_each_page_says_that_nothing_ran_and_what_to_try(page: Path) -> None:
    """The first owner of a board finds the ten steps at the top of its page."""
    begin = page.read_text(encoding="utf-8").partition("\n## ")[0]
    assert "bring-up.md" in begin and re.search(
        r"[Nn]othing (here|on this page) has\s+(been\s+tried|run)\s+on\s+a\s+board\s+yet", begin
    )


def test_gpios_on_both_boards_have_their_places() -> None:
    places = {gpio: board_pin(gpio) for gpio in (0, 2, 10, 13, 15, 16, 22, 26, 28)}
    assert places == {0: 1, 2: 4, 10: 14, 13: 17, 15: 20, 16: 21, 22: 29, 26: 31, 28: 34}


def test_the_pages_have_the_same_sections() -> None:
    """Both pages have the same sections; the second one also has an erratum."""
    sections = [re.findall(r"^##+ (.+)$", page(board).read_text(encoding="utf-8"), re.M) for board in BOARDS]
    assert [title for title in sections[1] if "E9" not in title] == sections[0]
    assert len(sections[1]) == len(sections[0]) + 1
