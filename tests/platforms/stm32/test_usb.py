# SPDX-License-Identifier: Apache-2.0
"""JIWY as a USB device of the emulated STM32H743: enumeration, the agent's port and the console's, the cable."""

from __future__ import annotations

import re
import struct

import pytest

from tests.doubles.stm32.clocks import AHB1ENR, REVISION_Y
from tests.doubles.stm32.machine import Machine
from tests.doubles.stm32.nvic import FIRST
from tests.doubles.stm32.usb import INTERRUPT
from tests.doubles.stm32.usb_host import UsbHost
from tests.doubles.toolchain import skip_if_missing, unicorn
from tests.doubles.xrce_agent.messages import float64
from tests.platforms.pico.closed_loop.recording import INPUTS
from tests.platforms.stm32.images import PLATFORMS, images
from tests.platforms.stm32.masks import Masks
from tests.platforms.stm32.test_masks import FAILURES, documented
from tests.platforms.stm32.usb_agent import agent_on_usb

STACK_RESERVE = 1.25
"""A stack must be at least this many times as large as its largest use."""


def _chip(platform: str, middleware: str, **options: int) -> Machine:
    """Four clocks for an instruction.  It has started main()."""
    skip_if_missing(unicorn)
    chip = Machine(images(platform, middleware) / "usb_firmware.elf", clocks=4, **options)
    chip.run_to("main")
    return chip


def _ticks(chip: Machine) -> int:
    """How often the tick's interrupt was entered."""
    return chip.interrupts(_tick(chip))


def _tick(chip: Machine) -> int:
    source = chip.image.elf.parent / "epg/on_usb/on_usb_stm32.c"
    found = re.search(r"\.tick = \{\.timer = (\d+)", source.read_text(encoding="utf-8"))
    assert found
    return chip.timers[f"TIM{found[1]}"].kind.update


def _start(platform: str, middleware: str, **options: int) -> tuple[Machine, UsbHost]:
    """The device after the enumeration, with a console."""
    chip = _chip(platform, middleware, **options)
    host = UsbHost(chip)
    chip.run_until(lambda: host.configured, longest=0.3)
    host.ports[-1].open()
    chip.run_until(lambda: b"ready" in host.ports[-1].received, longest=0.1)
    host.ports[-1].take()
    return chip, host


def _ask(chip: Machine, host: UsbHost, command: str) -> str:
    port = host.ports[-1]
    port.send(command.encode() + b"\r\n")
    chip.run_until(lambda: b"ok " in port.received or b"error" in port.received, longest=0.5)
    chip.run(0.01)
    return port.take().decode()


def _assert_undisturbed(chip: Machine, host: UsbHost) -> None:
    """No tick was missed, the stack is large enough, no FIFO was used wrongly, and there was no reset."""
    stats = dict(re.findall(r"(\w+)=(\S+)", _ask(chip, host, "stats")))
    assert (stats["missed"], stats["overruns"], stats["fault"]) == ("0", "0", "none")
    assert int(stats["communication_stack_used"]) * STACK_RESERVE <= int(stats["communication_stack_size"])
    assert (chip.usb.overflows, host.stalls, chip.resets) == (0, 0, [])


@pytest.mark.parametrize("platform", PLATFORMS)
def test_the_host_sees_two_serial_ports(platform: str) -> None:
    chip, host = _start(platform, "xrce")
    device = host.descriptors[1]
    assert (device[8:12].hex(), len(host.ports)) == ("83044057", 2)
    texts = [host.texts[index] for index in (*device[14:17], *(port.port.text for port in host.ports))]
    assert texts == ["STMicroelectronics", "STM32", "0B0A09080706050403020100", "EPG ROS 2", "EPG console"]
    assert _ask(chip, host, "version").startswith("ok version name=on_usb node=JIWY_node ")
    priorities = chip.processor.nvic.priorities
    assert priorities[FIRST + INTERRUPT] > priorities[FIRST + _tick(chip)] == 0
    _assert_undisturbed(chip, host)


