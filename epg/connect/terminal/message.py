# SPDX-License-Identifier: Apache-2.0
"""Prints messages in the terminal as the command line does, with the line at their position."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from epg.connect.session import Refused, Session
from epg.connect.terminal.console import Console


def say_message(message: Mapping[str, Any], session: Session, console: Console) -> None:
    """Prints a message of the session's state or of its build.  Paths in the project are relative to its folder."""
    project = session.state()["project"]
    folder = str(project["folder"]) if project is not None else ""
    id = f" [{message['id']}]" if message.get("id") else ""
    place = _place(message, folder)
    first, *rest = str(message["message"]).split("\n")
    lines = [f"{place}{': ' if place else ''}{message['severity']}: {first}{id}"]
    lines += [f"  {line}".rstrip() for line in rest]
    lines += _excerpt(message, session)
    for note in message.get("notes", ()):
        lines += [f"{_place(note, folder)}: note: {note['message']}", *_excerpt(note, session)]
    if message["hint"]:
        lines.append(f"hint: {message['hint']}")
    for line in lines:
        console.say(line)


def say_refused(problem: Refused, console: Console) -> None:
    console.fill(f"error: {problem.message}")
    if problem.hint:
        console.fill(f"hint: {problem.hint}")


def _excerpt(place: Mapping[str, Any], session: Session) -> list[str]:
    """The line at a position, from the draft if there is one, and a caret below it.  Empty if it cannot be read."""
    if not place["line"] or not place["column"]:
        return []
    try:
        excerpt = session.source(place["file"], place["line"])
    except Refused:
        return []
    text = str(excerpt["lines"][place["line"] - excerpt["first"]]) if excerpt["line"] == place["line"] else ""
    before = "".join("\t" if char == "\t" else " " for char in text[: place["column"] - 1])
    return [f"{place['line']:5d} | {text}", f"{'':5} | {before}^"] if text.isprintable() else []


def _place(message: Mapping[str, Any], folder: str) -> str:
    file = str(message["file"])
    if folder and Path(file).is_absolute() and Path(file).is_relative_to(folder):
        file = str(Path(file).relative_to(folder))
    if not message["line"]:
        return file
    return f"{file}:{message['line']}:{message['column']}" if message["column"] else f"{file}:{message['line']}"
