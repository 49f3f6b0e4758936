# SPDX-License-Identifier: Apache-2.0
"""A dialog about one target: its state, what is done to it, and what is said of that."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from epg.connect.session import Refused, Session, State
from epg.connect.terminal.console import Console
from epg.connect.terminal.create import Left
from epg.connect.terminal.message import say_message
from epg.connect.terminal.text import Port

OF_OPEN_PORTS = frozenset(("unbound-input", "unbound-output", "needs-bound", "unused-component"))
"""Messages that are there while ports are still to be asked for."""


class Talk:
    """``state`` is the session's, as of the last answer."""

    def __init__(self, session: Session, console: Console) -> None:
        self.session, self.console = session, console
        self.state: State = session.state()
        self._told = ""  # what was edited outside, as it was said last

    def act(self, action: str, body: dict[str, Any], port: Port | None = None) -> bool:
        """Does something, and says what comes of it; whether it was done."""
        self.look()
        before = {_key(problem) for problem in self.state["diagnostics"]}
        try:
            self.state = self.session.act(action, body)
        except Refused as problem:
            self.say_refused(problem)
            self.state = self.session.state()
            return False
        self.say_messages(
            problem
            for problem in self.state["diagnostics"]
            if (_key(problem) not in before or (port is not None and problem["port"] == port.name))
            and problem["id"] not in OF_OPEN_PORTS
        )
        return True

    def look(self) -> None:
        """Says what was edited outside meanwhile."""
        self.state = self.session.wait(self.state["version"], 0)
        external = self.state["draft"]["external"] or ""
        if external and external != self._told:
            self.console.fill(f"note: {external}")
        self._told = external

    def say_messages(self, problems: Iterable[State]) -> None:
        for problem in problems:
            say_message(problem, self.session, self.console)

    def say_refused(self, problem: Refused) -> None:
        self.console.fill(f"error: {problem.message}")
        if problem.hint:
            self.console.fill(f"hint: {problem.hint}")

    def named(self, word: str, names: Sequence[str], what: str) -> str | None:
        """The one of ``names`` that is called or begins with ``word``, or has it as its number."""
        fitting = [name for name in names if name == word] or [name for name in names if name.startswith(word)]
        if not fitting and word.isdecimal() and 0 < int(word) <= len(names):
            return names[int(word) - 1]
        if len(fitting) == 1:
            return fitting[0]
        self.console.fill(f"which one: {', '.join(fitting)}?" if fitting else f"there is no {what} '{word}'")
        return None

    def leave(self) -> None:
        """Asks where something would be lost; raises Left."""
        if not self.state["draft"]["changed"]:
            raise Left
        if not self.console.agree("there are changes that are not saved: leave without them?", "n"):
            return
        raise Left


def _key(problem: State) -> tuple[object, ...]:
    return problem["id"], problem["file"], problem["message"]
