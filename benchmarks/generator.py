# SPDX-License-Identifier: Apache-2.0
"""Measures the time of EPG's Python code for JIWY: with a new folder, after an edit, and without any change.

The unit is the time of ``python -c pass`` with the same interpreter, measured in turns with everything else.
Python's ``.pyc`` files exist already: "cold" means a new output folder.
"""

from __future__ import annotations

import io
import pstats
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

from measure import EPG, JIWY, ROOT, all_in_turns, median_ratio, run
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
        profile = where_the_time_goes(folder)
    tables = [cost_table(times), profile_table(profile, times)]
    show("generator", tables, options.write, command_line("generator"))


def actions(folder: Path) -> Mapping[str, Callable[[], object]]:
    """The functions to be timed, by their names in the table."""
    python = [sys.executable]
    tcf = folder / "edited.tcf"

    def edited() -> None:
        before = tcf.read_text(encoding="utf-8") if tcf.exists() else ""
        period = "33 ms" if "20 ms" in before else "20 ms"
        tcf.write_text(f"version: 1\nextends: host_jiwy.tcf\ncommunication: {{period: {period}}}\n", encoding="utf-8")
        run([*python, EPG, "generate", "jiwy", *files(str(tcf)), *PLANT, "--output", folder / "edited"])

    def cold(output: Path, *arguments: str, **environment: str) -> None:
        shutil.rmtree(output, ignore_errors=True)
        run([*python, EPG, *arguments, "--output", str(output)], **environment)

    return {
        BARE: lambda: run([*python, "-S", "-c", "pass"]),
        PASS: lambda: run([*python, "-c", "pass"]),
        "import yaml": lambda: run([*python, "-c", "import yaml"]),
        "import jinja2": lambda: run([*python, "-c", "import jinja2"]),
        "import jsonschema": lambda: run([*python, "-c", "import jsonschema"]),
        LIBRARIES: lambda: run([*python, "-c", "import yaml, jinja2"]),
        CHECK: lambda: run([*python, EPG, "check", *files("rpi_pico2_freertos_jiwy.tcf")]),
        PICO: lambda: cold(folder / "pico", *PICO_ARGUMENTS),
        HOST: lambda: cold(folder / "host", *HOST_ARGUMENTS),
        EDIT: edited,
        UNCHANGED: lambda: run([*python, EPG, *HOST_ARGUMENTS, "--output", folder / "unchanged"]),
    }


def files(tcf: str) -> list[str]:
    return ["--tcf", tcf, "--model", str(JIWY / "model"), "--bindings", str(JIWY / "jiwy.bindings.yaml")]


PLANT = ["--plant", str(JIWY / "plant"), "--plant-bindings", str(JIWY / "plant.bindings.yaml")]
HOST_ARGUMENTS = ["generate", "jiwy", *files("host_jiwy.tcf"), *PLANT]


PICO_ARGUMENTS = ["generate", "jiwy", *files("rpi_pico2_freertos_jiwy.tcf")]


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


# Shares of the time ----------------------------------------------------------------------------------------------

GROUPS = (
    (r"frozen importlib|marshal|/importlib/|imp\.|io\.open_code|builtins\.exec", "finding and loading modules"),
    (r"/epg/models/", "epg: reading the models"),
    (r"/epg/(documents|catalog)/", "epg: reading .tcf, bindings and targets/"),
    (r"/epg/check/", "epg: checking"),
    (r"/epg/resolve/", "epg: wires and pins"),
    (r"/epg/emit/.*\.j2", "templates, running"),
    (r"/epg/emit/", "epg: emitting"),
    (r"/epg/", "epg: the rest"),
    (r"/jsonschema/|/jsonschema_specifications/|/referencing/|/rpds/|/attrs?/", "jsonschema"),
    (r"/jinja2/|/markupsafe/", "jinja2"),
    (r"/yaml/", "yaml"),
    (r"/re/|/sre_", "compiling regular expressions"),
    (r"/dataclasses\.py|/enum\.py|/typing\.py|/abc\.py|/_collections_abc\.py", "making dataclasses, enums, types"),
    (r"/argparse\.py", "argparse"),
)


def where_the_time_goes(folder: Path) -> dict[str, float]:
    """The share of each part in a cold run, after the start of the interpreter, from a profile.

    The time of a built-in function counts for its callers.  A profiler slows down calls more than other work, so the
    result is shares and not times.
    """
    profile = folder / "profile"
    run([sys.executable, "-c", PROFILED, ROOT, profile, *PICO_ARGUMENTS, "--output", folder / "profiled"])
    stats = pstats.Stats(str(profile), stream=io.StringIO()).stats  # type: ignore[attr-defined]
    costs: dict[str, float] = {}
    for (file, _, name), (_, _, own, _, callers) in stats.items():
        if file != "~":
            costs[group(file)] = costs.get(group(file), 0.0) + own
        elif group(name) != OTHERS or not callers:
            costs[group(name)] = costs.get(group(name), 0.0) + own
        else:
            for (caller, _, _), (_, _, share, _) in callers.items():
                costs[group(caller)] = costs.get(group(caller), 0.0) + share
    whole = sum(costs.values())
    return {name: cost / whole for name, cost in costs.items()}


PROFILED = """
import cProfile, sys
sys.path[0], profile = sys.argv[1:3]
del sys.argv[1:3]
cProfile.run("from epg.cli.main import main; main()", profile)
"""
"""Runs EPG as its ``__main__.py`` does, but ends the process as any Python program, so that the profile is written."""

OTHERS = "the rest of the standard library"


def group(place: str) -> str:
    """The name of the part to which a file or a built-in function belongs."""
    return next((name for pattern, name in GROUPS if re.search(pattern, place.replace("\\", "/"))), OTHERS)


def profile_table(shares: Mapping[str, float], times: Mapping[str, list[float]]) -> Table:
    own = median_ratio(times, PICO, PASS) - 1
    ordered = sorted(shares.items(), key=lambda item: -item[1])
    rows = [["the interpreter's own start", "1.0 x", ""]]
    rows += [[name, f"{share * own:.1f} x", f"{share:.0%}"] for name, share in ordered if share >= 0.005]
    least = median_ratio(times, LIBRARIES, PASS)
    note = (
        f"The run takes {own + 1:.1f} x. Of these, the start of Python and the import of yaml and jinja2 take "
        f"{least:.1f} x, which EPG cannot reduce. They are contained in the first rows: loading modules, regular "
        "expressions, the standard library, types."
    )
    return Table("Where a cold run for the Pico 2 goes", ["part", "of python -c pass", "share"], rows, [note])


if __name__ == "__main__":
    main()
