# SPDX-License-Identifier: Apache-2.0
"""The user's changes that are not saved yet: a list of operations on the files, with undo and redo.

The list has operations, and not only the new texts.  If another program writes a file meanwhile, the operations are
applied to its new text (:meth:`Draft.rebased`), and the user loses neither change.  A new text alone would overwrite
the other program's.  An operation that no longer fits raises CannotEdit, and the user chooses.

>>> # draft = Draft(read_snapshot(bindings), read_snapshot(tcf), "version: 1\\nmodel: JIWY\\n")
>>> # draft.do((SetEnds("pwm_pan", (WireEnd("motor"),)),), model); draft.undo(); draft.diff()
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import field, replace
from pathlib import Path

from epg.connect.files import Snapshot
from epg.edit.applied import apply_edit
from epg.edit.bindings import CannotEdit, WireEnd, set_ends
from epg.edit.tcf import JsonValue, remove_value, rename_key, set_value
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Edit
from epg.generator.models.model import Model


@dataclass(frozen=True)
class SetEnds:
    """Binds a port to ``ends``.

    None removes the port from the bindings.  An empty tuple leaves an output unconnected on purpose.
    """

    port: str
    ends: tuple[WireEnd, ...] | None


@dataclass(frozen=True)
class SetValue:
    """Gives the key at ``path`` of the ``.tcf`` a value.  None removes what an extended file has at this key."""

    path: tuple[str, ...]
    value: JsonValue


@dataclass(frozen=True)
class RemoveValue:
    """Removes the key at ``path`` from the ``.tcf``: the value of the extended file, or the default, holds again."""

    path: tuple[str, ...]


@dataclass(frozen=True)
class RenameKey:
    """Gives the key at ``path`` of the ``.tcf`` another name; its value stays."""

    path: tuple[str, ...]
    name: str


@dataclass(frozen=True)
class SetParameter:
    """Gives the key at ``path`` of the bindings a value: below ``parameters``.  None removes it."""

    path: tuple[str, ...]
    value: float | None


@dataclass(frozen=True)
class SetFile:
    """Writes another file of the project, or removes it if ``after`` is None.

    ``before`` is its contents as they were read, None for a new file.
    """

    path: Path
    before: bytes | None
    after: bytes | None


@dataclass(frozen=True)
class ApplyEdit:
    """Makes the edit of a message in the file at ``path``: the bindings or the ``.tcf``."""

    path: Path
    edit: Edit


Change = SetEnds | SetValue | RemoveValue | RenameKey | SetParameter | SetFile | ApplyEdit
Operation = tuple[Change, ...]
"""All changes of one user action; undo and redo treat them as one."""


@dataclass(frozen=True)
class Texts:
    """The texts of the two files that can be edited; None for a file without readable text.

    ``files`` are the new contents of other files of the project, None for those that are removed.
    """

    bindings: str | None
    tcf: str | None
    files: Mapping[Path, bytes | None] = field(default_factory=dict)


class Draft:
    """The operations, and the texts of the two files after each of them.

    ``fresh`` is the first text of the bindings if that file does not exist yet.
    """

    def __init__(self, bindings: Snapshot, tcf: Snapshot, fresh: str) -> None:
        self.bindings, self.tcf, self._fresh = bindings, tcf, fresh
        self._texts = [Texts(fresh if bindings.data is None else bindings.text, tcf.text)]  # one more than operations
        self._files: dict[Path, tuple[bytes | None, bytes | None]] = {}  # at first, and on the disk now
        self._operations: list[Operation] = []
        self._count = 0  # the number of operations that are done; undo has taken back the later ones
        self._saved = 0  # the number of operations that the files on the disk contain
        self._diverged = False  # True after some of the saved operations were undone and others done in their place

    @property
    def texts(self) -> Texts:
        return self._texts[self._count]

    @property
    def changed(self) -> bool:
        return self.unsaved() != []

    @property
    def can_undo(self) -> bool:
        return self._count > 0

    @property
    def can_redo(self) -> bool:
        return self._count < len(self._operations)

    def drafts(self, operation: Operation = (), model: Model | None = None) -> dict[Path, str]:
        """The texts that must be read instead of the files, by path; as they would be after one more ``operation``.

        Raises CannotEdit if that operation is not possible.
        """
        after = self._applied(self.texts, operation, model)
        texts = ((self.bindings.path, after.bindings), (self.tcf.path, after.tcf))
        return {path: text for path, text in texts if text is not None}

    @property
    def files(self) -> dict[Path, bytes | None]:
        """The contents of the project's other files that an operation has changed, undone operations among them."""
        return {path: self.texts.files.get(path, first) for path, (first, _) in self._files.items()}

    def do(self, operation: Operation, model: Model | None) -> None:
        """Applies ``operation``.  Raises CannotEdit; the texts are then unchanged."""
        after = self._applied(self.texts, operation, model)
        if after == self.texts:
            return
        self._diverged |= self._count < self._saved
        self._operations[self._count :] = [operation]
        self._count += 1
        self._texts[self._count :] = [after]

    def undo(self) -> None:
        self._count -= 1

    def redo(self) -> None:
        self._count += 1

    def unsaved(self) -> list[tuple[Snapshot, Snapshot]]:
        """The files that differ from the disk: as they were last read or saved, and with their new contents."""
        pairs = []
        for before, text in ((self.bindings, self.texts.bindings), (self.tcf, self.texts.tcf)):
            if text is not None and text != before.text:
                pairs.append((before, before.with_text(text)))
        for path, (first, now) in self._files.items():
            wanted = self.texts.files.get(path, first)
            if wanted != now:
                pairs.append((Snapshot(path, now), Snapshot(path, wanted)))
        return pairs

    @property
    def pending(self) -> list[Operation]:
        """The operations that are done, and that the files on the disk do not contain."""
        return self._operations[self._saved : self._count]

    def saved(self, after: Snapshot) -> None:
        """Notes that one of the files was saved as ``after``."""
        if after.path == self.bindings.path:
            self.bindings = after
        elif after.path in self._files:
            self._files[after.path] = (self._files[after.path][0], after.data)
        else:
            self.tcf = after
        if not self.changed:
            self._saved, self._diverged = self._count, False

    def rebased(self, bindings: Snapshot, tcf: Snapshot, model: Model | None) -> Draft:
        """A draft on new contents of the files, with the unsaved operations applied to them.

        Raises CannotEdit if an operation does not fit the new text any more.
        """
        if self.changed and (self._diverged or self._count < self._saved):
            raise CannotEdit("a change that was saved and then undone cannot be removed from the new text")
        draft = Draft(bindings, tcf, self._fresh)
        for operation in self.pending:
            draft.do(operation, model)
        return draft

    def diff(self) -> str:
        """The changes that saving would make, as a unified diff."""
        lines: list[str] = []
        for before, after in self.unsaved():
            old, new = before.text or "", after.text or ""
            name = before.path.name
            lines += difflib.unified_diff(
                _lines(old),
                _lines(new),
                name if before.data is not None else "(no file)",
                name if after.data is not None else "(no file)",
                lineterm="",
            )
        return "".join(f"{line}\n" for line in lines)

    def _applied(self, texts: Texts, operation: Iterable[Change], model: Model | None) -> Texts:
        for change in operation:
            if isinstance(change, SetParameter):
                texts = replace(texts, bindings=self._with_parameter(texts.bindings, change))
            elif isinstance(change, SetFile):
                self._files.setdefault(change.path, (change.before, change.before))
                texts = replace(texts, files={**texts.files, change.path: change.after})
            elif isinstance(change, ApplyEdit):
                texts = self._with_edit(texts, change)
            elif not isinstance(change, SetEnds):
                file, before = self.tcf.path.name, texts.tcf
                if before is None:
                    raise CannotEdit(f"'{file}' cannot be read")
                if isinstance(change, SetValue):
                    texts = replace(texts, tcf=set_value(before, file, change.path, change.value))
                elif isinstance(change, RenameKey):
                    texts = replace(texts, tcf=rename_key(before, file, change.path, change.name))
                else:
                    texts = replace(texts, tcf=remove_value(before, file, change.path))
            elif texts.bindings is None or model is None:
                what = "the bindings" if texts.bindings is None else "the model"
                raise CannotEdit(f"{what} must be correct before ports can be connected: see the messages")
            else:
                text = set_ends(texts.bindings, self.bindings.path.name, model, change.port, change.ends)
                texts = replace(texts, bindings=text)
        return texts

    def _with_edit(self, texts: Texts, change: ApplyEdit) -> Texts:
        in_bindings = change.path == self.bindings.path
        before = texts.bindings if in_bindings else texts.tcf
        after = apply_edit(before, change.edit) if before is not None else None
        if after is None:
            edit = change.edit
            where = f"{change.path.name}:{edit.span.line}"
            gone = (
                f"'{edit.old}' any more that '{edit.new}' could replace" if edit.old else f"such line: {edit.sentence}"
            )
            raise CannotEdit(f"{where}: there is no {gone}")
        return replace(texts, bindings=after) if in_bindings else replace(texts, tcf=after)

    def _with_parameter(self, text: str | None, change: SetParameter) -> str:
        file = self.bindings.path.name
        if text is None:
            raise CannotEdit(f"'{file}' cannot be read")
        if change.value is None:
            return remove_value(text, file, change.path)
        return set_value(text, file, change.path, change.value)


def _lines(text: str) -> list[str]:
    return text.replace("\r\n", "\n").replace("\r", "\n").splitlines()
