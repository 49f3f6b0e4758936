# SPDX-License-Identifier: Apache-2.0
"""Measures the time of EPG's Python code for JIWY: with a new folder, after an edit, and without any change.

The unit is the time of ``python -c pass`` with the same interpreter, measured in turns with everything else.
Python's ``.pyc`` files exist already: "cold" means a new output folder.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

from measure import EPG, JIWY, all_in_turns, jiwy_files, median_ratio, run
from report import Table, arguments, command_line, milliseconds, show

PASS = "python -c pass"
BARE = "python -S -c pass"
LIBRARIES = "import yaml, jinja2"
CHECK = "epg check, Pico 2"
PICO = "epg generate, Pico 2, new folder"
HOST = "epg generate, host with plant, new folder"
EDIT = "epg generate, host with plant, one value edited"
UNCHANGED = "epg generate, host with plant, nothing changed"
BORDER = 14.0


def main() -> None:
    options = arguments(__doc__, rounds=21)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        times = all_in_turns(actions(folder), options.rounds)
    show("generator", [cost_table(times)], options.write, command_line("generator"))


def actions(folder: Path) -> Mapping[str, Callable[[], object]]:
    """The functions to be timed, by their names in the table."""
    python = [sys.executable]
    tcf = folder / "edited.tcf"

    def edited() -> None:
        before = tcf.read_text(encoding="utf-8") if tcf.exists() else ""
        period = "33 ms" if "20 ms" in before else "20 ms"
        tcf.write_text(f"version: 1\nextends: host_jiwy.tcf\ncommunication: {{period: {period}}}\n", encoding="utf-8")
        run([*python, EPG, "generate", "jiwy", *jiwy_files(str(tcf)), *PLANT, "--output", folder / "edited"])

    def cold(output: Path, *arguments: str, **environment: str) -> None:
        shutil.rmtree(output, ignore_errors=True)
        run([*python, EPG, *arguments, "--output", str(output)], **environment)

    return {
        BARE: lambda: run([*python, "-S", "-c", "pass"]),
        PASS: lambda: run([*python, "-c", "pass"]),
        LIBRARIES: lambda: run([*python, "-c", "import yaml, jinja2"]),
        CHECK: lambda: run([*python, EPG, "check", *jiwy_files("rpi_pico2_freertos_jiwy.tcf")]),
        PICO: lambda: cold(folder / "pico", *PICO_ARGUMENTS),
        HOST: lambda: cold(folder / "host", *HOST_ARGUMENTS),
        EDIT: edited,
        UNCHANGED: lambda: run([*python, EPG, *HOST_ARGUMENTS, "--output", folder / "unchanged"]),
    }


PLANT = ["--plant", str(JIWY / "plant"), "--plant-bindings", str(JIWY / "plant.bindings.yaml")]
HOST_ARGUMENTS = ["generate", "jiwy", *jiwy_files("host_jiwy.tcf"), *PLANT]
PICO_ARGUMENTS = ["generate", "jiwy", *jiwy_files("rpi_pico2_freertos_jiwy.tcf")]


def cost_table(times: Mapping[str, list[float]]) -> Table:
    rows = []
    for name, values in times.items():
        ratio = median_ratio(times, name, PASS)
        rows.append([name, milliseconds(sorted(values)[len(values) // 2]), f"{ratio:.1f} x"])
    worst = max(median_ratio(times, name, PASS) for name in (PICO, HOST))
    judged = "holds" if worst <= BORDER else f"missed by {worst - BORDER:.1f} x"
    notes = [f"Aim: cold at most {BORDER:g} x `{PASS}`: {judged}. Each ratio is the median of {len(values)} rounds."]
    if median_ratio(times, PASS, BARE) > 2:
        notes.append(
            "This interpreter's own start is slow (its site-packages run code): use a fresh virtual environment."
        )
    return Table("Generator", ["what", "ms", "ratio"], rows, notes)


if __name__ == "__main__":
    main()
