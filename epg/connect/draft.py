# SPDX-License-Identifier: Apache-2.0
"""The user's changes that are not saved yet: a list of operations on the files, with undo and redo.

>>> # draft = Draft(read_snapshot(bindings), read_snapshot(tcf), "version: 1\\nmodel: JIWY\\n")
>>> # draft.do((SetEnds("pwm_pan", (End("motor"),)),), model); draft.undo(); draft.diff()
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from epg.connect.files import Snapshot
from epg.edit.bindings import CannotEdit, End, set_ends
from epg.edit.tcf import set_extends
from epg.models.model import Model


@dataclass(frozen=True)
class SetEnds:
    """Binds a port to ``ends``.

    None removes the port from the bindings.  An empty tuple leaves an output unconnected on purpose.
    """

    port: str
    ends: tuple[End, ...] | None


@dataclass(frozen=True)
class SetExtends:
    """Makes the ``.tcf`` extend the file ``name``."""

    name: str


Operation = tuple["SetEnds | SetExtends", ...]
"""All changes of one user action; undo and redo treat them as one."""


@dataclass(frozen=True)
class Texts:
    """The texts of the two files that can be edited; None for a file without readable text."""

    bindings: str | None
    tcf: str | None


@dataclass(frozen=True)
class _Done:
    operation: Operation
    before: Texts


class Draft:
    """The operations, and the texts of the two files after them.

    ``fresh`` is the first text of the bindings if that file does not exist yet.
    """

    def __init__(self, bindings: Snapshot, tcf: Snapshot, fresh: str) -> None:
        self.bindings, self.tcf, self._fresh = bindings, tcf, fresh
        self.texts = self._on_disk()
        self._done: list[_Done] = []
        self._undone: list[tuple[Operation, Texts]] = []
        self._saved = 0  # the number of operations that the files on the disk contain
        self._diverged = False  # True after some of the saved operations were undone and others done in their place

    @property
    def changed(self) -> bool:
        return self._pairs() != []

    @property
    def can_undo(self) -> bool:
        return bool(self._done)

    @property
    def can_redo(self) -> bool:
        return bool(self._undone)

    def drafts(self) -> dict[Path, str]:
        """The texts that must be read instead of the files, by path."""
        texts = ((self.bindings.path, self.texts.bindings), (self.tcf.path, self.texts.tcf))
        return {path: text for path, text in texts if text is not None}

    def do(self, operation: Operation, model: Model | None) -> None:
        """Applies ``operation``.  Raises CannotEdit; the texts are then unchanged."""
        after = self._applied(self.texts, operation, model)
        if after == self.texts:
            return
        self._diverged |= len(self._done) < self._saved
        self._done.append(_Done(operation, self.texts))
        self._undone.clear()
        self.texts = after

    def undo(self) -> None:
        last = self._done.pop()
        self._undone.append((last.operation, self.texts))
        self.texts = last.before

    def redo(self) -> None:
        operation, after = self._undone.pop()
        self._done.append(_Done(operation, self.texts))
        self.texts = after

    def unsaved(self) -> list[Snapshot]:
        """The new contents of the files that differ from the disk."""
        return [after for _, after in self._pairs()]

    def saved(self, after: Snapshot) -> None:
        """Notes that one of the files was saved as ``after``."""
        if after.path == self.bindings.path:
            self.bindings = after
        else:
            self.tcf = after
        if not self.changed:
            self._saved, self._diverged = len(self._done), False

    def rebase(self, bindings: Snapshot, tcf: Snapshot, model: Model | None) -> int:
        """Takes new contents of the files, and applies the unsaved operations to them.  Returns their number.

        Raises CannotEdit if an operation does not fit the new text any more; the draft is then unchanged.
        """
        if self.changed and (self._diverged or len(self._done) < self._saved):
            raise CannotEdit("a change that was saved and then undone cannot be removed from the new text")
        operations = [done.operation for done in self._done[self._saved :]]
        other = Draft(bindings, tcf, self._fresh)
        for operation in operations:
            other.do(operation, model)
        self.bindings, self.tcf, self.texts = bindings, tcf, other.texts
        self._done, self._undone, self._saved, self._diverged = other._done, [], 0, False
        return len(operations)

    def before_saving(self, path: Path) -> Snapshot:
        """The file at ``path`` as it was last read or saved."""
        return self.bindings if path == self.bindings.path else self.tcf

    def diff(self) -> str:
        """The changes that saving would make, as a unified diff."""
        lines: list[str] = []
        for before, after in self._pairs():
            old, new = before.text or "", after.text or ""
            name = before.path.name
            lines += difflib.unified_diff(
                _lines(old), _lines(new), name if before.data is not None else "(no file)", name, lineterm=""
            )
        return "".join(f"{line}\n" for line in lines)

    def _on_disk(self) -> Texts:
        text = self._fresh if self.bindings.data is None else self.bindings.text
        return Texts(text, self.tcf.text)

    def _pairs(self) -> list[tuple[Snapshot, Snapshot]]:
        pairs = []
        for before, text in ((self.bindings, self.texts.bindings), (self.tcf, self.texts.tcf)):
            if text is not None and text != before.text:
                pairs.append((before, before.with_text(text)))
        return pairs

    def _applied(self, texts: Texts, operation: Iterable[SetEnds | SetExtends], model: Model | None) -> Texts:
        for change in operation:
            if isinstance(change, SetExtends):
                if texts.tcf is None:
                    raise CannotEdit(f"'{self.tcf.path.name}' cannot be read")
                texts = replace(texts, tcf=set_extends(texts.tcf, self.tcf.path.name, change.name))
            elif texts.bindings is None or model is None:
                what = "the bindings" if texts.bindings is None else "the model"
                raise CannotEdit(f"{what} must be correct before ports can be connected: see the messages")
            else:
                text = set_ends(texts.bindings, self.bindings.path.name, model, change.port, change.ends)
                texts = replace(texts, bindings=text)
        return texts


def _lines(text: str) -> list[str]:
    return text.replace("\r\n", "\n").replace("\r", "\n").splitlines()
