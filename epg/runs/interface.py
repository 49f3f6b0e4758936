# SPDX-License-Identifier: Apache-2.0
"""The names of topics, signals and components of a target or of a system, which a scenario can use."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.runs.executable import fail, patience
from epg.runs.scenario import Scenario


@dataclass(frozen=True)
class Interface:
    """The names that a scenario can use.

    ``names`` are the names of each kind: "topic", "input", "component", "signal" and "target".  ``system`` is the name
    of the system, and empty for one target, which is called "" here.  ``topics`` are the topics of each target: their
    names in scenarios and their own names.  ``connected`` are the topics that targets of the system send to each other.
    """

    names: Mapping[str, Sequence[str]]
    topics: Mapping[str, Mapping[str, str]]
    system: str = ""
    connected: frozenset[str] = frozenset()


def read_interface(executable: Path) -> Interface:
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
    interface = interface_of(done.stdout)
    if done.returncode != 0 or not interface.names["signal"]:
        message = f"'{executable.name}' does not list its topics and signals"
        fail(executable, message, "it was built by an earlier EPG, or it is not a simulation: build it again")
    return interface


def interface_of(text: str) -> Interface:
    """The names in ``text``, which has a line ``kind,name`` for each name.

    The names of a target of a system follow its line ``target,name``.

    >>> found = interface_of("system,two\\ntarget,leader\\ntopic,/two/leader/pan\\nsignal,inputs.pan\\n")
    >>> found.names["signal"], found.topics["leader"]
    (['leader/inputs.pan'], {'leader/pan': '/two/leader/pan'})
    """
    names: dict[str, list[str]] = {kind: [] for kind in ("topic", "input", "component", "signal", "target")}
    topics: dict[str, dict[str, str]] = {"": {}}
    connected: set[str] = set()
    system = target = ""
    for line in text.splitlines():
        kind, _, own = line.partition(",")
        name = _name(system, target, own)
        if kind == "system":
            system, topics = own, {}
        elif kind == "target":
            target = own
            topics[target] = {}
            names[kind].append(target)
        elif kind == "connected":
            connected.add(name)
        else:
            if kind == "topic":
                topics[target][name] = own
            if name not in names.setdefault(kind, []):
                names[kind].append(name)
    names["topic"] = [name for name in names["topic"] if name not in connected]
    return Interface(names, topics, system, frozenset(connected))


def _name(system: str, target: str, own: str) -> str:
    """The name in scenarios of what its target calls ``own``."""
    if own.startswith("/"):
        return own.removeprefix(f"/{system}/") if system else own
    return f"{target}/{own}" if target else own


def check_names(scenario: Scenario, interface: Interface, diagnostics: Diagnostics) -> None:
    """Reports what the target or the system does not have: names in ``scenario``, and events."""
    if not interface.system:
        for span in scenario.of_systems:
            message = "only a scenario of a system names targets and failures"
            diagnostics.error("needs-a-system", span, message, hint="remove this, or simulate a system")
        _check_names(scenario, interface, "the target", diagnostics)
        return
    _check_names(scenario, interface, f"the system '{interface.system}'", diagnostics)


def _check_names(scenario: Scenario, interface: Interface, whole: str, diagnostics: Diagnostics) -> None:
    names = interface.names
    for kind, name, span in scenario.names:
        if name in names[kind]:
            continue
        if kind == "target":
            if interface.system:  # else it has been reported
                message = f"{whole} has no target '{name}'"
                hint = did_you_mean(name, names["target"], "targets")
                diagnostics.error("unknown-target", span, message, hint=hint)
        elif kind == "topic":
            message, hint = _unknown_topic(name, interface, whole)
            diagnostics.error("unknown-topic", span, message, hint=hint)
        elif kind == "signal":
            hint = did_you_mean(name, [signal for signal in names["signal"] if "." in signal], "signals")
            diagnostics.error("unknown-signal", span, f"{whole} has no signal '{name}'", hint=hint)
        else:
            message = f"{whole} has no component '{name}'"
            if name in names["component"]:
                message = f"'{name}' is not a digital input: only the level of a digital input can be forced"
            hint = did_you_mean(name, names["input"], "its digital inputs")
            hint = hint or "it has no digital input: its .tcf needs a digital_input"
            diagnostics.error("unknown-component", span, message, hint=hint)


def _unknown_topic(name: str, interface: Interface, whole: str) -> tuple[str, str]:
    """The message and the hint about a topic that a scenario cannot send."""
    topics = interface.names["topic"]
    if name in interface.connected:
        return f"'{name}' comes from a target of {whole}", "remove it: a topic of a system has one sender"
    hint = did_you_mean(name, topics, "it subscribes to")
    hint = hint or "it subscribes to no topic: its .tcf needs a subscriber, such as a ros_subscriber"
    if interface.system and not topics:
        hint = "it receives nothing from other programs: name the topic in 'world: {sends: [...]}'"
    return f"{whole} does not subscribe to '{name}'", hint
