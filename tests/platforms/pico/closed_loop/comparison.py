# SPDX-License-Identifier: Apache-2.0
"""A scenario run by an image and by the host: how well each follows its setpoints, and their difference."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.runs.recording import Signal
from epg.runs.reference import load_reference
from epg.runs.scenario import Scenario
from epg.runs.tracking import Check, Tracking, WindowResult, check, evaluate, track
from epg.simulate.load_scenario import load_scenario
from tests.platforms.pico.images import images

from .host import Columns, host_programs, replayed, simulated
from .recording import INPUTS, OUTPUTS, Recording, record
from .robot import AXES

PLANT = tuple(f"plant.{kind}_{axis.name}" for axis in AXES for kind in ("inputs.duty", "outputs.angle"))
CONTROL = tuple(f"{way}.{name}" for way, names in (("inputs", INPUTS), ("outputs", OUTPUTS)) for name in names)


@dataclass(frozen=True)
class Comparison:
    """``simulated``: the host with its own robot; ``replayed``: the host's controller with the image's inputs."""

    scenario: Scenario
    image: Recording
    simulated: Columns
    replayed: Columns

    def tracking(self, columns: Mapping[str, Sequence[float]]) -> list[Tracking]:
        signals = {name: Signal(columns["time"], values) for name, values in columns.items()}
        reference = load_reference(self.scenario.reference) if self.scenario.reference else None
        return [track(axis, self.scenario.profiles[axis.setpoint], signals, reference) for axis in self.scenario.axes]

    def windows(self, columns: Mapping[str, Sequence[float]]) -> list[WindowResult]:
        return [result for tracking in self.tracking(columns) for result in evaluate(tracking)]

    def checks(self, columns: Mapping[str, Sequence[float]]) -> list[Check]:
        """All limits of the scenario."""
        return [held for tracking in self.tracking(columns) for held in check(tracking, evaluate(tracking))]

    def difference(self, axis: str) -> tuple[float, float]:
        """RMS and largest difference in rad between the image's axis and the host's, after both have homed."""
        begin = next(a.homing.until for a in self.scenario.axes if a.name == axis and a.homing is not None)
        first = round(begin * 1000)
        name = f"plant.outputs.angle_{axis}"
        pairs = zip(self.image.columns[name][first:], self.simulated[name][first:], strict=True)
        distances = [mine - hosts for mine, hosts in pairs]
        return math.sqrt(math.fsum(d * d for d in distances) / len(distances)), max(map(abs, distances))


def compare(platform: str, scenario_file: Path, angles: Mapping[str, float], folder: Path) -> Comparison:
    """Runs ``scenario_file`` on the image of an RP2040 ``platform`` and on the host."""
    image = images("pico", platform, "jiwy_firmware", middleware="console") / "jiwy_firmware.elf"
    return compare_image(image, scenario_file, angles, folder)


def compare_image(
    image: Path, scenario_file: Path, angles: Mapping[str, float], folder: Path, *, core: int = 1, console: int = 0
) -> Comparison:
    """The same for any image; see :func:`record`."""
    diagnostics = Diagnostics()
    scenario = load_scenario(scenario_file, diagnostics)
    diagnostics.stop_if_errors()
    assert scenario is not None
    programs = host_programs(angles)
    recording = record(image, scenario, angles, core=core, console=console)
    host = simulated(programs, scenario, [*CONTROL, *PLANT], folder)
    return Comparison(scenario, recording, host, replayed(programs, recording, [*CONTROL, *PLANT], folder))
