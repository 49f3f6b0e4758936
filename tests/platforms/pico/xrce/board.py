# SPDX-License-Identifier: Apache-2.0
"""JIWY's predefined firmware as a ROS 2 node: the robot on its pins, an agent on one port, the console on the other.

>>> # with Jiwy("bare_metal") as jiwy:
>>> #     jiwy.home()
>>> #     jiwy.point(0.5, 0.4)
>>> #     jiwy.agent.run(500)
>>> #     jiwy.angle("pan")
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from pathlib import Path

from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.xrce_agent.messages import float64, read_float64
from tests.platforms.pico.closed_loop.robot import AXES, angle, connect
from tests.platforms.pico.images import images
from tests.platforms.pico.timing.measure import MOTOR_SLICES, Timing, evaluate

from .agent import BoardAgent

AGENT_PORT, CONSOLE_PORT = 0, 1
HOMED = 900
"""Milliseconds after which both axes have homed from 0.12 rad and have stopped."""
SPANS = {
    "tick": ("on_wrap", "return"),
    "read": ("epg_port_quadrature_count", "return"),
    "write": ("epg_port_pwm_write", "return"),
}
"""The timed parts of the control cycle: from one function to another, or to its own return."""


def image(platform: str, executable: str) -> Path:
    return images("pico", platform, executable, middleware="xrce_console") / f"{executable}.elf"


class Jiwy:
    """A Pico after its start, its console open, connected to its agent."""

    core = 1
    """The core of control."""
    spans: Mapping[str, tuple[str, str]] = SPANS
    start = 40
    """Milliseconds from the reset until USB is configured."""

    def __init__(
        self, platform: str, executable: str = "jiwy_firmware", seed: int = 3, elf: Path | None = None
    ) -> None:
        self.platform = platform
        self._reconnects = 0
        self._since = 0
        self.pico = Emulator(elf or image(platform, executable), usb={"seed": seed, "open": False})
        connect(self.pico, {"pan": 0.12, "tilt": 0.12})
        for name, (begin, end) in self.spans.items():
            self.pico.call("watch_span", name=name, core=self.core, **{"from": begin, "to": end})
        self.pico.call("watch_pwm", slices=list(MOTOR_SLICES))
        self.pico.run(milliseconds=self.start)
        assert self.pico.call("usb")["state"] == "configured"
        self.pico.call("usb_open", port=CONSOLE_PORT)
        self.pico.run(milliseconds=5)
        self.agent = self.connect()

    def connect(self) -> BoardAgent:
        """The agent, after the first message of the board."""
        agent = BoardAgent(self.pico)
        agent.wait_for("rt/pan_publisher")
        return agent

    def __enter__(self) -> Jiwy:
        return self

    def __exit__(self, *_: object) -> None:
        self.agent.close()
        self.pico.close()

    def home(self) -> None:
        self.agent.run(HOMED)
        for axis in AXES:
            assert abs(self.angle(axis.name)) < axis.rad_per_count, "homed"

    def point(self, pan: float, tilt: float) -> None:
        self.agent.topics.publish("rt/pan_subscriber", float64(pan), reliable=False)
        self.agent.topics.publish("rt/tilt_subscriber", float64(tilt), reliable=False)

    def angle(self, axis: str) -> float:
        """The true angle of the camera, in rad."""
        return angle(self.pico, axis)

    def position(self, axis: str) -> float:
        """The angle in the node's newest message."""
        return read_float64(self.agent.heard(f"rt/{axis}_publisher")[-1].data)

    def stats(self) -> dict[str, str]:
        """The statistics that the console prints, on the second serial port."""
        self.pico.receive(port=CONSOLE_PORT)
        self.pico.send("\nstats\n", port=CONSOLE_PORT)
        said = ""

        def answered() -> bool:
            nonlocal said
            said += self.pico.receive(port=CONSOLE_PORT)
            return "ok stats" in said

        assert self.agent.run_until(answered, milliseconds=500), said
        return dict(re.findall(r"(\w+)=(\S+)", said))

    def begin(self) -> None:
        """Restarts the counts of reconnects() and timing()."""
        self._reconnects = int(self.stats()["reconnects"])
        self.timing()

    def reconnects(self) -> int:
        """The reconnections of the agent since :meth:`begin`, as the console counts them."""
        return int(self.stats()["reconnects"]) - self._reconnects

    def timing(self) -> Timing:
        """The timing of all control cycles since the last call, by the emulator's clock."""
        ticks, *others = (self.pico.call("span", name=name)["passages"] for name in ("tick", "read", "write"))
        whole = [tick for tick in ticks if tick[0] >= self._since]  # the last call may have been within a cycle
        self._since = self.pico.cycle
        return evaluate(whole, *others, self.pico.call("take", log="pwm"))

    def faults(self) -> Collection[object]:
        found: list[object] = self.pico.call("faults")
        return found
