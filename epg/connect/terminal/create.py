# SPDX-License-Identifier: Apache-2.0
"""The terminal's first questions if a model has no project: which target, which folder, which name."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from epg.connect.session import Refused, Session
from epg.connect.terminal.console import Console
from epg.connect.terminal.message import say_refused
from epg.new.new_project import project_name

WAIT = 60.0
"""Seconds between two looks at the list of configurations; reading it takes about one."""

PredefinedData = Mapping[str, Any]


class Left(Exception):
    """The user has asked to leave."""


def create_project(session: Session, console: Console) -> None:
    """Asks the user until there is a project.  Raises Left if the user leaves, or if the model cannot be read."""
    state = session.state()
    while not state["configurations"]:
        console.over("reading the configurations ...")
        state = session.wait(state["version"], WAIT)
    model = state["model"]
    if model is None:
        for problem in state["diagnostics"]:
            console.say(f"{problem['file']}: {problem['severity']}: {problem['message']}")
        raise Left
    counts = f"{len(model['inputs'])} inputs, {len(model['outputs'])} outputs, a step every {model['step']:g} s"
    console.say(f"Model {model['name']} ({model['origin']}): {counts}")
    choice = _choose(state["configurations"], console)
    proposal = state["create"]
    while True:
        console.say()
        folder = console.ask("folder of the new project", proposal["folder"])
        folder = os.path.abspath(os.path.expanduser(folder))  # relative to the current folder, as usual in a terminal
        usual = proposal["name"] if folder == proposal["folder"] else project_name(Path(folder))
        name = console.ask("name of the target", usual)
        try:
            session.act("create", {"configuration": choice["name"], "folder": folder, "name": name})
            return
        except Refused as problem:
            say_refused(problem, console)


def _choose(configurations: Sequence[PredefinedData], console: Console) -> PredefinedData:
    """Asks for one configuration by its number or name.  Any other text is a filter for the list."""
    possible = sorted((choice for choice in configurations if choice["possible"]), key=_relevance)
    shown = possible
    console.say()
    console.say("Choose a target:")
    _list(shown, possible, console)
    while True:
        only = shown[0]["name"] if len(shown) == 1 else ""
        answer = console.ask("number, name, part of a name to filter, or q", only)
        named = {choice["name"]: choice for choice in possible}.get(answer)
        if named is not None:
            return named
        if answer == "q":
            raise Left
        if answer.isdecimal() and 0 < int(answer) <= len(possible):
            return possible[int(answer) - 1]
        fitting = _fitting(answer, possible)
        if fitting:
            shown = fitting
            _list(shown, possible, console)
        else:
            reason = {choice["name"]: choice["reason"] for choice in configurations}.get(answer)
            console.say(f"no target matches '{answer}'" if reason is None else f"{answer}: {reason}")


def _fitting(answer: str, choices: Sequence[PredefinedData]) -> list[PredefinedData]:
    """The choices that contain all words of ``answer``."""
    words = answer.casefold().split()
    return [choice for choice in choices if all(word in _text(choice) for word in words)]


def _list(shown: Sequence[PredefinedData], possible: Sequence[PredefinedData], console: Console) -> None:
    rows = [
        (str(possible.index(choice) + 1).rjust(3), choice["name"], _matches(choice), _description(choice))
        for choice in shown
    ]
    console.table(("", "", "ports", ""), rows)


def _relevance(choice: PredefinedData) -> tuple[bool, int]:
    """The key for sorting: robots with many ports of the model come first, robots with none of them last."""
    return bool(choice["robot"]) and not choice["matches"], -choice["matches"] if choice["robot"] else 0


def _matches(choice: PredefinedData) -> str:
    """The number of ports with a component of matching name; "topics" for a target alone, where ports become topics."""
    return f"{choice['matches']}/{choice['ports']}" if choice["robot"] else "topics"


def _description(choice: PredefinedData) -> str:
    needed = f"; needs {', '.join(choice['missing'])}" if choice["missing"] else ""
    return f"{choice['board']}{needed}"


def _text(choice: PredefinedData) -> str:
    """The text that a filter searches."""
    return " ".join(str(choice[key]) for key in ("name", "summary", "robot", "board", "platform")).casefold()
