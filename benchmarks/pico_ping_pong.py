# SPDX-License-Identifier: Apache-2.0
"""Measures the round trip of a Float64 through a Pico: ``examples/ping_pong`` in the emulator.

The time is simulated, with the tests' agent on USB.  It consists of the host's packets, the board's poll, the echo and
the way back.  The work of an agent, an operating system and DDS is not part of it, although they take longer than the
board.
"""

from __future__ import annotations

from measure import need
from report import Table, arguments, command_line, show

from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js
from tests.doubles.xrce_agent.bare import libraries
from tests.platforms.pico.images import freertos_kernel
from tests.platforms.pico.ping_pong.round_trip import QOS, Board, head, programs, rows, summarise

SHOWN = (0, 2, 3, 10, 7)
"""The columns of the example's table that the page has: label, lost, mean, 99 %, maximum."""
QOS_OF_BOTH = [(name, name) for name in QOS]
PLATFORMS = {"bare_metal": "Pico, bare metal", "freertos": "Pico, FreeRTOS"}


def main() -> None:
    options = arguments(__doc__, pings=300, flat=5000, platforms=len(PLATFORMS), combinations=len(QOS_OF_BOTH))
    need(pico_sdk, arm_gcc, node, rp2040js, freertos_kernel, libraries)
    summaries = []
    for platform in list(PLATFORMS)[: options.platforms]:
        images = programs(platform, QOS_OF_BOTH[: options.combinations])
        for combination, image in images.items():
            with Board(image, combination) as board:
                name = f"{PLATFORMS[platform]}, {'/'.join(combination)}"
                summaries.append(summarise(board.measure(30.0, options.pings, f"{name}, 30 Hz")))
                summaries.append(summarise(board.measure(0.0, options.flat, f"{name}, flat out")))
    notes = [
        "Simulated: a full-speed USB host whose packets take 45 to 105 us, one in ten up to a frame of 1 ms more.",
    ]
    columns = ["image, publisher/subscriber, rate", *(head()[column] for column in SHOWN[1:])]
    shown = [[row[column] for column in SHOWN] for row in rows(summaries)]
    table = Table("Round trip through a Pico, simulated", columns, shown, notes)
    show("pico_ping_pong", [table], options.write, command_line("pico_ping_pong"))


if __name__ == "__main__":
    main()
