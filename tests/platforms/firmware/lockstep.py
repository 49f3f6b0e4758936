# SPDX-License-Identifier: Apache-2.0
"""JIWY's controller on a board and the host's robot on this computer, one tick at a time.

``mps2/lockstep.c`` is the other end; ``mps2/frames.h`` describes the frames.
"""

from __future__ import annotations

import ctypes
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.doubles.mps2.qemu import Board, receive

SIGNALS = (
    *(f"inputs.{name}" for name in ("position_pan", "position_tilt", "setpoint_pan", "setpoint_tilt")),
    *(f"outputs.{name}" for name in ("encoder_reset_pan", "encoder_reset_tilt", "pan_logging", "tilt_logging")),
    *(f"outputs.{name}" for name in ("pwm_pan", "pwm_tilt")),
)
"""The model's ports, in the order of a frame."""
SETPOINTS, START = 1, 2
PERIOD_NS = 1_000_000
CYCLE = struct.Struct("<2I4B4I10d")


@dataclass
class Run:
    """``rows``: the model's ports in each cycle; ``counts``: of pan and tilt, before they wrap.  The others are EPG's
    statistics at the end."""

    rows: list[tuple[float, ...]]
    counts: list[tuple[int, ...]]
    cycles: int = 0
    missed: int = 0
    overruns: int = 0
    fault: int = 0


def run(
    board: Board, robot: Path, ticks: int, setpoints: Mapping[int, tuple[float, float]], first: Sequence[int]
) -> Run:
    """Runs ``ticks`` cycles; ``setpoints`` of pan and tilt by the tick that takes them.

    ``first``: counts of pan and tilt before the robot moves.
    """
    library = ctypes.CDLL(str(robot))
    counts, levels, directions = (ctypes.c_uint32 * 2)(), (ctypes.c_uint32 * 2)(), (ctypes.c_uint8 * 4)()
    (line,) = board.lines
    result = Run([], [])
    library.robot_start()
    for tick in range(ticks):
        library.robot_sense(ctypes.c_uint64(tick * PERIOD_NS), counts)
        new = setpoints.get(tick, ())
        flags = (START if tick == 0 else 0) | (SETPOINTS if new else 0)
        signed = (ctypes.c_int32(count).value for count in counts)
        result.counts.append(tuple(begin + count for begin, count in zip(first, signed, strict=True)))
        shown = (count % 2**64 for count in result.counts[-1])
        line.sendall(struct.pack("<3QB", tick * PERIOD_NS, *shown, flags) + struct.pack(f"<{len(new)}d", *new))
        cycle = CYCLE.unpack(receive(line, CYCLE.size))
        levels[:], directions[:] = cycle[:2], cycle[2:6]
        library.robot_actuate(levels, directions)
        result.cycles, result.missed, result.overruns, result.fault = cycle[6:10]
        result.rows.append(cycle[10:])
    return result
