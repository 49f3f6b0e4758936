# SPDX-License-Identifier: Apache-2.0
"""While core 0 writes to flash, its interrupts are off: nothing that arrives meanwhile is lost.

`save` on the console erases a sector and programs two pages.  Core 1 must not access flash.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import pytest

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND, Emulator
from tests.platforms.pico.closed_loop.robot import AXES, WRAP_EXCEPTION, connect
from tests.platforms.pico.images import PLATFORMS, images, skip_unless_emulated

TYPICAL, SLOWEST = (45_000, 400), (400_000, 3_000)
"""Microseconds of erasing a sector and of programming a page: data sheet of the W25Q16JV, 9.6."""
UART, BAUD, RING = 0, 921600, 8192
AGENT, CONSOLE = 0, 1
PARAMETER = r"Pan\PID\kp"


def write_ms(times: tuple[int, int]) -> float:
    erase, program = times
    return (erase + 2 * program) / 1000


@dataclass
class Bench:
    """A board whose console is on USB or on a UART; JIWY is disabled."""

    pico: Emulator
    port: int | None
    """The console's serial port on USB; None: it is on the UART."""

    def send(self, text: str) -> None:
        if self.port is None:
            self.pico.call("uart_send", uart=UART, hex=text.encode().hex())
        else:
            self.pico.send(text, port=self.port)

    def heard(self) -> str:
        if self.port is None:
            return bytes.fromhex(self.pico.call("uart_receive", uart=UART)).decode()
        return self.pico.receive(port=self.port)

    def ask(self, line: str, milliseconds: float = 10) -> str:
        self.heard()
        self.send(line + "\n")
        self.pico.run(milliseconds=milliseconds)
        return self.heard()

    def ready(self) -> Bench:
        self.pico.run(milliseconds=50)
        assert "ok disable" in self.ask("disable")
        assert "ok set" in self.ask(f"set {PARAMETER}=2")
        self.pico.call("watch_exceptions", numbers=[WRAP_EXCEPTION])
        self.pico.call("watch_span", name="cycle", core=1, **{"from": "epg_control_cycle", "to": "return"})
        return self

    def save(self, limit: float = 5) -> None:
        """Runs until the first word of flash is erased."""
        self.pico.call("watch_flash", stop_after=1)
        self.send("save\n")
        assert self.pico.run(milliseconds=limit)["reason"] == "flash"

    def assert_control_is_undisturbed(self) -> None:
        """Every control cycle since :meth:`ready` begins at t0 + k T; ticks during the write have none."""
        entries = [cycle for cycle, _, _, entered in self.pico.call("take", log="exceptions") if entered]
        cycles = [passage[0] for passage in self.pico.call("span", name="cycle")["passages"]]
        ticks = [max(entry for entry in entries if entry < cycle) for cycle in cycles if cycle > entries[0]]
        assert len(ticks) > 20
        assert {(tick - ticks[0]) % CYCLES_PER_MILLISECOND for tick in ticks} == {0}
        stats = self.ask("stats", 60)
        for line in ("stat missed=0", "stat overruns=0", "fault=none"):
            assert line in stats, stats
        assert "ok enable" in self.ask("enable")
        assert self.pico.call("faults") == []
        assert self.pico.run(cycles=1)["resets"] == []


def _started(pico: Emulator) -> None:
    connect(pico, {"pan": 0.12, "tilt": 0.12})
    pico.run_until("sleep_between_ticks", core=1)
    pico.call("forbid_flash", core=1)


@pytest.fixture(params=PLATFORMS)
def on_usb(request: pytest.FixtureRequest) -> Iterator[Callable[[tuple[int, int]], Bench]]:
    """Makes a board with an agent's port and a console on USB."""
    skip_unless_emulated(request.param)
    made: list[Emulator] = []

    def make(times: tuple[int, int]) -> Bench:
        elf = images("pico", request.param, "user_jiwy", middleware="xrce_console") / "user_jiwy.elf"
        made.append(Emulator(elf, wait_states=True, flash_times=times, usb={"seed": 3}))
        _started(made[-1])
        return Bench(made[-1], CONSOLE).ready()

    yield make
    for pico in made:
        pico.close()


