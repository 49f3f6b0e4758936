# SPDX-License-Identifier: Apache-2.0
"""Adds, removes, renames and copies components of the open target, and changes values of its ``.tcf``.

Each function returns the changes of one step.  The names of a component in other values of the ``.tcf`` and in the
bindings follow.  EPG's own files and other inherited files are never changed: the project's own ``.tcf`` overrides
their values, and ``null`` removes them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path

from epg.connect.body import Refused
from epg.connect.draft import Change, Operation, RemoveValue, RenameKey, SetEnds, SetParameter, SetValue
from epg.connect.form_fields import FormField, Forms
from epg.connect.forms import value_of
from epg.connect.json_data import Data
from epg.connect.loaded import Loaded, value_at
from epg.edit.bindings import WireEnd
from epg.edit.parameters import PARAMETERS, parameter_path
from epg.generator.catalog.catalog import Catalog
from epg.generator.check.names import identifier_problem
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import Request, load_configuration
from epg.generator.quantity import number_hint
from epg.generator.resolve.first_fit import first_fit, signals_of

COMPONENTS = "components"
_SETTINGS = (("control", "fail_safe"), ("communication", "transport"), ("communication", "console", "transport"))
"""The values beside components that can name a component."""
_LARGEST = 1 << 20
"""The largest file in bytes in which names of components are searched."""


@dataclass
class Users:
    """The uses of one component: ports of the model, components with the key that names it, settings, other files.

    ``files`` are files of the project that EPG does not change here: of a simulated robot, or scenarios.
    """

    ports: dict[str, list[WireEnd]] = field(default_factory=dict)
    components: list[tuple[str, str]] = field(default_factory=list)
    settings: list[tuple[str, ...]] = field(default_factory=list)
    files: list[str] = field(default_factory=list)


def users_of(loaded: Loaded, folder: Path) -> dict[str, Users]:
    """The uses of each component.  ``folder`` is that of the project."""
    users = {name: Users() for name in _names(loaded)}
    for _, port, ends in loaded.wires:
        for name in users.keys() & {end.reference.partition(".")[0] for end in ends}:
            users[name].ports[port] = list(ends)
    for component, key, name in _named_by_components(loaded):
        if name in users:
            users[name].components.append((component, key))
    for path in _SETTINGS:
        value = value_at(loaded.tree, *path)
        if value is not None and value.value in users:
            users[str(value.value)].settings.append(path)
    for file, words in _other_files(loaded, folder):
        for name in users.keys() & words:
            users[name].files.append(file)
    return users


def _named_by_components(loaded: Loaded) -> Iterator[tuple[str, str, str]]:
    """The components that name another one: the name of each, its key, and the name of the other."""
    for component in loaded.components.values():
        for use in component.kind.uses:
            named = component.node.get(use.name)
            if named is not None:
                yield component.name, use.name, str(named.value).partition(".")[0]


def _other_files(loaded: Loaded, folder: Path) -> Iterator[tuple[str, set[str]]]:
    """The names of other YAML files of the project, and the words in them."""
    own = {loaded.request.bindings.resolve(), *(file.path.resolve() for file in loaded.chain)}
    plant = loaded.request.plant_bindings
    for path in dict.fromkeys([*([plant] if plant is not None else []), *sorted(folder.glob("*.yaml"))]):
        try:
            if path.resolve() not in own and path.stat().st_size <= _LARGEST:
                yield path.name, set(re.findall(r"\w+", path.read_text(encoding="utf-8")))
        except (OSError, UnicodeDecodeError):
            continue


def users_view(users: Mapping[str, Users]) -> Data:
    """The uses of each component as plain data; a component without any is left out."""
    shown = {
        name: {
            "ports": list(each.ports),
            "components": [component for component, _ in each.components],
            "settings": [".".join(path) for path in each.settings],
            "files": each.files,
        }
        for name, each in users.items()
    }
    return {name: each for name, each in shown.items() if any(each.values())}


# values


def fill(forms: Forms, loaded: Loaded, path: tuple[str, ...], text: str) -> list[Change]:
    """Gives the value at ``path`` the ``text`` of its field.  An empty text means that no file sets the value."""
    found = _field(forms, path)
    if path[0] == PARAMETERS:
        value = value_of(found, text, Refused) if text else None
        if not (value is None or isinstance(value, (int, float))):
            raise Refused(f"'{text}' is not a number", number_hint(text))
        return [SetParameter(parameter_path(loaded.root, path[1]), value)]
    if text:
        return [SetValue(path, value_of(found, text, Refused))]
    value_now = forms.values.get(".".join(path))
    if value_now is not None and value_now.removed:
        return []
    return [SetValue(path, None)] if _inherited(loaded, path) else take_back(forms, loaded, path)


def _field(forms: Forms, path: tuple[str, ...]) -> FormField:
    found = forms.field_at(path)
    if found is None:
        raise Refused(f"there is no value '{'.'.join(path)}'", "reload the page", 409)
    return found


def take_back(forms: Forms, loaded: Loaded, path: tuple[str, ...]) -> list[Change]:
    """Removes the value at ``path`` from the project's own file.  Its group stays, although it can be empty then."""
    _field(forms, path)
    if path[0] == PARAMETERS:
        return fill(forms, loaded, path, "")
    group, own = path[:-1], loaded.chain[0].node.get(*path[:-1])
    field = forms.field_at(group) if group else None
    is_last = own is not None and [key for key, _ in own.items()] == [path[-1]]
    is_group = field is not None and field.type == "group" and field.name != "pins"
    if is_last and is_group and not _inherited(loaded, group):
        return [SetValue(group, {})]
    return [RemoveValue(path)]


