# SPDX-License-Identifier: Apache-2.0
"""Measures the round trip of a Float64 through a target: ``examples/ping_pong`` on this computer.

    python benchmarks/ping_pong.py [--pings 300] [--flat 5000] [--write]

The middleware is dds.  The first row is an echo in Python instead of a target: it shows the time that the peer and DDS
take.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from measure import ROOT, run
from report import Table, arguments, command_line, show

EXAMPLE = ROOT / "examples/ping_pong"
sys.path[:0] = [str(ROOT), str(EXAMPLE / "peer")]

from summary import head, read_run, rows, summarise  # noqa: E402  # of the example

from epg.generator import bootstrap  # noqa: E402

QOS = {"best": "best_effort", "default": "reliable"}
DOMAIN = 92
"""The DDS domain of this benchmark."""

SHOWN = (0, 2, 3, 10, 7)
"""The columns of the example's table that the page has: label, lost, mean, 99 %, maximum."""

THESIS = (
    "The thesis measured means of 1.92 ms (bare metal, best/best) to 4.96 ms (FreeRTOS, default/default) on other "
    "hardware: a Pico 2 on USB, rcl, its agent and the peer on a Raspberry Pi 5."
)
"""Of the thesis's table E.1, the least and the greatest mean of the rows in which both topics have the same QoS."""


def build(folder: Path) -> Path:
    """Builds the four programs, optimised, and returns their folder."""
    options = ["-DPING_PONG_MIDDLEWARE=dds", "-DCMAKE_BUILD_TYPE=Release", f"-DPython3_EXECUTABLE={sys.executable}"]
    run(["cmake", "-S", EXAMPLE, "-B", folder, *options])
    run(["cmake", "--build", folder, "--parallel"])
    return folder


@contextmanager
def process(command: Sequence[str | Path], environment: dict[str, str]) -> Iterator[None]:
    started = subprocess.Popen(
        list(map(str, command)), env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield
    finally:
        started.terminate()
        started.wait()


def measure(name: str, options: Sequence[str], environment: dict[str, str], pings: int, flat: int) -> list[list[str]]:
    """The rows of the table for 30 Hz and for pings without a pause."""
    cells = []
    with tempfile.TemporaryDirectory() as folder:
        for rate, count in ((30, pings), (0, flat)):
            file = Path(folder) / f"{rate}.csv"
            command = [sys.executable, str(EXAMPLE / "peer/measure.py"), "--label", name, "--csv", str(file)]
            command += ["--rate", str(rate), "--count", str(count), *options]
            subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
            cells += rows([summarise(read_run(file))])
    return cells


def chosen(cells: Sequence[str]) -> list[str]:
    """The cells of a row that the page has."""
    return [cells[column] for column in SHOWN]


def main() -> int:
    options = arguments(__doc__ or "", pings=300, flat=5000)
    bootstrap.ensure("ros")
    from tests.ros2.network import network

    with tempfile.TemporaryDirectory() as temporary, network(DOMAIN) as net:
        packages = str(bootstrap.package_folder("ros"))
        environment = {**net.environment, "PYTHONPATH": f"{packages}:{net.environment.get('PYTHONPATH', '')}"}
        found = measure("echo in Python", ["--baseline"], environment, options.pings, options.flat)
        programs = build(Path(temporary))
        for name, reliability in QOS.items():
            program = programs / f"ping_pong_{name}_{name}_host"
            qos = ["--publisher", reliability, "--subscriber", reliability]
            with process([program, "--realtime", "--quiet"], environment):
                found += measure("host, dds", qos, environment, options.pings, options.flat)
    shown = [chosen(row) for row in found]
    columns = ["what, publisher/subscriber, rate", *chosen(head())[1:]]
    load = os.getloadavg()[0]
    notes = [f"The load average of this computer was {load:.0f}: where it is high, maxima are other programs'."]
    table = Table("Round trip on this computer", columns, shown, [*notes, THESIS])
    show("ping_pong", [table], options.write, command_line("ping_pong"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
