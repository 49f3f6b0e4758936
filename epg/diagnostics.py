# SPDX-License-Identifier: Apache-2.0
"""Diagnostics: mistakes in a user's files, each with a position, an id and a hint, as compilers report them.

>>> problems = Diagnostics()
>>> problems.error("unknown-key", Span("a.tcf", 2, 1, 5), "unknown key 'nod'", hint="did you mean 'node'?")
>>> problems.has_errors
True
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import field
from typing import Any, TypeVar

from epg.dataclass import dataclass
from epg.source import Span

Result = TypeVar("Result")


@dataclass(frozen=True)
class Note:
    """A second position that belongs to a diagnostic: the other user of a pin, or the file that extends this one."""

    message: str
    span: Span


@dataclass(frozen=True)
class Diagnostic:
    """One error, warning or note.  ``id`` must not change: documentation, tests and programs refer to it.

    ``about`` names the subject if the position cannot show it: ``inputs.position_pan`` for a port that no line binds.
    """

    id: str
    severity: str  # "error", "warning" or "note".  A note is information: the user need not change anything.
    span: Span
    message: str
    hint: str = ""
    notes: tuple[Note, ...] = ()
    about: str = ""

    def data(self) -> dict[str, Any]:
        """The diagnostic as data for programs."""
        return {
            "id": self.id,
            "severity": self.severity,
            **_position(self.span),
            "message": self.message,
            "hint": self.hint,
            "notes": [{"message": note.message, **_position(note.span)} for note in self.notes],
        }


def _position(span: Span) -> dict[str, Any]:
    return {"file": span.file, "line": span.line, "column": span.column}


@dataclass
class Diagnostics:
    """Collects the diagnostics of one run, so that the user sees all of them at once.  Each is kept once."""

    items: list[Diagnostic] = field(default_factory=list)
    _known: set[Diagnostic] = field(default_factory=set, repr=False, compare=False)
    _counted: int = field(default=0, repr=False, compare=False)
    _errors: int = field(default=0, repr=False, compare=False)

    def error(
        self, id: str, span: Span, message: str, *, hint: str = "", notes: Iterable[Note] = (), about: str = ""
    ) -> None:
        """Adds an error: a mistake that the user must correct."""
        self._add(Diagnostic(id, "error", span, message, hint, tuple(notes), about))

    def warning(
        self, id: str, span: Span, message: str, *, hint: str = "", notes: Iterable[Note] = (), about: str = ""
    ) -> None:
        """Adds a warning: EPG goes on, but the user should change something."""
        self._add(Diagnostic(id, "warning", span, message, hint, tuple(notes), about))

    def note(self, id: str, span: Span, message: str, *, hint: str = "") -> None:
        """Adds a note: information about something that is right."""
        self._add(Diagnostic(id, "note", span, message, hint))

    def add_all(self, others: Iterable[Diagnostic]) -> None:
        """Adds diagnostics that another collection holds, except those that this one has already."""
        for diagnostic in others:
            self._add(diagnostic)

    @property
    def wants_hints(self) -> bool:
        """True while there are fewer than 50 diagnostics.  To find the nearest of many names takes time for each."""
        return len(self.items) < 50

    def _add(self, diagnostic: Diagnostic) -> None:
        if diagnostic not in self._known:
            self._known.add(diagnostic)
            self.items.append(diagnostic)

    @property
    def error_count(self) -> int:
        """The number of errors.  A check that returns None after errors compares it before and after."""
        for item in self.items[self._counted :]:  # Count new items only: every check reads this property.
            self._errors += item.severity == "error"
        self._counted = len(self.items)
        return self._errors

    @property
    def has_errors(self) -> bool:
        return self.error_count > 0

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self.items)

    def stop_if_errors(self) -> None:
        """Raises :class:`UserError` if there is an error.  Callers do this between two layers."""
        if self.has_errors:
            raise UserError(self)

    def checked(self, result: Result | None) -> Result:
        """``result``, which is None only after an error.  Raises :class:`UserError` if there is an error."""
        self.stop_if_errors()
        assert result is not None
        return result


class UserError(Exception):
    """A user's files have mistakes; ``diagnostics`` holds all of them.  Any other exception is a bug in EPG."""

    def __init__(self, diagnostics: Diagnostics) -> None:
        super().__init__(f"{len(diagnostics.items)} problem(s)")
        self.diagnostics = diagnostics


def did_you_mean(word: str, choices: Iterable[str], otherwise: str = "") -> str:
    """A hint that names the choice nearest to ``word``.

    If no choice is near, the hint is ``otherwise`` and a list of the choices, at most 24.  Empty without choices.
    """
    import difflib

    known = sorted(choices)
    folded = {choice.casefold(): choice for choice in known}
    near = difflib.get_close_matches(word.casefold(), folded, n=1, cutoff=0.6)
    if near:
        return f"did you mean '{folded[near[0]]}'?"
    if not known:
        return ""
    if len(word) >= 3:
        known = [choice for choice in known if word.casefold() in choice.casefold()] or known
    listed = ", ".join(known) if len(known) <= 24 else ", ".join(known[:24]) + ", ..."
    return f"{otherwise or 'possible'}: {listed}"