@pytest.mark.parametrize("platform", PLATFORMS)
def test_the_agent_and_the_console_work_at_once(platform: str) -> None:
    """Setpoints of the agent arrive; after the cable was pulled for longer than a session lasts, too."""
    chip, host = _start(platform, "xrce")
    agent = agent_on_usb(chip, host)
    for pulls, setpoint in enumerate((0.25, 0.5)):
        if pulls:
            host.unplug()
            agent.run(1500)
            host.plug()
            assert agent.run_until(lambda: len(agent.heard("rt/pan_publisher", agent.now() - 0.1)) > 1, 3000)
            host.ports[1].open()
            agent.run(20)
            assert _ask(chip, host, "version").startswith("ready ")
        agent.topics.publish("rt/pan_subscriber", float64(setpoint), reliable=False)
        agent.run(20)
        inputs = bytes(chip.processor.cpu.mem_read(chip.symbols["on_usb_inputs"], 8 * len(INPUTS)))
        assert dict(zip(INPUTS, struct.unpack(f"<{len(INPUTS)}d", inputs)))["setpoint_pan"] == setpoint
        assert "ok version" in _ask(chip, host, "version")
    agent.close()
    _assert_undisturbed(chip, host)


@pytest.mark.parametrize("platform", PLATFORMS)
def test_a_cable_that_is_pulled_and_put_back(platform: str) -> None:
    """What was sent before is not for the next program, and control goes on all the time."""
    chip, host = _start(platform, "console")
    host.ports[0].send(b"get\r\n")
    chip.run(0.0003)
    begin, ticks = chip.seconds, _ticks(chip)
    host.unplug()
    chip.run(0.05)
    host.plug()
    chip.run_until(lambda: host.configured, longest=0.3)
    assert (host.seen, len(host.ports)) == (2, 1)
    assert abs(_ticks(chip) - ticks - (chip.seconds - begin) * 1000) <= 1
    host.ports[0].open()
    chip.run(0.02)
    assert _ask(chip, host, "version").startswith("ready node=")
    _assert_undisturbed(chip, host)


def test_a_bus_reset_enumerates_anew() -> None:
    chip, host = _start("bare_metal", "console")
    host.bus_reset()
    chip.run_until(lambda: host.configured, longest=0.3)
    host.ports[0].open()
    chip.run(0.02)
    assert "ok version" in _ask(chip, host, "version")
    _assert_undisturbed(chip, host)


@pytest.mark.parametrize("platform", PLATFORMS)
def test_a_flood_disturbs_no_tick(platform: str) -> None:
    """Both ports, with packets of all lengths, and answers longer than the FIFO."""
    chip, host = _start(platform, "xrce")
    begin, ticks = chip.seconds, _ticks(chip)
    for number in range(40):
        host.ports[0].send(bytes(range(1 + 7 * number % 64)))
        host.ports[1].send(b"get\r\n" if number % 8 == 0 else b"x" * number + b"\r\n")
        chip.run(0.005)
    chip.run_until(lambda: not host.ports[1].to_send, longest=1)
    chip.run(0.1)
    assert host.ports[1].take().count(b"parameter Pan\\Homing\\duty=") == 5
    assert abs(_ticks(chip) - ticks - (chip.seconds - begin) * 1000) <= 1
    _assert_undisturbed(chip, host)


@pytest.mark.parametrize("platform", PLATFORMS)
def test_usb_masks_the_tick_nowhere_else(platform: str) -> None:
    """No function is added to those of the board's page, and masks by BASEPRI do not delay the tick."""
    chip, host = _start(platform, "xrce")
    masks = Masks(chip, _tick(chip))
    for command in ("get", "version"):
        host.ports[1].send(command.encode() + b"\r\n")
        host.ports[0].send(bytes(200))
        chip.run(0.02)
    host.unplug()
    chip.run(0.005)
    host.plug()
    chip.run_until(lambda: host.configured, longest=0.3)
    assert set(masks.longest_by_basepri.values()) <= {0}
    assert masks.functions <= set(documented()) | FAILURES
    assert {name: count for name, count in masks.longest.items() if count > documented()[name]} == {}


def test_it_works_with_silicon_of_revision_y() -> None:
    """The frames of OTG_FS have another number there as the source that trims HSI48."""
    chip, host = _start("bare_metal", "console", revision=REVISION_Y)
    assert "ok version" in _ask(chip, host, "version")


@pytest.mark.parametrize("problem", ["no supply", "other code"])
def test_a_device_that_cannot_start(problem: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The target does not start: no tick, and nothing on the bus."""
    chip = _chip("bare_metal", "console")
    host = UsbHost(chip)
    if problem == "no supply":
        monkeypatch.setattr(chip.clocks, "read_power", lambda offset: chip.clocks.power.get(offset, 0))
    else:
        chip.clocks.registers[AHB1ENR] = chip.clocks.registers.get(AHB1ENR, 0) | 1 << 27
    chip.run(0.03)
    assert (host.state, _ticks(chip), chip.resets) == ("detached", 0, [])
