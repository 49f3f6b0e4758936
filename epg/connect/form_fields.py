# SPDX-License-Identifier: Apache-2.0
"""The parts of a form: fields, sections of settings, forms of kinds, and the values in the files.

``data()`` of each is what the page gets as JSON: the interfaces ``Forms``, ``KindForm``, ``Field`` and ``Value`` in
``page/types.d.ts``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field

from epg.connect.json_data import Data
from epg.generator.dataclass import dataclass

FieldPath = tuple[str, ...]
"""The keys of a value in a ``.tcf``; in the form of a kind, below the component."""


@dataclass(frozen=True)
class FormField:
    """A field for one value.  Texts that are empty are not known; ``choices`` is None if any text is possible.

    ``type`` is "quantity", "ratio", "number", "integer", "boolean", "text", "choice", "reference", "pin", "yaml", or
    "group" for a field with ``fields``.
    """

    path: FieldPath
    type: str
    description: str = ""
    required: bool = False
    default: str = ""
    units: Sequence[str] = ()
    choices: Sequence[str] | None = None
    limits: str = ""
    example: str = ""
    section: str = ""
    fields: tuple[FormField, ...] = ()

    @property
    def name(self) -> str:
        return self.path[-1]

    @property
    def all(self) -> Iterator[FormField]:
        """This field and those below it."""
        yield self
        for below in self.fields:
            yield from below.all

    def data(self) -> Data:
        texts = ("description", "default", "limits", "example", "section")
        data: Data = {"path": list(self.path), "name": self.name, "type": self.type}
        data |= {key: text for key in texts if (text := getattr(self, key))}
        data |= {"required": True} if self.required else {}
        data |= {"units": list(self.units)} if self.units else {}
        data |= {"choices": list(self.choices)} if self.choices is not None else {}
        return data | ({"fields": [each.data() for each in self.fields]} if self.type == "group" else {})


@dataclass(frozen=True)
class FieldSet:
    """Names of fields of which a component must set one, or ``several`` of them."""

    names: tuple[str, ...]
    several: bool


@dataclass(frozen=True)
class KindForm:
    """The form of a component of a kind.  ``unusable`` is the reason why the target cannot have such a component."""

    group: str
    summary: str
    fields: tuple[FormField, ...]
    one_of: tuple[FieldSet, ...]
    unusable: str

    def data(self) -> Data:
        return {
            "group": self.group,
            "summary": self.summary,
            "fields": [each.data() for each in self.fields],
            "one_of": [{"names": list(each.names), "several": each.several} for each in self.one_of],
            "unusable": self.unusable,
        }


@dataclass(frozen=True)
class SettingsSection:
    """Fields of a target with a common title."""

    title: str
    fields: tuple[FormField, ...]


@dataclass(frozen=True)
class FormValue:
    """A value as a user writes it.  ``how`` is "own", "file", "epg", or "call" for an argument in CMake.

    ``back`` is the value that holds if the project's ``own`` file does not set it.  ``removed`` is True if that file
    removes the value.
    """

    text: str
    how: str
    file: str
    line: int
    own: bool = False
    back: FormValue | None = None
    removed: bool = False

    def data(self) -> Data:
        data: Data = {"text": self.text, "how": self.how, "file": self.file, "line": self.line}
        data |= {"own": True} if self.own else {}
        data |= {"back": self.back.data()} if self.back is not None else {}
        return data | ({"removed": True} if self.removed else {})


@dataclass(frozen=True)
class Forms:
    """The forms of a target.  The keys of ``values`` are the keys in the ``.tcf``, joined by dots.

    A value that no file has is missing there: the ``default`` of its field holds.  ``left_out`` are the inherited
    components that the own file removes.
    """

    kinds: Mapping[str, KindForm] = field(default_factory=dict)
    settings: Sequence[SettingsSection] = ()
    values: Mapping[str, FormValue] = field(default_factory=dict)
    left_out: Sequence[str] = ()

    def data(self) -> Data:
        return {
            "kinds": {name: form.data() for name, form in self.kinds.items()},
            "settings": [
                {"title": section.title, "fields": [each.data() for each in section.fields]}
                for section in self.settings
            ],
            "values": {key: value.data() for key, value in self.values.items()},
            "left_out": list(self.left_out),
        }

    def field_at(self, path: Sequence[str]) -> FormField | None:
        """The field of the value at ``path``; None if the target has no such field."""
        fields: Iterable[FormField] = (each for section in self.settings for each in section.fields)
        wanted = tuple(path)
        if path[0] == "components" and len(path) > 2:
            kind = self.values.get(f"components.{path[1]}.kind")
            form = self.kinds.get(kind.text) if kind is not None else None
            fields = form.fields if form is not None else ()
            wanted = wanted[2:]
        return next((each for top in fields for each in top.all if each.path == wanted), None)
