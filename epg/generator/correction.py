# SPDX-License-Identifier: Apache-2.0
"""Hints that propose a change: one text in place of another, or a value for a key of a file.

>>> hint = correction("perid", "period")
>>> hint, hint.new
("did you mean 'period'?", 'period')

A hint proposes a change only if one meaning is likely: a program, or a button, can then make it.  If there are two, the
hint lists both, and is an ordinary ``str``; if the user should choose one of them by a button, it is a :class:`Choice`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Union

_LONGEST = 60


class Correction(str):
    """The sentence of a hint that proposes ``new`` in place of ``old``.

    ``old`` is a word or more at the position of the diagnostic.  ``bare`` is for a number or a boolean: quotes around
    ``old`` must go, too.
    """

    old: str
    new: str
    bare: bool

    def __new__(cls, sentence: str, old: str, new: str, *, bare: bool = False) -> Correction:
        self = super().__new__(cls, sentence)
        self.old, self.new, self.bare = old, new, bare
        return self


class KeyValue(str):
    """The sentence of a hint that proposes ``value`` for the key at ``path`` of ``file``, a YAML file of the user.

    ``value`` is as JSON has it; None deletes what an extended file has set.  If the key is a port in bindings,
    ``order`` are the names of all ports of its section.
    """

    file: str
    path: tuple[str, ...]
    value: object
    order: tuple[str, ...]

    def __new__(
        cls, sentence: str, file: str, path: tuple[str, ...], value: object, order: Sequence[str] = ()
    ) -> KeyValue:
        self = super().__new__(cls, sentence)
        self.file, self.path, self.value, self.order = file, path, value, tuple(order)
        return self


Proposal = Union[Correction, KeyValue]


class Choice(str):
    """The sentence of a hint that names several changes, each with a sentence of its own.  The user chooses one."""

    proposals: tuple[Proposal, ...]

    def __new__(cls, sentence: str, *proposals: Proposal) -> Choice:
        self = super().__new__(cls, sentence)
        self.proposals = proposals
        return self


def proposals_of(hint: str) -> tuple[Proposal, ...]:
    """The changes that a hint proposes: none, one, or several of which one must be chosen."""
    if isinstance(hint, Choice):
        return hint.proposals
    return (hint,) if isinstance(hint, (Correction, KeyValue)) else ()


def correction(old: str, new: str, sentence: str = "did you mean '{}'?", *, bare: bool = False) -> Correction:
    """A hint that proposes ``new`` in place of ``old``; the first ``{}`` of ``sentence`` is where it names ``new``."""
    return Correction(sentence.replace("{}", short(new), 1), old, new, bare=bare)


def and_then(hint: str, text: str) -> str:
    """``hint``, which keeps its proposal, with more text behind it."""
    if not isinstance(hint, Correction):
        return hint + text
    return Correction(hint + text, hint.old, hint.new, bare=hint.bare)


def short(text: str) -> str:
    """``text`` without white space around it, shortened for a message."""
    text = text.strip()
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
