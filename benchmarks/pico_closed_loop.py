# SPDX-License-Identifier: Apache-2.0
"""Runs JIWY's RP2040 images in EPG's emulator through the profile of examples/jiwy, and compares them with the host.

The emulator reads the PWM and direction pins, moves both motors, and produces the edges of the encoders.  Setpoints are
sent over the console every 33 ms.
"""

from __future__ import annotations

import tempfile
from array import array
from collections.abc import Sequence
from pathlib import Path

from measure import JIWY, ROOT, need
from report import Table, arguments, command_line, show

from epg.generator.diagnostics import Diagnostics
from epg.runs.tracking import WindowResult
from epg.simulate.plot import plot
from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js
from tests.platforms.pico.closed_loop.comparison import CONTROL, Comparison, compare
from tests.platforms.pico.closed_loop.robot import AXES
from tests.platforms.pico.images import PLATFORMS, freertos_kernel

SHORT = ROOT / "tests" / "platforms" / "pico" / "closed_loop" / "short.yaml"
PLOT = Path("pico_closed_loop.png")
TITLES = {"bare_metal": "image, bare metal", "freertos": "image, FreeRTOS"}


def main() -> None:
    options = arguments(__doc__, short=0, plot=0)
    need(pico_sdk, arm_gcc, node, rp2040js, freertos_kernel)
    scenario = SHORT if options.short else JIWY / "tracking.yaml"
    angles = {"pan": 0.2, "tilt": 0.2} if options.short else {"pan": 1.2, "tilt": 0.7}
    with tempfile.TemporaryDirectory() as folder:
        compared = {platform: compare(platform, scenario, angles, Path(folder)) for platform in PLATFORMS}
    show("pico_closed_loop", [tracking_table(compared), difference_table(compared)], options.write,
         command_line("pico_closed_loop"))  # fmt: skip
    if options.plot:
        draw(compared["bare_metal"])


def tracking_table(compared: dict[str, Comparison]) -> Table:
    runs = {TITLES[platform]: comparison.windows(comparison.image.columns) for platform, comparison in compared.items()}
    first = next(iter(compared.values()))
    runs["host"] = first.windows(first.simulated)
    head = ["axis", "from ... until, s", *(f"{title}: {what}" for title in runs for what in ("RMS", "largest"))]
    rows = []
    for number, result in enumerate(runs["host"]):
        cells = [f"{1000 * value:.1f}" for results in runs.values() for value in errors(results[number])]
        rows.append([result.axis, f"{result.window.start:g} ... {result.window.end:g}", *cells])
    passed = all(
        held.passed
        for comparison in compared.values()
        for columns in (comparison.image.columns, comparison.simulated)
        for held in comparison.checks(columns)
    )
    notes = [f"All limits of the scenario, homing's included: {'hold' if passed else 'do not hold'}."]
    return Table("Tracking error of JIWY, simulated, mrad", head, rows, notes)


def errors(result: WindowResult) -> tuple[float, float]:
    return (result.rms, result.largest)


def difference_table(compared: dict[str, Comparison]) -> Table:
    head = ["axis", *(f"{TITLES[platform]}: {what}" for platform in compared for what in ("RMS", "largest"))]
    rows = []
    for axis in AXES:
        counts = [
            f"{value / axis.rad_per_count:.2f}"
            for comparison in compared.values()
            for value in comparison.difference(axis.name)
        ]
        rows.append([axis.name, *counts])
    differing = {platform: differing_cycles(comparison) for platform, comparison in compared.items()}
    cycles = next(iter(compared.values())).image.cycles
    notes = [
        "Position of the image's robot minus that of the host's, after homing. The host's robot has springs for end "
        "stops and a dry friction that is viscous below 0.2 rad/s; by USB, setpoints come some ms later.",
        f"The host's controller, given the counts and setpoints that the image had in each of its {cycles:,} cycles, "
        "computes other bits in "
        + " and ".join(f"{count:,} cycles ({TITLES[platform]})" for platform, count in differing.items())
        + ".",
    ]
    return Table("Difference between the images' robot and the host's, encoder counts", head, rows, notes)


def differing_cycles(comparison: Comparison) -> int:
    names: Sequence[str] = (*CONTROL, *(f"plant.inputs.duty_{axis.name}" for axis in AXES))
    image, host = comparison.image.columns, comparison.replayed
    rows = zip(*(zip(image[name], host[name], strict=True) for name in names), strict=True)
    return sum(any(mine != hosts for mine, hosts in row) for row in rows)


def draw(comparison: Comparison) -> None:
    """Draws the run of an image, in the same way as `epg simulate`."""
    columns = {name: array("d", values) for name, values in comparison.image.columns.items()}
    if not plot(comparison.tracking(columns), comparison.windows(columns), PLOT, Diagnostics()):
        raise SystemExit("matplotlib is not installed: python3 -m pip install matplotlib")
    print(f"wrote {PLOT}")


if __name__ == "__main__":
    main()
