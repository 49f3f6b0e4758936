# SPDX-License-Identifier: Apache-2.0
"""Measures the longest time between two turns of communication on an RP2040 while USB and a UART are flooded.

JIWY's images run from flash, in the emulator with the time of flash.  The ticks of core 1 are timed meanwhile.
"""

from __future__ import annotations

from measure import need
from report import Table, arguments, command_line, show

from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js
from tests.platforms.pico.images import freertos_kernel
from tests.platforms.pico.polls.measure import Polls, measure_uart, measure_usb

PLATFORMS = {"bare_metal": "bare metal", "freertos": "FreeRTOS"}


def main() -> None:
    options = arguments(__doc__, milliseconds=100, platforms=len(PLATFORMS))
    need(pico_sdk, arm_gcc, node, rp2040js, freertos_kernel)
    chosen = list(PLATFORMS)[: options.platforms]
    found = {platform: measured(platform, options.milliseconds) for platform in chosen}
    loads = [polls.load for polls in next(iter(found.values()))]
    rows = [[load, *(f"{each[at].longest * 0.008:,.0f}" for each in found.values())] for at, load in enumerate(loads)]
    head = ["load", *(f"{PLATFORMS[platform]}, us" for platform in chosen)]
    largest = max(abs(deviation) for each in found.values() for polls in each for deviation in polls.deviations)
    notes = [
        "Longest: from the begin of a turn of communication to the begin of the next one. It is meant to be at most a "
        "millisecond. Each line carries as many bytes as it can: USB 64 bytes in 45 to 105 us, the UART 460800 or "
        "921600 baud.",
        f"Meanwhile, the ticks of the control cycle deviated by at most {largest} cycles of 8 ns.",
        "Simulated, with the cache of the flash and the contention of the cores. From its start on, core 1 must not "
        "access flash. The arithmetic is the compiler's, not the ROM's.",
    ]
    table = Table("Time between two turns of communication, RP2040, simulated", head, rows, notes)
    show("pico_polls", [table], options.write, command_line("pico_polls"))


def measured(platform: str, milliseconds: int) -> list[Polls]:
    return [*measure_usb(platform, milliseconds), *measure_uart(platform, milliseconds)]


if __name__ == "__main__":
    main()
