# SPDX-License-Identifier: Apache-2.0
"""A dialog about one target: its state, the user's actions, and the messages after them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from operator import itemgetter
from typing import Any

from epg.connect.json_data import State
from epg.connect.session import Refused, Session
from epg.connect.terminal.console import Console
from epg.connect.terminal.create import Left
from epg.connect.terminal.message import say_message, say_refused
from epg.connect.terminal.text import ModelPort

_key = itemgetter("id", "file", "message")
OF_OPEN_PORTS = frozenset(
    ("unbound-input", "unbound-output", "needs-bound", "unused-component", "unused-input", "motor-not-driven")
)
"""Ids of messages that are not shown while the user still connects ports."""


class Talk:
    """The dialog.  ``state`` is the session's state after the last action or look."""

    def __init__(self, session: Session, console: Console) -> None:
        self.session, self.console = session, console
        self.state: State = session.state()
        self._told = ""  # the last note about an edit by another program

    def act(self, action: str, body: dict[str, Any], port: ModelPort | None = None) -> bool:
        """Does ``action``, and prints the new messages, and those about ``port``.  Returns False if it was refused."""
        self.look()
        before = {_key(problem) for problem in self.state["diagnostics"]}
        try:
            self.state = self.session.act(action, body)
        except Refused as problem:
            say_refused(problem, self.console)
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
        """Updates the state, and prints a note if another program has edited a file."""
        self.state = self.session.wait(self.state["version"], 0)
        external = self.state["draft"]["external"] or ""
        if external and external != self._told:
            self.console.fill(f"note: {external}")
        self._told = external

    def say_messages(self, problems: Iterable[State]) -> None:
        for problem in problems:
            say_message(problem, self.session, self.console)

    def named(self, word: str, names: Sequence[str], what: str) -> str | None:
        """The name in ``names`` that is equal to ``word``, begins with it, or has it as its number, counted from 1.

        Returns None after a message if there is no such name or there are several.  ``what`` is the noun for names.
        """
        fitting = [name for name in names if name == word] or [name for name in names if name.startswith(word)]
        if not fitting and word.isdecimal() and 0 < int(word) <= len(names):
            return names[int(word) - 1]
        if len(fitting) == 1:
            return fitting[0]
        self.console.fill(f"which one: {', '.join(fitting)}?" if fitting else f"there is no {what} '{word}'")
        return None

    def leave(self) -> None:
        """Raises Left.  If there are unsaved changes, asks first, and returns if the user wants to stay."""
        if not self.state["draft"]["changed"]:
            raise Left
        if not self.console.agree("there are unsaved changes: quit without saving?", "n"):
            return
        raise Left
