# SPDX-License-Identifier: Apache-2.0
"""Diagnostics: mistakes in a user's files, each with a position, an id and a hint, as compilers report them.

>>> problems = Diagnostics()
>>> problems.error("unknown-key", Span("a.tcf", 2, 1, 4), "unknown key 'nod'", hint=did_you_mean("nod", ["node"]))
>>> problems.has_errors
True
>>> problems.items[0].hint, problems.items[0].edit("nod: robot").new
("did you mean 'node'?", 'node')
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import field, replace
from typing import Any, TypeVar

from epg.generator.correction import Correction, correction
from epg.generator.dataclass import dataclass
from epg.generator.source import Span

Result = TypeVar("Result")

LINE_BREAK = re.compile("\r\n|[\r\n\x85\u2028\u2029]")
"""The end of a line, as YAML knows it."""
_MARK = re.compile(r"\d|(?<![^\W_])[a-z](?![^\W_])")
_NEAR, _MOST_NEAR = 0.6, 3
"""The ratio of common letters from which names are similar, and the largest number of names that are compared."""


@dataclass(frozen=True)
class Note:
    """A second position that belongs to a diagnostic: the other user of a pin, or the file that extends this one."""

    message: str
    span: Span


@dataclass(frozen=True)
class Edit:
    """A change that a diagnostic proposes: ``new`` in place of ``old``, the text at ``span``.

    It corrects the mistake as the user most probably meant it.  Both texts can have several lines: ``span`` is the part
    of ``old`` on its first line.  An insertion has an empty ``old``, and ``line`` is its line as it was before.
    ``sentence`` says in a hint what the change is.
    """

    span: Span
    old: str
    new: str
    sentence: str = ""
    line: str = ""

    def data(self) -> dict[str, Any]:
        """The edit as data for programs.  ``argument`` is the corrected argument, if it is not an edit of a file."""
        data = {
            **_position(self.span),
            "end_line": self.end[0],
            "end": self.end[1],
            "old": self.old,
            "new": self.new,
            "sentence": self.sentence,
        }
        return data if self.span.text is None else {**data, "argument": self.within(self.span.text)}

    @property
    def end(self) -> tuple[int, int]:
        """Line and column behind the old text."""
        lines = LINE_BREAK.split(self.old)
        first = self.span.column if len(lines) == 1 else 1
        return self.span.line + len(lines) - 1, first + len(lines[-1])

    def within(self, text: str, start: int = 0) -> str:
        """``text`` after the change, in a line that begins at ``start``."""
        start += self.span.column - 1
        return text[:start] + self.new + text[start + len(self.old) :]

    def fits(self, text: str, start: int = 0) -> bool:
        """True if the old text is at its position in a line that begins at ``start``.

        The line of an insertion must not have changed.
        """
        column = start + self.span.column - 1
        line = LINE_BREAK.split(text[start:], maxsplit=1)[0]
        return text.startswith(self.old, column) and (bool(self.old) or line == self.line)


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

    def edit(self, line: str, hint: str | None = None) -> Edit | None:
        """The edit by which ``hint`` corrects ``line``, the text of the line at the position of the diagnostic.

        ``hint`` is the whole hint, or one of those that it lists.  None if it corrects nothing there, or if the text to
        replace is not a word at the position, or there twice.
        """
        hint, span = self.hint if hint is None else hint, self.span
        if not isinstance(hint, Correction) or self.about or not span.column:
            return None
        line = line if span.text is None else span.text
        text = line[span.column - 1 : span.end - 1]
        quote = text[:1] if text[:1] in ("'", '"') else ""
        old = f"{quote}{hint.old}{quote}" if hint.bare else hint.old
        places = [match.start() for match in re.finditer(rf"(?<!\w){re.escape(old)}(?!\w)", text)]
        if len(places) != 1 or (quote == '"' and "\\" in hint.new):
            return None
        first = span.column + places[0]
        return Edit(replace(span, column=first, end=first + len(old)), old, hint.new, str(hint))

    def data(self) -> dict[str, Any]:
        """The diagnostic as data for programs, without its edit, which needs the text of the file."""
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

    def known_or_error(
        self, id: str, span: Span, message: str, name: object, known: Iterable[str], otherwise: str = ""
    ) -> bool:
        """True if ``name`` is one of ``known``; else False after adding an error, which proposes the nearest one."""
        names = list(known)
        if name in names:
            return True
        self.error(id, span, message, hint=did_you_mean(str(name), names, otherwise))
        return False

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


def nearest(word: str, choices: Iterable[str], cutoff: float = _NEAR) -> tuple[str, ...]:
    """The choices that are nearest to ``word`` by their letters: one, several that are equally near, or none.

    Their similarity is at least ``cutoff``, from 0 to 1.  A common ending does not make names of files similar:
    ``g.tcf`` and ``jiwy.tcf``.
    """
    import difflib

    folded = {choice.casefold(): choice for choice in choices}
    wanted = word.casefold()
    ending = wanted[wanted.rfind(".") :] if wanted.rfind(".") > 0 else ""
    changes: dict[str, int] = {}
    for name in difflib.get_close_matches(wanted, folded, n=_MOST_NEAR, cutoff=cutoff):
        common = ending if ending and name.endswith(ending) else ""
        pair = name.removesuffix(common), wanted.removesuffix(common)
        if difflib.SequenceMatcher(None, *pair).ratio() >= cutoff:
            changes[name] = _changes(*pair)
    fewest = min(changes.values(), default=0)
    return tuple(folded[name] for name, count in changes.items() if count == fewest)


def _changes(one: str, other: str) -> int:
    """The smallest number of mistakes that make one name of the other: a letter more, less or wrong, or two swapped.

    This is the "optimal string alignment", a distance of Damerau and Levenshtein.
    """
    rows = [list(range(len(other) + 1))]
    for i, letter in enumerate(one, 1):
        row = [i]
        for j, each in enumerate(other, 1):
            row.append(min(rows[-1][j] + 1, row[-1] + 1, rows[-1][j - 1] + (letter != each)))
            if i > 1 and j > 1 and letter == other[j - 2] and one[i - 2] == each:
                row[-1] = min(row[-1], rows[-2][j - 2] + 1)
        rows.append(row)
    return rows[-1][-1]


_LETTERS = 4
"""The number of letters among which one can be wrong."""


def underscored(name: str, others: str = "") -> str:
    """``name`` with ``_`` in place of blanks, hyphens and dots: ``set x`` gives ``set_x``.

    A name with more than these, and the characters ``others``, stays as it is.
    """
    if not re.fullmatch(rf"[A-Za-z0-9_ .{re.escape(others)}-]+", name):
        return name
    near = re.sub(r"[_ .-]+", "_", name.strip())
    return near if name.endswith("_") else near.rstrip("_")


def question(near: Iterable[str], word: str = "") -> str:
    """The hint that asks for one of the names ``near``.

    It proposes a single one in place of ``word``, unless ``word`` is the name of something else.
    """
    meant = tuple(near)
    if len(meant) == 1 and _is_spelling(word, meant[0]):
        return correction(word, meant[0])
    names = "' or '".join(meant)
    return f"did you mean '{names}'?"


def _is_spelling(word: str, choice: str) -> bool:
    """True if ``word`` is probably ``choice`` in a wrong spelling, and not the name of something else.

    Numbers and single letters are parts of names: ``motor_1`` is not a misspelt ``motor_2``, nor ``pwm_x`` ``pwm_y``.
    A wrong spelling has few wrong letters, or leaves the ends of words out: ``freq`` is ``frequency``, but
    ``motor_left`` is not ``motor_right``.
    """
    one, other = word.casefold(), choice.casefold()
    parts = [re.split(r"[_.]", text) for text in (one, other)]
    shortened = len(parts[0]) == len(parts[1]) and all(a.startswith(b) or b.startswith(a) for a, b in zip(*parts))
    if not shortened and _changes(one, other) > max(1, len(word) // _LETTERS):
        return False
    marks = [sorted(_MARK.findall(text.casefold())) for text in (word, choice)]
    has_letters = bool(word) and not word.isdigit()
    return has_letters and marks[0] == marks[1] and re.fullmatch(r"[\w./\\+-]+", choice) is not None


def did_you_mean(word: str, choices: Iterable[str], otherwise: str = "") -> str:
    """A hint that names the choice nearest to ``word``, or those that are equally near.

    It proposes the only one.  If no choice is near, the hint is ``otherwise`` and a list of the choices, at most 24.
    Empty without choices.
    """
    known = sorted(choices)
    near = nearest(word, known)
    if near:
        return question(near, word)
    if not known:
        return ""
    if len(word) >= 3:
        known = [choice for choice in known if word.casefold() in choice.casefold()] or known
    listed = ", ".join(known) if len(known) <= 24 else ", ".join(known[:24]) + ", ..."
    return f"{otherwise or 'possible'}: {listed}"
