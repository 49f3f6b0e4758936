# SPDX-License-Identifier: Apache-2.0
"""JIWY's image on the emulated STM32H743 with a test at its console, and without a robot.

>>> # chip = start("bare_metal")
>>> # ask(chip, "version")
"""

from __future__ import annotations

import re

from tests.doubles.stm32.machine import Machine
from tests.doubles.toolchain import skip_if_missing, unicorn
from tests.platforms.stm32.images import images


def start(platform: str, name: str = "jiwy") -> Machine:
    """Four clocks for an instruction."""
    skip_if_missing(unicorn)
    chip = Machine(images(platform, "console") / f"{name}_firmware.elf", clocks=4)
    chip.flash.erase_time = 0.01
    boot(chip)
    return chip


def boot(chip: Machine) -> None:
    chip.run_to("main")
    chip.run(0.03)
    chip.uarts[3].line.take()


def ask(chip: Machine, command: str) -> str:
    line = chip.uarts[3].line
    line.send(command.encode() + b"\r\n")
    chip.run_until(lambda: b"ok " in line.received or b"error" in line.received, longest=0.5)
    chip.run(0.01)
    return line.take().decode()


def stats(chip: Machine) -> dict[str, str]:
    return dict(re.findall(r"(\w+)=(\S+)", ask(chip, "stats")))
