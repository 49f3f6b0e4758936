# SPDX-License-Identifier: Apache-2.0
"""The actions of the user that change the draft of the open target.

Each function takes the open target and the body of the request, makes one step of the draft, and raises
:class:`Refused` or CannotEdit if it cannot; nothing has changed then.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence

from epg.connect.body import Body, Refused, bodies, ends, keys, names, text
from epg.connect.component_edits import add, copy, fill, remove, rename, take_back
from epg.connect.draft import RemoveValue, SetEnds, SetValue
from epg.connect.editor import Editor
from epg.connect.pinout import chosen_pin, first_pins
from epg.connect.view import proposals_of
from epg.edit.bindings import WireEnd
from epg.edit.parameters import PARAMETERS


def _connect(editor: Editor, body: Body) -> None:
    editor.edit((_wires(editor, body),))


def _rewire(editor: Editor, body: Body) -> None:
    """Changes the wires of several ports in one step.  "ends" of null removes a port from the bindings."""
    changes = bodies(body, "changes")
    editor.edit(
        tuple(
            SetEnds(text(change, "port"), None) if change.get("ends") is None else _wires(editor, change)
            for change in changes
        )
    )


def _wires(editor: Editor, body: Body) -> SetEnds:
    port, wires = text(body, "port"), ends(body)
    model = editor.loaded.parts.model
    if model is not None and len(wires) != 1 and port in [p.name for p in model.inputs]:
        raise Refused(f"input '{port}' must be bound to one component", "to remove its wire, disconnect it")
    return SetEnds(port, wires)


def _disconnect(editor: Editor, body: Body) -> None:
    editor.edit((SetEnds(text(body, "port"), None),))


def _accept(editor: Editor, body: Body) -> None:
    """Connects "ports" as proposed, by default all of them."""
    proposals = proposals_of(editor.loaded)
    wanted = names(body, "ports", list(proposals))
    for name in wanted:
        if name not in proposals:
            raise Refused(f"there is no proposal for '{name}'", "connect it by hand")
    if wanted:
        editor.edit(tuple(SetEnds(name, (WireEnd(proposals[name]),)) for name in wanted))


def _apply(editor: Editor, body: Body) -> None:
    """Makes the edit that a message proposes, named by its position and its new text."""
    wanted = body.get("file"), body.get("line"), body.get("column"), body.get("new")
    for change in itertools.chain.from_iterable(editor.proposed_edits()):
        span = change.edit.span
        if (span.file, span.line, span.column, change.edit.new) == wanted:
            editor.edit((change,))
            return
    raise Refused("no message proposes this change any more", "see the messages", 409)


def _leave_out(editor: Editor, body: Body) -> None:
    """Removes all parts of the robot that no port uses."""
    parts = editor.unused_parts()
    if not parts:
        raise Refused("no part of the robot is unused", "connect all ports first", 409)
    editor.edit(tuple(SetValue(("components", *part), None) for part in parts))


def _unset(editor: Editor, body: Body) -> None:
    """Removes keys from the ``.tcf``, in one step: the values of the extended file, or the defaults, hold again."""
    paths = body.get("paths")
    if not isinstance(paths, list):
        raise Refused("'paths' must be a list of lists of keys")
    _own(editor).edit(tuple(RemoveValue(keys(path)) for path in paths))


def _choose_pin(editor: Editor, body: Body) -> None:
    """Gives a signal of a component another pin.  Signals that must be beside it follow."""
    signal = text(body, "component"), text(body, "signal")
    _own(editor).edit(chosen_pin(editor.loaded, signal, text(body, "pin")))


def _first_pins(editor: Editor, body: Body) -> None:
    """Gives the first pins that fit to "signals", by default to all signals without a pin."""
    wanted = [(text(each, "component"), text(each, "signal")) for each in bodies(body, "signals")] if body else None
    _own(editor).edit(first_pins(editor.loaded, wanted))


def _fill(editor: Editor, body: Body) -> None:
    """Gives values the texts of their fields, in one step.  An empty text means the default."""
    changes = [(keys(each.get("path")), text(each, "text", "").strip()) for each in bodies(body, "changes")]
    _holding(editor, [path for path, _ in changes])
    editor.edit(tuple(c for path, wanted in changes for c in fill(editor.forms, editor.loaded, path, wanted)))


def _take_back(editor: Editor, body: Body) -> None:
    """Removes a value from the project's own file: the inherited value, or the default, holds again."""
    path = keys(body.get("path"))
    _holding(editor, [path])
    editor.edit(tuple(take_back(editor.forms, editor.loaded, path)))


def _add(editor: Editor, body: Body) -> None:
    """Adds a component.  Pins that are not given are free ones that fit."""
    name, given = text(body, "name"), body.get("values")
    if not isinstance(given, Mapping):
        raise Refused("'values' must be an object")
    values = {key: text(given, key, "").strip() for key in given}
    operation = add(_own(editor).forms, editor.loaded, text(body, "kind"), name, values)
    editor.edit(editor.with_pins(operation, name))


def _copy(editor: Editor, body: Body) -> None:
    """Copies a component.  The copy gets free pins."""
    name = text(body, "name")
    _own(editor).edit(editor.with_pins(copy(editor.loaded, text(body, "component"), name), name))


def _rename(editor: Editor, body: Body) -> None:
    _own(editor).edit(rename(editor.loaded, editor.users, text(body, "component"), text(body, "name")))


def _remove(editor: Editor, body: Body) -> None:
    _own(editor).edit(remove(editor.loaded, editor.users, text(body, "component")))


def _own(editor: Editor) -> Editor:
    """The editor.  Raises Refused if the target uses a ``.tcf`` of EPG itself."""
    if not editor.owns_tcf:
        raise Refused("this file cannot be changed", editor.project().fixed, 409)
    return editor


def _holding(editor: Editor, paths: Sequence[Sequence[str]]) -> None:
    """Raises Refused if EPG itself owns the file of one of ``paths``.  Parameters are in the bindings of the user."""
    if not all(path[0] == PARAMETERS for path in paths):
        _own(editor)


EDITS: dict[str, Callable[[Editor, Body], None]] = {
    "connect": _connect,
    "rewire": _rewire,
    "disconnect": _disconnect,
    "accept": _accept,
    "apply": _apply,
    "leave_out": _leave_out,
    "unset": _unset,
    "choose_pin": _choose_pin,
    "first_pins": _first_pins,
    "fill": _fill,
    "take_back": _take_back,
    "add": _add,
    "copy": _copy,
    "rename": _rename,
    "remove": _remove,
    "undo": lambda editor, body: editor.undo(),
    "redo": lambda editor, body: editor.redo(),
}
"""The function of each action."""
