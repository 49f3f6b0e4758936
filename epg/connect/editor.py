# SPDX-License-Identifier: Apache-2.0
"""One open target: its files, the draft on top of them, and the result of loading both."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from epg.connect.body import Refused
from epg.connect.component_edits import Users, pins_for, users_of, users_view
from epg.connect.configurations import Project
from epg.connect.draft import ApplyEdit, Draft, Operation, SetFile, SetValue
from epg.connect.files import Snapshot, Watch, read_snapshot, save
from epg.connect.form_fields import Forms
from epg.connect.forms import forms_of
from epg.connect.literal_calls import FILE
from epg.connect.loaded import Models, load, tcf_path, value_at
from epg.connect.moved_files import FileChange, file_changes
from epg.connect.moving import TcfMove, plan_move
from epg.connect.pinout import problems_view, signals_view
from epg.connect.projects import Job, find_jobs
from epg.connect.unused_parts import unused_parts
from epg.connect.view import view_of
from epg.edit.applied import edits_of
from epg.edit.bindings import CannotEdit
from epg.edit.scalars import scalar_text
from epg.generator.catalog.catalog import Catalog, load_catalog
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.emit.leftovers import remove_leftovers
from epg.generator.importers import load_model
from epg.generator.project import Request


@dataclass(frozen=True)
class Move:
    """A move to another target: the changes of the ``.tcf``, and those of the project's other files.

    ``files`` is None if EPG has no project for the new target.
    """

    tcf: TcfMove
    files: list[FileChange] | None

    @property
    def operation(self) -> Operation:
        changed = [change for change in self.files or () if change.what != "asked"]
        return (*self.tcf.operation, *(SetFile(each.path, each.before, each.after) for each in changed))

    def data(self) -> dict[str, Any]:
        return {
            "items": [item.data() for item in self.tcf.items],
            "files": [change.data() for change in self.files] if self.files is not None else None,
        }


_CONFLICT_HINT = "reload to discard your changes, or save anyway to overwrite the other program's changes"


class Editor:
    """The files and the draft of ``job``.  Not thread-safe: the caller must hold the session's lock.

    ``external`` is a note for the user about an edit by another program.  ``conflict`` is set while such an edit and
    the draft do not fit together.  ``ask`` are the errors that saving would make in other targets of the project, while
    the user decides about them.
    """

    def __init__(self, job: Job) -> None:
        self.job = job
        self.external: str | None = None
        self.conflict: dict[str, str] | None = None
        self.ask: list[dict[str, Any]] = []
        self._tcf_path = tcf_path(job.request) or Path(os.path.abspath(job.request.tcf))
        self._models = Models()
        self._catalog: Catalog | None = None
        self._forms: Forms | None = None
        for path in (job.request.bindings, self._tcf_path):
            remove_leftovers(Path(os.path.realpath(path)))
        self.draft = self._new_draft()
        self._load()

    def edit(self, operation: Operation) -> None:
        """Changes the draft.  Raises CannotEdit or Refused; nothing has changed then."""
        self.check_conflict()
        self.draft.do(operation, self.loaded.parts.model)
        self._after_edit()

    def undo(self) -> None:
        if not self.draft.can_undo:
            raise Refused("there is nothing to undo", status=409)
        self.draft.undo()
        self._after_edit()

    def redo(self) -> None:
        if not self.draft.can_redo:
            raise Refused("there is nothing to redo", status=409)
        self.draft.redo()
        self._after_edit()

    def save(self, *, anyway: bool) -> None:
        """Writes the changed files.  ``anyway`` also overwrites edits that other programs have made since."""
        if not anyway:
            self.check_conflict()
        for before, after in self.draft.unsaved():
            save(before, after, project=self.job.source_dir, anyway=anyway)
            self.draft.saved(after)
        self.conflict = self.external = None
        self.ask = []
        self._seen = self.draft.bindings, self.draft.tcf
        self._load()

    def reload(self) -> None:
        """Discards the draft and reads the files again."""
        self.draft = self._new_draft()
        self.conflict = self.external = None
        self.ask = []
        self._load()

    def look(self) -> bool:
        """Reads the files again if another program has changed them.  Returns True if one has changed.

        If there are unsaved changes, they are applied to the new text.  If they do not fit it, ``conflict`` is set.
        """
        changed = self._watch.changed()
        if not changed:
            return False
        if any(path.suffix == ".yaml" and path != self.job.request.bindings for path in changed):
            self._catalog = None
        model, external = self.loaded.parts.model, self.external
        what = ", ".join(f"'{path.name}'" for path in changed[:3]) + (" and others" if changed[3:] else "")
        self._seen = bindings, tcf = self._snapshots()
        if (bindings.data, tcf.data) == (self.draft.bindings.data, self.draft.tcf.data):
            self.conflict = None
            self.external = f"{what} changed; EPG has read the new text"
        elif not self.draft.changed:
            self.draft = Draft(bindings, tcf, self._fresh(bindings))
            self.conflict = None
            self.external = f"another program changed {what}; EPG has read the new text"
        else:
            self._rebase(bindings, tcf, what)
        self._load()
        if self.loaded.parts.model == model and all(path.is_dir() for path in changed):
            self.external = external  # a folder that was searched for the model has a new entry, such as a build folder
        return True

    @property
    def catalog(self) -> Catalog:
        """All kinds and middlewares.  They are read once, because this takes 0.1 s."""
        if self._catalog is None:
            self._catalog = load_catalog(self.job.request.roots, Diagnostics())
        return self._catalog

    @property
    def forms(self) -> Forms:
        """The forms of the settings and components."""
        if self._forms is None:
            self._forms = forms_of(self.loaded, self.catalog, owns_tcf=self.owns_tcf)
        return self._forms

    @property
    def users(self) -> dict[str, Users]:
        """The uses of each component."""
        return users_of(self.loaded, self._folder())

    def with_pins(self, operation: Operation, name: str) -> Operation:
        """``operation``, which adds the component ``name``, with free pins for its signals without a pin."""
        drafts = self.draft.drafts(operation, self.loaded.parts.model)
        request = replace(self.job.request, drafts=drafts)
        return (*operation, *pins_for(request, self.catalog, [name], self.loaded))

    @property
    def owns_tcf(self) -> bool:
        """False if the target uses a ``.tcf`` of EPG itself, which EPG does not change."""
        return not any(root / "robots" in self._tcf_path.parents for root in self.job.request.roots)

    def project(self) -> Project:
        """The configuration that the project's own ``.tcf`` extends, and the reason if that cannot be changed."""
        configuration, chain = self.loaded.parts.configuration, self.loaded.chain
        target = configuration.target if configuration is not None else None
        path = self._tcf_path
        if not self.owns_tcf:
            hint = f"write a .tcf with 'extends: {path.name}', and name your file in CMakeLists.txt"
            return Project(path.stem, f"this project uses {path.name}, which EPG does not change: {hint}", target)
        if not chain:
            return Project("", f"{path.name} has an error: see the messages", target)
        own = chain[0].node.get("target")
        if own is not None:
            return Project(str(own.value), "", target, own_target=True)
        extends = chain[0].node.get("extends")
        if extends is None or not isinstance(extends.value, str):
            return Project("", f"{path.name} has neither 'target' nor 'extends'", target)
        return Project(extends.value.removesuffix(".tcf"), "", target)

    def plan_move(self, choice: str) -> Move:
        """The changes that move the target to ``choice``, a target or configuration.  Raises Refused or CannotEdit."""
        self.check_conflict()
        project, text = self.project(), self.draft.texts.tcf
        if text is None or not self.loaded.chain:
            raise Refused(f"'{self._tcf_path.name}' cannot be read", "see the messages", 409)
        key, value = ("target", choice) if project.own_target else ("extends", f"{choice}.tcf")
        before = self._middleware(text)
        files = self._file_changes(project.chosen, choice, before, before)
        after = {change.path: change.after for change in files or () if change.what != "asked"}
        request = replace(self._request(after), drafts=self.draft.drafts())
        move = plan_move(self.loaded, request, self._tcf_path, SetValue((key,), value), self._models)
        if self._middleware(move.text) != before:
            files = self._file_changes(project.chosen, choice, before, self._middleware(move.text))
        return Move(move, files)

    def _file_changes(self, old: str, new: str, before: str | None, after: str | None) -> list[FileChange] | None:
        """The changes of the project's files from one target, with its middleware, to another one."""
        return file_changes(self.job, old, new, (before, after), self.draft.files)

    def _middleware(self, text: str) -> str | None:
        """The middleware that a text of the ``.tcf`` states."""
        root = parse_yaml(text, self._tcf_path.name, Diagnostics())
        node = value_at(root, "communication", "middleware")
        return None if node is None else str(node.value)

    def unused_parts(self) -> list[list[str]]:
        """The parts of the robot that no port uses, as soon as all ports are connected, or unconnected on purpose."""
        model, configuration = self.loaded.parts.model, self.loaded.parts.configuration
        if model is None or configuration is None or not self.owns_tcf:
            return []
        if not {port.name for port in (*model.inputs, *model.outputs)} <= {*self.loaded.bound, *self.loaded.by_system}:
            return []
        return unused_parts(configuration, self.loaded.references, self.loaded.plant_references)

    def show(self) -> dict[str, Any]:
        """The part of the state that belongs to this target."""
        why_not = self._why_not()
        shown = view_of(self.loaded)
        for message, changes in zip(shown["diagnostics"], self.proposed_edits()):
            message["edits"] = [change.edit.data() for change in changes]
        return {
            "project": {"name": self.job.request.name, "folder": str(self._folder()), "files": self._files()},
            **shown,
            "pins": {
                "signals": signals_view(self.loaded),
                "problems": problems_view(self.loaded),
                "why_not": "" if self.owns_tcf else self.project().fixed,
            },
            "forms": {**self.forms.data(), "locked": "" if self.owns_tcf else self.project().fixed},
            "users": users_view(self.users),
            "ask": self.ask,
            "unused": [".".join(part) for part in self.unused_parts()],
            "draft": {
                "changed": self.draft.changed,
                "can_undo": self.draft.can_undo,
                "can_redo": self.draft.can_redo,
                "diff": self.draft.diff(),
                "conflict": self.conflict,
                "external": self.external,
            },
            "editable": not why_not,
            "why_not": why_not,
        }

    def proposed_edits(self) -> list[list[ApplyEdit]]:
        """For each message the edits that it proposes, of files that can be changed here."""
        files = {os.path.abspath(path): (path, text) for path, text in self.draft.drafts().items()}
        if not self.owns_tcf:
            files.pop(os.path.abspath(self.draft.tcf.path), None)

        def text_of(file: str) -> str | None:
            return files.get(os.path.abspath(file), (None, None))[1]

        return [
            [
                ApplyEdit(files[os.path.abspath(edit.span.file)][0], edit)
                for edit in edits_of(diagnostic, text_of)
                if edit.span.text is None
            ]
            for diagnostic in self.loaded.diagnostics
        ]

    def _why_not(self) -> str:
        """The reason why ports cannot be connected; empty if they can."""
        name = self.job.request.bindings.name
        text = self.draft.texts.bindings
        if text is None:
            return f"'{name}' cannot be read: see the messages"
        root = parse_yaml(text, name, Diagnostics())
        if root is None or not root.is_mapping:
            return f"'{name}' has an error that must first be corrected in an editor: see the messages"
        if self.loaded.parts.model is None:
            return "the model cannot be read: see the messages"
        return ""

    def _folder(self) -> Path:
        return self.job.source_dir or Path(os.path.abspath(self.job.request.bindings)).parent

    def _files(self) -> dict[str, str]:
        request, folder = self.job.request, self._folder()
        files = {"tcf": self._tcf_path, "model": request.model, "bindings": request.bindings}
        return {what: _relative(path, folder) for what, path in files.items()}

    def check_conflict(self) -> None:
        """Raises :class:`Refused` while the draft does not fit an edit of the files by another program."""
        if self.conflict is not None:
            raise Refused(self.conflict["message"], self.conflict["hint"], 409)

    def _after_edit(self) -> None:
        self.external = None
        self.ask = []
        if self.conflict is not None and not self.draft.changed:
            self.draft = self._new_draft()  # the last change was undone, so nothing can be lost
            self.conflict = None
        self._load()

    def _rebase(self, bindings: Snapshot, tcf: Snapshot, what: str) -> None:
        count = len(self.draft.pending)
        try:
            self.draft = self.draft.rebased(bindings, tcf, self.loaded.parts.model)
        except CannotEdit as problem:
            message = f"another program changed {what}, and your changes do not fit the new text: {problem}"
            self.conflict = {"message": message, "hint": _CONFLICT_HINT}
            self.external = None
        else:
            changes = "your change was" if count == 1 else f"your {count} changes were"
            self.conflict = None
            self.external = f"another program changed {what}: {changes} applied to the new text"

    def _load(self) -> None:
        request = replace(self._request(self.draft.files), drafts=self.draft.drafts())
        self.loaded = load(request, self._models)
        self._forms = None
        self._watch = Watch(self.loaded.files(), self._seen)

    def _request(self, files: Mapping[Path, bytes | None]) -> Request:
        """The request that CMake will make with ``files``, which are not saved yet: only the plant can differ."""
        if self.job.source_dir is None or not any(path.name == FILE for path in files):
            return self.job.request
        request = self.job.request
        jobs = find_jobs(self.job.source_dir, Diagnostics(), files)
        found = next((job.request for job in jobs if job.request.name == request.name), request)
        return replace(request, plant=found.plant, plant_bindings=found.plant_bindings)

    def _new_draft(self) -> Draft:
        self._seen = bindings, tcf = self._snapshots()
        return Draft(bindings, tcf, self._fresh(bindings))

    def _snapshots(self) -> tuple[Snapshot, Snapshot]:
        return read_snapshot(self.job.request.bindings), read_snapshot(self._tcf_path)

    def _fresh(self, bindings: Snapshot) -> str:
        """The first text of the bindings if that file does not exist; empty if it does."""
        if bindings.data is not None:
            return ""
        model = load_model(self.job.request.model, Diagnostics())
        return f"version: 1\nmodel: {scalar_text(model.name)}\n" if model is not None else ""


def _relative(path: Path, folder: Path) -> str:
    """``path`` relative to ``folder`` if it is below it, else absolute."""
    absolute = Path(os.path.abspath(path))
    return absolute.relative_to(folder).as_posix() if folder in absolute.parents else str(absolute)