@pytest.fixture(params=PLATFORMS)
def on_uart(request: pytest.FixtureRequest) -> Iterator[Callable[[tuple[int, int]], Bench]]:
    """Makes a board with a console on a UART."""
    skip_unless_emulated(request.param)
    made: list[Emulator] = []

    def make(times: tuple[int, int]) -> Bench:
        variables = {"PLATFORM": request.param, "RECEIVE": str(RING)}
        folder = build("tests/platforms/pico/uart/project", targets=["wired_firmware"], variables=variables)
        made.append(Emulator(folder / "wired_firmware.elf", wait_states=True, flash_times=times))
        made[-1].call("uart_send", uart=UART, baud=BAUD)
        _started(made[-1])
        return Bench(made[-1], None).ready()

    yield make
    for pico in made:
        pico.close()


def setpoints(bench: Bench, count: int) -> None:
    """Lines at the full rate of the line, each of which the console answers."""
    draw = random.Random(1)
    bench.send("".join(f"pan_subscriber={draw.uniform(0.1, 0.9):.6f}\n" for _ in range(count)))


def test_a_uart_receives_at_its_full_rate(on_uart: Callable[[tuple[int, int]], Bench]) -> None:
    bench = on_uart(TYPICAL)
    bench.save()
    count = int(write_ms(TYPICAL) * BAUD / 10_000 / len("pan_subscriber=0.123456\n"))
    setpoints(bench, count)
    bench.pico.run(milliseconds=write_ms(TYPICAL) - 1)
    assert bench.pico.call("uart", uart=UART)["waiting"] < 100, "they have arrived before the end of the write"
    bench.pico.run(milliseconds=count * 2)
    said = bench.heard()
    assert said.count("ok save") == 1
    assert said.count("ok setpoint") == count
    bench.assert_control_is_undisturbed()


def test_the_slowest_flash(on_uart: Callable[[tuple[int, int]], Bench]) -> None:
    """More arrives than the buffer holds; that is counted, and the console goes on with what came last."""
    bench = on_uart(SLOWEST)
    bench.save()
    setpoints(bench, int(write_ms(SLOWEST) * BAUD / 10_000 / len("pan_subscriber=0.123456\n")))
    bench.pico.run(milliseconds=write_ms(SLOWEST) + 900)
    said = bench.heard()
    assert said.count("ok save") == 1
    assert said.count("ok setpoint") > RING // 24 - 5
    bench.assert_control_is_undisturbed()


@pytest.mark.parametrize("times", [TYPICAL, SLOWEST])
def test_the_host_of_usb_waits(on_usb: Callable[[tuple[int, int]], Bench], times: tuple[int, int]) -> None:
    """The chip answers NAK by itself: every line is carried out after the write, and every port goes on."""
    bench = on_usb(times)
    bench.save()
    setpoints(bench, 100)
    bench.pico.send("\x7e" * 2000, port=AGENT)
    bench.pico.run(milliseconds=write_ms(times) - 1)
    assert "ok" not in bench.heard(), "core 0 is still writing"
    bench.pico.run(milliseconds=300)
    said = bench.heard()
    assert said.count("ok save") == 1
    assert said.count("ok setpoint") == 100
    bench.assert_control_is_undisturbed()


def assert_a_stop_wins(bench: Bench) -> None:
    """The first cycle after the write sees it: the enable before it does not act.  An enable after it acts."""
    pins = [pin for axis in AXES for pin in axis.outputs]
    bench.pico.call("watch_pins", pins=pins)
    bench.save()
    bench.send("enable\n")
    bench.pico.run(milliseconds=write_ms(TYPICAL) / 2)
    bench.send("disable\n")
    bench.pico.run(milliseconds=write_ms(TYPICAL) / 2 - 1)
    assert "ok" not in bench.heard(), "core 0 is still writing"
    bench.pico.run(milliseconds=100)
    said = bench.heard()
    assert "error enable refused: stopped by" in said
    assert "ok disable" in said
    assert "state enabled=1" not in said
    assert [edge for edge in bench.pico.call("take", log="pins") if edge[2]] == []
    bench.assert_control_is_undisturbed()


def test_a_stop_over_usb_during_the_write_wins(on_usb: Callable[[tuple[int, int]], Bench]) -> None:
    assert_a_stop_wins(on_usb(TYPICAL))


def test_a_stop_over_a_uart_during_the_write_wins(on_uart: Callable[[tuple[int, int]], Bench]) -> None:
    assert_a_stop_wins(on_uart(TYPICAL))
