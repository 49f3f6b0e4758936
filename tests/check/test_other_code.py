# SPDX-License-Identifier: Apache-2.0
"""EPG leaves the pins and peripherals alone that STM32CubeMX gives to other code of the program."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from epg.cli.main import main
from epg.generator.catalog.catalog import load_catalog
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import Request, load_hardware
from epg.generator.resolve.claims import TICK
from epg.generator.source import Span
from tests.documents.ioc_texts import ioc_text

ROBOT = """version: 1
target: nucleo_h743zi_freertos
node: robot
communication: {middleware: none}
control: {period: 1 ms}
components:
  encoder: {kind: quadrature_encoder, pins: {a: PC6, b: PC7}, counts_per_revolution: 4096}
  motor: {kind: pwm, pins: {value: PB8}}
  lamp: {kind: digital_output, pins: {value: PE3}}
"""
TICKS = ("TIM2", "TIM3", "TIM4", "TIM5", "TIM6", "TIM12", "TIM13", "TIM14", "TIM15", "TIM16", "TIM17")


def check(text: str, tcf: str = ROBOT) -> tuple[dict[tuple[str, str], str], list[tuple[str, str]]]:
    """The instances of all claims, and the ids and positions of the messages."""
    problems = Diagnostics()
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "robot.tcf").write_text(tcf)
        Path(folder, "robot.ioc").write_text(text)
        request = Request("robot", "robot.tcf", Path(), Path(), ioc=Path(folder, "robot.ioc"), beside=Path(folder))
        found = load_hardware(request, load_catalog(request.roots, problems), problems)
    names = {key: assignment.instance_name for key, assignment in (found or {}).items()}
    return names, [(item.id, Path(item.span.file).name) for item in problems]


def test_a_project_that_uses_nothing_of_epg_changes_nothing() -> None:
    found, messages = check(ioc_text(peripherals=["ETH"], pins={"PA1": "ETH_REF_CLK", "PC13": "GPIO_Input"}))
    assert messages == []
    assert found["encoder", "encoder"] == "TIM8" and found[TICK] == "TIM6"


@settings(max_examples=60, deadline=None)
@given(st.sets(st.sampled_from(TICKS)))
def test_the_tick_gets_a_timer_that_is_left(used: set[str]) -> None:
    found, messages = check(ioc_text(peripherals=sorted(used)))
    possible = set(TICKS) - used
    if {"TIM4", "TIM16"} <= used:  # the timers of PB8
        assert ("other-code-peripheral", "robot.tcf") in messages
    elif possible and not messages:
        assert found[TICK] in possible and found["motor", "pwm"] not in used and found["encoder", "encoder"] not in used
    else:
        assert {id for id, _ in messages} <= {"too-many", "other-code-peripheral"}


@pytest.mark.parametrize("taken", ["TIM3", "TIM8"])
def test_an_encoder_gets_the_other_timer_of_its_pins(taken: str) -> None:
    found, messages = check(ioc_text(peripherals=[taken]))
    assert messages == [] and {found["encoder", "encoder"], taken} == {"TIM3", "TIM8"}


@pytest.mark.parametrize(
    ("entries", "peripherals", "ids"),
    [
        ({"PE3.Signal": "GPIO_Output"}, [], ["other-code-pin"]),
        ({"PE3.Signal": "SPI4_NSS"}, ["SPI4"], ["other-code-pin"]),
        ({"PE3.Signal": "SPI4_NSS"}, [], []),  # the peripheral is switched off: CubeMX generates nothing for the pin
        ({"PE3.Signal": "USB_OTG_FS_DM"}, ["USB_OTG_FS"], ["other-code-pin"]),
        ({"PB8.Signal": "GPXTI8", "SH.GPXTI8.0": "GPIO_EXTI8", "SH.GPXTI8.ConfNb": "1"}, [], ["other-code-pin"]),
        ({"PE3.Signal": "ADCx_INP3", "SH.ADCx_INP3.0": "ADC1_INP3,IN3-Single-Ended"}, ["ADC1"], ["other-code-pin"]),
        ({"PE3.Signal": "ADCx_INP3", "SH.ADCx_INP3.0": "ADC1_INP3,IN3-Single-Ended"}, ["ADC2"], []),
        ({"PE3 (LED).Signal": "GPIO_Output"}, [], ["other-code-pin"]),
        ({"PE3_C.Signal": "GPIO_Output"}, [], ["other-code-pin"]),
        ({"PE3.GPIO_Label": "GPIO_Output", "PE33.Signal": "GPIO_Output"}, [], []),
        ({"VP_SYS_VS_tim7.Signal": "SYS_VS_tim7"}, [], ["ioc-used-by-epg"]),
        ({"VP_TIM7_VS_ClockSourceINT.Signal": "TIM7_VS_ClockSourceINT"}, ["TIM7"], ["ioc-used-by-epg"]),
        ({"NVIC.USART3_IRQn": "true:1:0:false"}, [], []),
        ({"NVIC.USART3_IRQn": "true:0:0:false"}, [], ["ioc-priority"]),
        ({"NVIC.USART3_IRQn": "false:0:0:false"}, [], []),
        ({"NVIC.PriorityGroup": "NVIC_PRIORITYGROUP_4"}, [], []),
        ({"NVIC.PriorityGroup": "NVIC_PRIORITYGROUP_0"}, [], ["ioc-priority"]),
        ({"RCC.Tim1OutputFreq_Value": "240000000"}, [], ["ioc-clock"]),
        ({"RCC.USART16Freq_Value": "64000000"}, [], []),  # no component uses the clock
        ({"RCC.Tim1OutputFreq_Value": "200000000.5"}, [], []),  # unknown
    ],
)
def test_what_a_project_states(entries: dict[str, str], peripherals: list[str], ids: list[str]) -> None:
    assert [id for id, _ in check(ioc_text(entries, peripherals))[1]] == ids


@pytest.mark.parametrize(
    ("entries", "good"),
    [
        ({"Mcu.UserName": "", "Mcu.CPN": "STM32H743ZIT6"}, True),
        ({"Mcu.UserName": "", "Mcu.Name": "STM32H743Z(G-I)Tx"}, True),
        ({"Mcu.UserName": "STM32H743VITx"}, True),  # another package
        ({"Mcu.UserName": "STM32H753ZITx"}, False),
        ({"Mcu.UserName": "STM32F767ZITx"}, False),
    ],
)
def test_the_chip_must_be_that_of_the_target(entries: dict[str, str], good: bool) -> None:
    assert check(ioc_text(entries))[1] == ([] if good else [("ioc-other-chip", "robot.ioc")])


def test_zephyr_has_its_own_priorities_and_clock() -> None:
    """Its kernel sets priorities; EPG's own timer is for other platforms."""
    text = ioc_text({"NVIC.USART3_IRQn": "true:0:0:false"}, ["TIM7"])
    assert check(text, ROBOT.replace("freertos", "zephyr"))[1] == [("ioc-clock", "robot.ioc")]  # the core: 480 MHz


