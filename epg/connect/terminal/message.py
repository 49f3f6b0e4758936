# SPDX-License-Identifier: Apache-2.0
"""Prints messages in the terminal as the command line does, with the line at their position."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from epg.connect.session import Refused, Session
from epg.connect.terminal.console import Console

Excerpt = Callable[[Mapping[str, Any]], list[str]]


def say_message(message: Mapping[str, Any], session: Session, console: Console) -> None:
    """Prints a message of the session's state or of its build."""
    project = session.state()["project"]
    folder = str(project["folder"]) if project is not None else ""
    for line in message_lines(message, folder, lambda place: _excerpt(place, session)):
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
        found = session.source(place["file"], place["line"])
    except Refused:
        return []
    text = str(found["lines"][place["line"] - found["first"]]) if found["line"] == place["line"] else ""
    before = "".join("\t" if char == "\t" else " " for char in text[: place["column"] - 1])
    return [f"{place['line']:5d} | {text}", f"{'':5} | {before}^"] if text.isprintable() else []


def message_lines(message: Mapping[str, Any], folder: str, excerpts: Excerpt) -> list[str]:
    """The lines of a message as the command line prints it.  Paths below ``folder`` are relative to it."""
    place = _place(message, folder)
    id = f" [{message['id']}]" if message.get("id") else ""
    first, *rest = f"{message['message']}".split("\n")
    lines = [
        f"{place}{': ' if place else ''}{message['severity']}: {first}{id}",
        *(f"  {line}".rstrip() for line in rest),
    ]
    lines += excerpts(message)
    for note in message.get("notes", ()):
        lines.append(f"{_place(note, folder)}: note: {note['message']}")
        lines += excerpts(note)
    if message["hint"]:
        lines.append(f"hint: {message['hint']}")
    return lines


def _place(message: Mapping[str, Any], folder: str) -> str:
    file = str(message["file"])
    if folder and Path(file).is_absolute() and Path(file).is_relative_to(folder):
        file = str(Path(file).relative_to(folder))
    if not message["line"]:
        return file
    return f"{file}:{message['line']}:{message['column']}" if message["column"] else f"{file}:{message['line']}"
