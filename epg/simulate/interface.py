# SPDX-License-Identifier: Apache-2.0
"""The names of a target's topics, signals and components, which a scenario can use."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from epg.diagnostics import Diagnostics, did_you_mean
from epg.simulate.executable import fail, patience
from epg.simulate.scenario import Scenario

Names = Mapping[str, Sequence[str]]
"""The names of each kind: "topic", "input", "component" or "signal"."""


def read_interface(executable: Path) -> Names:
    """The names that ``executable --interface`` prints.

    Raises UserError if the executable cannot be started, fails, or does not print signals.
    """
    try:
        done = subprocess.run(
            [str(executable.resolve()), "--interface"],
            capture_output=True,
            text=True,
            encoding="utf-8",
            errors="replace",
            timeout=patience(0.0),
            check=False,
        )
    except OSError as error:
        fail(executable, f"cannot run '{executable.name}': {error.strerror}", "build it first")
    except subprocess.TimeoutExpired:
        fail(executable, f"'{executable.name}' did not end", f"killed after {patience(0.0):.0f} s")
    names: dict[str, list[str]] = {kind: [] for kind in ("topic", "input", "component", "signal")}
    for line in done.stdout.splitlines():
        kind, _, name = line.partition(",")
        names.setdefault(kind, []).append(name)
    if done.returncode != 0 or not names["signal"]:
        message = f"'{executable.name}' does not list its topics and signals"
        fail(executable, message, "it was built by an earlier EPG, or it is not a simulation: build it again")
    return names


def check_names(scenario: Scenario, names: Names, diagnostics: Diagnostics) -> None:
    """Reports every name in ``scenario`` that the target does not have."""
    for kind, name, span in scenario.names:
        if name in names[kind]:
            continue
        if kind == "topic":
            hint = did_you_mean(name, names["topic"], "it subscribes to")
            hint = hint or "it subscribes to no topic: its .tcf needs a subscriber, such as a ros_subscriber"
            diagnostics.error("unknown-topic", span, f"the target does not subscribe to '{name}'", hint=hint)
        elif kind == "signal":
            hint = did_you_mean(name, [signal for signal in names["signal"] if "." in signal], "signals")
            diagnostics.error("unknown-signal", span, f"the target has no signal '{name}'", hint=hint)
        else:
            message = f"the target has no component '{name}'"
            if name in names["component"]:
                message = f"'{name}' is not a digital input: only the level of a digital input can be forced"
            hint = did_you_mean(name, names["input"], "its digital inputs")
            hint = hint or "it has no digital input: its .tcf needs a digital_input"
            diagnostics.error("unknown-component", span, message, hint=hint)