def test_a_simulation_ignores_the_contents_of_the_project() -> None:
    tcf = ROBOT.replace("nucleo_h743zi_freertos", "host")
    assert check(ioc_text(pins={"PE3": "GPIO_Output"}, chip="STM32F429ZITx"), tcf)[1] == []


@pytest.mark.parametrize("target", ["host", "nucleo_h743zi_freertos", "rpi_pico_bare_metal"])
def test_a_file_that_is_no_project_is_an_error_everywhere(target: str) -> None:
    assert ("ioc-not-cubemx", "robot.ioc") in check("garbage\n", ROBOT.replace("nucleo_h743zi_freertos", target))[1]


FIRMWARE = """version: 1
target: firmware
node: robot
clocks: {timers: 64 MHz}
communication: {middleware: none}
control: {period: 1 ms}
components:
  motor: {kind: pwm, frequency: 20 kHz}
"""


@pytest.mark.parametrize(
    ("clocks", "written"),
    [
        ({"APB1TimFreq": 84, "APB2TimFreq": 168}, "168 MHz"),  # F1, F4, G4, L4
        ({"APBTimFreq": 64}, "64 MHz"),  # C0, G0; the .tcf has this frequency
        ({"Tim1OutputFreq": 240, "Tim2OutputFreq": 240, "TimSysFreq": 480}, "240 MHz"),  # H7; the last one is SysTick's
        ({}, "<frequency>"),
    ],
)
def test_own_drivers_have_no_use_for_a_project(clocks: dict[str, int], written: str, tmp_path: Path) -> None:
    """The hint is the key of the .tcf that says the same: with it, the program is right."""
    entries = {f"RCC.{name}_Value": f"{value}000000" for name, value in clocks.items()}
    (tmp_path / "robot.ioc").write_text(ioc_text(entries, chip="STM32G474RETx"))
    (tmp_path / "robot.tcf").write_text(FIRMWARE)
    caller = Span("CMakeLists.txt", 4, 1, 15)
    problems = Diagnostics()
    request = Request("robot", "robot.tcf", Path(), Path(), ioc=tmp_path / "robot.ioc", beside=tmp_path, caller=caller)
    load_hardware(request, load_catalog(request.roots, problems), problems)
    assert [(item.id, item.span) for item in problems] == [("ioc-own-drivers", caller)]
    where = "the .tcf already has" if written == "64 MHz" else "write into the .tcf"
    assert f"{where} 'clocks: {{timers: {written}}}'" in problems.items[0].hint
    stated = [note for note in problems.items[0].notes if note.span.file.endswith("robot.tcf")]
    assert [note.span.line for note in stated] == [4]


def test_the_option_of_epg_check(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("robot.tcf").write_text(ROBOT)
    Path("robot.ioc").write_text(ioc_text(peripherals=["TIM6", "TIM8"]))
    assert main(["check", "--ioc", "robot.ioc", "robot.tcf", "--hardware", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["hardware"]["robot.tcf"]
    assert "timer TIM3" in [row["resource"] for row in rows]
    assert not {"timer TIM6", "timer TIM8"} & {row["resource"] for row in rows}


@pytest.mark.parametrize(
    ("communication", "is_usb"),
    [
        ("{middleware: console, transport: usb}", True),
        ("{middleware: console}", True),
        ("{middleware: xrce, transport: link, console: true}", True),
        ("{middleware: xrce, transport: link, console: {transport: other}}", False),
        ("{middleware: none}", False),
    ],
)
@pytest.mark.parametrize("file", [ioc_text(peripherals=["USB_OTG_FS"]), ioc_text(pins={"PA11": "GPIO_Output"})])
def test_usb_has_one_user(communication: str, is_usb: bool, file: str) -> None:
    """The transport of the middleware, and the console's."""
    links = "  link: {kind: uart, pins: {tx: PD8, rx: PD9}}\n  other: {kind: uart, pins: {tx: PD5, rx: PD6}}\n"
    tcf = ROBOT.replace("{middleware: none}", communication) + links
    _, problems = check(file, tcf)
    found = [("other-code-transport", "robot.tcf")] if is_usb else []
    assert [problem for problem in problems if problem[0].startswith("other-code")] == found
