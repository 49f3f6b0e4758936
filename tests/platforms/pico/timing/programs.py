# SPDX-License-Identifier: Apache-2.0
"""The programs whose timing is measured: EPG's images, and JIWY written by hand with other kinds of tick."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tests.doubles.rp2040.build import build
from tests.platforms.pico.images import freertos_kernel

PROJECT = "benchmarks/pico"


@dataclass(frozen=True)
class Program:
    """An executable of ``benchmarks/pico`` and the functions that the tick calls, that read and that write.

    ``period``: of communication in ms, if it is compiled in.
    """

    title: str
    platform: str
    executable: str
    core: int
    tick: str
    read: str
    write: str
    period: int | None = None

    def image(self) -> Path:
        """Builds the image; SDK, compiler and kernel must be installed."""
        variables = {"PLATFORM": self.platform}
        if self.platform == "smp":
            variables["FREERTOS_KERNEL_PATH"] = str(freertos_kernel())
        return build(PROJECT, targets=[self.executable], variables=variables) / f"{self.executable}.elf"


def generated(platform: str, period: int) -> Program:
    """EPG's image of an RP2040 platform that communicates every ``period`` ms: 33, 10 or 1."""
    title = {"bare_metal": "EPG, bare metal", "freertos": "EPG, FreeRTOS"}[platform]
    functions = ("on_wrap", "epg_port_quadrature_count", "epg_port_pwm_write")
    return Program(title, platform, f"jiwy_firmware_{period}", 1, *functions, period)


def by_hand(executable: str) -> Program:
    title, platform, core = {
        "by_hand_alarm_core0": ("alarm pool, core 0", "bare_metal", 0),
        "by_hand_alarm_core1": ("alarm pool, core 1", "bare_metal", 1),
        "by_hand_wrap_core1": ("PWM wrap, core 1", "bare_metal", 1),
        "by_hand_smp": ("FreeRTOS SMP, core 1 parked", "smp", 1),
    }[executable]
    return Program(title, platform, executable, core, "on_tick", "read_inputs", "write_outputs")
