# SPDX-License-Identifier: Apache-2.0
"""The page ``docs/errors.md`` as data: the meaning of each kind of message.

>>> entry = find_entry("unknown-key")
>>> entry.anchor, entry.summary
('unknown-key', 'The format has no such key.')
>>> find_entry("timer-used-twice").id
'PERIPHERAL-used-twice'
"""

from __future__ import annotations

import re
from functools import cache

from epg.generator.data import data_folder
from epg.generator.dataclass import dataclass

PAGE = "errors.md"
_HEADING = re.compile(r"^### (\S+)\n", re.MULTILINE)


@dataclass(frozen=True)
class Entry:
    """One entry of the page.

    A word in capital letters in ``id`` matches any name, because the ids of some messages contain the name of a
    peripheral.
    """

    id: str
    text: str  # Markdown: meaning, reason, remedy

    @property
    def summary(self) -> str:
        """The first sentence of the text."""
        return re.split(r"(?<=\.) ", self.text, maxsplit=1)[0]

    @property
    def anchor(self) -> str:
        """The anchor of the heading, in the form that GitHub and most renderers of Markdown use."""
        return re.sub(r"[^\w-]", "", self.id).lower()

    def covers(self, id: str) -> bool:
        """True if the entry is about messages with this id."""
        pattern = "".join("[a-z0-9_]+" if part.isupper() else re.escape(part) for part in re.split("([A-Z]+)", self.id))
        return re.fullmatch(pattern, id) is not None


@cache
def read_page() -> tuple[Entry, ...]:
    """All entries, in the order of the page."""
    text = (data_folder("docs") / PAGE).read_text(encoding="utf-8")
    parts = _HEADING.split(text)
    return tuple(_entry(id, body) for id, body in zip(parts[1::2], parts[2::2]))


def find_entry(id: str) -> Entry | None:
    """The entry for the kind of message ``id``: the one with this id, else the one whose pattern matches, or None."""
    fitting = [entry for entry in read_page() if entry.covers(id)]
    return next((entry for entry in fitting if entry.id == id), fitting[0] if fitting else None)


def _entry(id: str, body: str) -> Entry:
    return Entry(id, " ".join(body.partition("\n## ")[0].split()))
