"""What must hold of the control loop and of the board, whatever has been done to its communication."""

from __future__ import annotations

from tests.platforms.pico.closed_loop.robot import MOTOR_PERIOD
from tests.platforms.pico.timing.checks import LARGEST_ENTRY, LARGEST_SECOND_READ

from .board import Jiwy

STACK_RESERVE = 1.25
"""A stack has at least so much of what has been used of it."""


def assert_undisturbed(jiwy: Jiwy) -> dict[str, str]:
    """No cycle late, nothing counted that should not be, stacks large enough; the console's statistics."""
    stats = jiwy.stats()
    assert (stats["enabled"], stats["fault"]) == ("1", "none")
    for name in ("overruns", "missed", "faults", "outputs_late", "setpoints_dropped", "setpoint_timeouts"):
        assert stats[name] == "0", name
    for side in ("control", "communication"):
        assert int(stats[f"{side}_stack_used"]) * STACK_RESERVE <= int(stats[f"{side}_stack_size"]), side
    assert_on_time(jiwy)
    assert jiwy.faults() == []
    assert jiwy.pico.run(cycles=1)["resets"] == []
    return stats


def assert_on_time(jiwy: Jiwy) -> None:
    """Of each cycle since the last time: begun at its tick, and its outputs have acted at the same wrap after it.

    However long the cycle has computed: in motion the compiler's doubles take longer for some numbers than for others,
    which ``control.output_delay`` hides.
    """
    timing = jiwy.timing()
    assert timing.cycles > 300
    assert timing.missed == 0
    assert max(map(abs, timing.entry)) <= LARGEST_ENTRY
    assert max(map(abs, timing.first_read)) <= LARGEST_ENTRY
    assert max(map(abs, timing.last_read)) <= LARGEST_SECOND_READ
    assert len({written // MOTOR_PERIOD for written in timing.written}) == 1
    assert set(timing.actuation) <= {0}, "no level has acted at another wrap"