def _inherited(loaded: Loaded, path: Sequence[str]) -> bool:
    """True if a file that the project's own one extends has a value at ``path``."""
    for file in loaded.chain[1:]:
        node = file.node.get(*path)
        if node is not None:
            return node.value is not None
    return False


# components


def add(forms: Forms, loaded: Loaded, kind: str, name: str, texts: Mapping[str, str]) -> Operation:
    """Adds a component.  ``texts`` are the texts of its fields by their paths, joined by dots."""
    form = forms.kinds.get(kind)
    if form is None:
        raise Refused(f"there is no kind '{kind}'", status=404)
    if form.unusable:
        raise Refused(f"this target cannot have a {kind}", form.unusable, 409)
    _check_name(name, loaded)
    values: Data = {"kind": kind}
    known = {".".join(each.path): each for field in form.fields for each in field.all}
    for key, text in sorted(texts.items(), key=lambda each: each[0].count(".")):  # a group before its values
        if key not in known:
            raise Refused(f"a {kind} has no parameter '{key}'", status=404)
        if text:
            *above, last = known[key].path
            tree = values
            for step in above:
                tree = tree.setdefault(step, {})
            tree[last] = value_of(known[key], text, Refused)
    return (SetValue((COMPONENTS, name), values),)


def pins_for(request: Request, catalog: Catalog, names: Sequence[str], loaded: Loaded) -> Operation:
    """Free pins for the signals of components ``names`` that have none.

    ``request`` reads the ``.tcf`` with the components.  Empty if it has errors, or if no pins fit.
    """
    configuration = load_configuration(request, catalog, Diagnostics(), pins_required=False)
    if configuration is None:
        return ()
    model = loaded.parts.model
    period = configuration.control.period or (model.step if model is not None else None)
    wanted = [signal for signal, pin in signals_of(configuration).items() if signal[0] in names and not pin]
    pins = first_fit(configuration, period, wanted) if wanted else {}
    return tuple(SetValue((COMPONENTS, name, "pins", signal), pin) for (name, signal), pin in (pins or {}).items())


def copy(loaded: Loaded, name: str, new: str) -> Operation:
    """Adds a component ``new`` with the values of ``name``, without its pins; a topic of the same name is renamed."""
    node = _node(loaded, name)
    _check_name(new, loaded)
    values = {key: value for key, value in node.items() if key not in ("pins", "node")}
    if values.get("topic") == name:
        values["topic"] = new
    return (SetValue((COMPONENTS, new), values),)


def remove(loaded: Loaded, users: Mapping[str, Users], name: str) -> Operation:
    """Removes a component, its wires, the components that need it, and the settings that name it."""
    _node(loaded, name)
    names = _with_dependents(loaded, users, name)
    changes: list[Change] = []
    ports = {port: ends for each in names for port, ends in users[each].ports.items()}
    for port, ends in ports.items():
        kept = tuple(end for end in ends if end.reference.partition(".")[0] not in names)
        changes.append(SetEnds(port, kept or None))
    for each in names:
        for other, key in users[each].components:
            if other not in names:
                changes.append(_without(loaded, (COMPONENTS, other, key)))
        changes += [_without(loaded, path) for path in users[each].settings]
        changes.append(_without(loaded, (COMPONENTS, each)))
    return tuple(changes)


def _with_dependents(loaded: Loaded, users: Mapping[str, Users], name: str) -> list[str]:
    """A component, and those that cannot be without it: a guard needs its motor and its encoder."""
    names = [name]
    for each in names:  # the list grows
        for other, key in users[each].components:
            needed = any(use.name == key and use.required for use in loaded.components[other].kind.uses)
            if needed and other not in names:
                names.append(other)
    return names


def _without(loaded: Loaded, path: tuple[str, ...]) -> Change:
    return SetValue(path, None) if _inherited(loaded, path) else RemoveValue(path)


def rename(loaded: Loaded, users: Mapping[str, Users], name: str, new: str) -> Operation:
    """Renames a component everywhere in the ``.tcf`` and the bindings.

    A component of another file gets a copy with the new name, and is removed.
    """
    node = _node(loaded, name)
    if new == name:
        return ()
    _check_name(new, loaded, without=name)
    path = (COMPONENTS, name)
    changes: list[Change]
    if _inherited(loaded, path):
        changes = [SetValue((COMPONENTS, new), node), SetValue(path, None)]
    else:
        changes = [RenameKey(path, new)]
    for port, ends in users[name].ports.items():
        renamed = tuple(replace(end, reference=_renamed(end.reference, name, new)) for end in ends)
        changes.append(SetEnds(port, renamed))
    for other, key in users[name].components:
        written = loaded.components[other].node[key].value
        owner = new if other == name else other
        changes.append(SetValue((COMPONENTS, owner, key), _renamed(str(written), name, new)))
    changes += [SetValue(each, new) for each in users[name].settings]
    return tuple(changes)


def _renamed(reference: str, name: str, new: str) -> str:
    component, dot, port = reference.partition(".")
    return f"{new}{dot}{port}" if component == name else reference


def _node(loaded: Loaded, name: str) -> Data:
    """The values of a component, with the inherited ones."""
    node = value_at(loaded.tree, COMPONENTS, name)
    if node is None:
        raise Refused(f"there is no component '{name}'", status=404)
    values: Data = node.plain()
    return values


def _names(loaded: Loaded) -> list[str]:
    section = value_at(loaded.tree, COMPONENTS)
    return [name for name, _ in section.items()] if section is not None else []


def _check_name(name: str, loaded: Loaded, without: str = "") -> None:
    problem = identifier_problem(name)
    if problem:
        raise Refused(f"'{name}' {problem}")
    same = next((each for each in _names(loaded) if each.casefold() == name.casefold() and each != without), None)
    if same is not None:
        raise Refused(f"there is a component '{same}' already", "choose another name", 409)
    if _inherited(loaded, (COMPONENTS, name)):
        raise Refused(
            f"'{name}' is a component that your file leaves out", "choose another name, or bring it back", 409
        )
