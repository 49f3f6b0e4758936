"""One port of a bindings file is bound otherwise, and everything else in the file stays as it was written.

>>> text = "version: 1\\nmodel: servo\\ninputs:\\n  angle: encoder   # at the load\\n"
>>> print(set_ends(text, "servo.bindings.yaml", model, "angle", [End("encoder", scale="1/4")]), end="")
version: 1
model: servo
inputs:
  angle: {from: encoder, scale: 1/4}   # at the load

An edit and its reverse give the old text, but for what had to go:

- comments on lines that were removed, comments of ``epg bind`` whose place was taken, line breaks and comments within
  a value that was replaced as a whole
- a section that was missing, commented out or empty comes back as ``inputs: {}``
- a port that comes back stands right below the one before it in the model's order, a key of a map likewise in the
  order of :data:`KEYS`: blank lines and comments that were between stay below
- ``{from: x}`` and ``[x]`` on one line become ``x`` when a key or an element is taken out of them
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from typing import Any

import yaml

from epg.check.bindings import UNCONNECTED
from epg.diagnostics import Diagnostics
from epg.emit import yaml_edit
from epg.emit.bindings_section import add_port, remove_port
from epg.emit.yaml_edit import CannotEdit, Steps
from epg.emit.yaml_text import scalar_text
from epg.load.models.model import Model
from epg.load.yaml_file import parse_yaml
from epg.source import Node

__all__ = ["CannotEdit", "End", "ends_of", "set_ends"]

REFERENCE = {"inputs": "from", "outputs": "to"}
KEYS = ("scale", "offset", "limits", "unit")
"""What a wire may have, in the order in which keys are added to a map, behind the reference."""


@dataclass(frozen=True)
class End:
    """One end of a wire as the file says it; texts, so that 1/4 stays 1/4, and empty where nothing is said."""

    reference: str  # "encoder_pan" or "encoder_pan.reset"
    scale: str = ""
    offset: str = ""
    limits: tuple[str, str] | None = None
    unit: str = ""


def ends_of(root: Node, section: str, port: str) -> tuple[End, ...] | None:
    """What a file says about a port: None if nothing, an empty tuple for ``unconnected``.

    ``section`` is "inputs" or "outputs".  A value the schema does not allow gives ends, too, as well as that goes.
    """
    node = root.get(section, port)
    if node is None:
        return None
    ends = node.elements() if node.is_sequence else (node,)
    return tuple(_end(end, REFERENCE[section]) for end in ends if section == "inputs" or end.value != UNCONNECTED)


def set_ends(text: str, file: str, model: Model, port: str, ends: Sequence[End] | None) -> str:
    """``text`` with ``port`` of ``model`` bound to ``ends``: None takes the port out, an empty list says `unconnected`.

    ``file`` names the text in messages.  Numbers that are none, and references that no component can have, are
    written so that reading the file reports them.  A port that the model does not have can be taken out only.
    Raises :class:`CannotEdit`.
    """
    body = text.removeprefix("\ufeff")
    root = _parse(body, file)
    section = _section_of(root, file, model, port, ends)
    wanted = None if ends is None else tuple(_trimmed(end) for end in ends)
    if wanted is not None:
        _refuse(wanted, file, section, port)
    before = _said(root.get(section, port), section)
    said = None if wanted is None else [_data(end, section) for end in wanted]
    if repr(before) == repr(said):
        return text
    try:
        if wanted is None:
            changed = remove_port(body, section, port)
        elif before is None:
            order = [p.name for p in (model.inputs if section == "inputs" else model.outputs)]
            changed = add_port(body, section, order, port, _value_text(body, wanted, section))
        else:
            changed = _change(body, (section, port), ends_of(root, section, port) or (), wanted)
    except CannotEdit as problem:
        raise CannotEdit(_where(root, file, section, port) + str(problem)) from None
    _verify(root, changed, file, section, port, said)
    return text[: len(text) - len(body)] + changed


def _parse(text: str, file: str) -> Node:
    problems = Diagnostics()
    root = parse_yaml(text, file, problems)
    if root is None:
        first = next(iter(problems))
        raise CannotEdit(f"{file}:{first.span.line}: {first.message}: mend this in an editor first")
    if not root.is_mapping:
        raise CannotEdit(f"{file}:1: this is no map: 'epg bind' writes bindings")
    return root


def _section_of(root: Node, file: str, model: Model, port: str, ends: Sequence[End] | None) -> str:
    """Where ``port`` belongs; to be taken out also where it should not be."""
    own = [
        section
        for section, ports in (("inputs", model.inputs), ("outputs", model.outputs))
        if any(port == p.name for p in ports)
    ]
    for section in ("inputs", "outputs"):
        node = root.get(section)
        if node is not None and not node.is_mapping and node.value is not None:
            span = root.key_span(section)
            raise CannotEdit(f"{file}:{span.line}: '{section}' is no map of ports: mend this in an editor first")
    written = [section for section in (*own, *REFERENCE) if root.get(section, port) is not None]
    if ends is None and written:
        return written[0]
    if not own:
        raise CannotEdit(f"{file}: {model.name} has no port '{port}'")
    return own[0]


def _refuse(ends: Sequence[End], file: str, section: str, port: str) -> None:
    if section == "inputs" and len(ends) != 1:
        raise CannotEdit(f"{file}: input '{port}' takes its value from one component, not from {len(ends) or 'none'}")
    if section == "outputs" and any(end.reference == UNCONNECTED for end in ends):
        raise CannotEdit(f"{file}: '{UNCONNECTED}' is no component that output '{port}' could go to")


def _where(root: Node, file: str, section: str, port: str) -> str:
    section_node = root.get(section)
    if section_node is None:
        return f"{file}: '{port}' cannot be changed here: "
    span = section_node.key_span(port) if port in section_node else root.key_span(section)
    return f"{file}:{span.line}: '{port}' cannot be changed here: "


def _verify(root: Node, changed: str, file: str, section: str, port: str, said: object) -> None:
    """Whether ``changed`` says what is wanted, and of everything else the same as before."""
    problems = Diagnostics()
    after = parse_yaml(changed, file, problems)
    if (
        after is None
        or repr(_others(after, section, port)) != repr(_others(root, section, port))
        or repr(_said(after.get(section, port), section)) != repr(said)
    ):
        raise CannotEdit(
            _where(root, file, section, port) + "EPG does not understand how it is written: change it in an editor"
        )


def _others(root: Node, section: str, port: str) -> list[Any]:
    ports = [(key, node.plain()) for key, node in (root[section].items() if section in root else ()) if key != port]
    return [ports, *((key, node.plain()) for key, node in root.items() if key != section)]


# What is said, as data: a list of maps from keys to values as the loader sees them.


def _said(node: Node | None, section: str) -> list[Any] | None:
    if node is None:
        return None
    ends = node.elements() if node.is_sequence else (node,)
    maps = [
        {key: child.plain() for key, child in end.items()} if end.is_mapping else {REFERENCE[section]: end.plain()}
        for end in ends
        if section == "inputs" or end.value != UNCONNECTED
    ]
    # a unit that is empty says as much as none
    return [sorted((key, value) for key, value in said.items() if (key, value) != ("unit", "")) for said in maps]


def _data(end: End, section: str) -> list[tuple[str, object]]:
    said: list[tuple[str, object]] = [(REFERENCE[section], end.reference)]
    for key in KEYS:
        value = getattr(end, key)
        if key == "limits" and value is not None:
            said.append((key, [_typed(key, number) for number in value]))
        elif value:
            said.append((key, _typed(key, value)))
    return sorted(said)


def _typed(key: str, text: str) -> object:
    """The value that YAML makes of ``text`` where a number is meant, else ``text`` itself."""
    if key in ("reference", "unit") or not text or any(not (c.isascii() and (c.isalnum() or c in "+-.")) for c in text):
        return text
    node = parse_yaml(text, "", Diagnostics())
    value = None if node is None else node.value
    return value if isinstance(value, (int, float)) and not isinstance(value, bool) else text


def _end(node: Node, key: str) -> End:
    def text(*path: str) -> str:
        child = node.get(*path)
        return "" if child is None or child.value is None else _text(child)

    if not node.is_mapping:
        return End("" if node.value is None else _text(node))
    limits = node.get("limits")
    pair = None
    if limits is not None:
        low, high, *_ = *(_text(number) for number in limits.elements()), "", ""
        pair = (low, high)
    return End(text(key), text("scale"), text("offset"), pair, text("unit"))


def _text(node: Node) -> str:
    value = node.value
    return value if isinstance(value, str) else scalar_text(value) if not isinstance(value, tuple) else ""


def _trimmed(end: End) -> End:
    limits = None if end.limits is None else (end.limits[0].strip(), end.limits[1].strip())
    return End(end.reference.strip(), end.scale.strip(), end.offset.strip(), limits, end.unit.strip())


# As text.


def _written(key: str, value: str, style: str = "") -> str:
    """``value`` of ``key``: a number as it was typed, a text in the quotes that were there before."""
    return value if not isinstance(_typed(key, value), str) else scalar_text(value, style)


def _key_text(key: str, end: End) -> str:
    if key == "limits":
        assert end.limits is not None
        return f"limits: [{', '.join(_written(key, number) for number in end.limits)}]"
    return f"{key}: {_written(key, getattr(end, key))}"


def _keys_of(end: End) -> list[str]:
    return [key for key in KEYS if getattr(end, key) not in ("", None)]


def _end_text(end: End, section: str, reference: str = "") -> str:
    """``end`` on one line; ``reference`` is how the file writes it."""
    reference = reference or scalar_text(end.reference)
    if not _keys_of(end):
        return reference
    parts = [f"{REFERENCE[section]}: {reference}", *(_key_text(key, end) for key in _keys_of(end))]
    return "{" + ", ".join(parts) + "}"


def _value_text(text: str, ends: Sequence[End], section: str) -> str | list[str]:
    """The value of a port on one line, or as the indented lines of a list, if that is the file's style."""
    texts = [_end_text(end, section) for end in ends]
    if not texts:
        return UNCONNECTED
    indent = _list_indent(text)
    if len(texts) > 1 and indent is not None:
        return [f"{indent}- {element}" for element in texts]
    return texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]"


def _list_indent(text: str) -> str | None:
    """The blanks before the dashes of lists, counted from their key; None if the file has its lists in brackets."""
    outputs = yaml_edit.find(text, ("outputs",))
    if not isinstance(outputs, yaml.MappingNode) or outputs.flow_style:
        return None
    lists = [(key, value) for key, value in outputs.value if isinstance(value, yaml.SequenceNode)]
    if not lists or any(yaml_edit.is_flow(value) for _, value in lists):
        return None
    key, value = lists[0]
    return " " * int(value.start_mark.column - key.start_mark.column)


# Changes of a value that is there.


def _change(text: str, path: Steps, old: Sequence[End], new: Sequence[End]) -> str:
    node = yaml_edit.node_at(text, path)
    if not old or not new or not yaml_edit.source_of(text, node):
        return _replace_value(text, path, new)
    if isinstance(node, yaml.SequenceNode):
        return _change_list(text, path, old, new)
    if len(new) == 1:
        return _change_end(text, path, old[0], new[0])
    return _change_list(_as_list(text, path), path, old, new)


def _replace_value(text: str, path: Steps, ends: Sequence[End]) -> str:
    value = _value_text(text, ends, str(path[0]))
    if isinstance(value, str):
        return yaml_edit.replace(text, path, value)
    return yaml_edit.replace_by_lines(text, path, value)


def _change_end(text: str, path: Steps, old: End, new: End) -> str:
    """One end, which is a scalar or a map, is now another one."""
    node = yaml_edit.node_at(text, path)
    key = REFERENCE[str(path[0])]
    if isinstance(node, yaml.ScalarNode):
        reference = _reference_text(text, node, old, new)
        return yaml_edit.replace(text, path, _end_text(new, str(path[0]), reference))
    present = [child.value for child, _ in node.value] if isinstance(node, yaml.MappingNode) else []
    if key not in present:
        return yaml_edit.replace(text, path, _end_text(new, str(path[0])))
    reference_node = yaml_edit.node_at(text, (*path, key))
    if old.reference != new.reference or not isinstance(reference_node, yaml.ScalarNode):
        text = yaml_edit.replace(text, (*path, key), _reference_text(text, reference_node, old, new))
    removed = False
    for name in KEYS:
        if name not in _keys_of(new):
            # an empty unit may stay, it says nothing
            if name in present and not (name == "unit" and yaml_edit.node_at(text, (*path, name)).value == ""):
                text = yaml_edit.remove(text, (*path, name))
                present.remove(name)
                removed = True
        elif name in present:
            text = _change_key(text, (*path, name), name, new)
        else:
            before = [key, *KEYS[: KEYS.index(name)]]
            index = max(present.index(other) for other in before if other in present) + 1
            text = yaml_edit.insert(text, path, index, _key_text(name, new))
            present.insert(index, name)
    return _without_braces(text, path, (*path, key)) if removed and present == [key] else text


def _change_key(text: str, path: Steps, key: str, new: End) -> str:
    if key != "limits":
        return _change_number(text, path, key, getattr(new, key))
    assert new.limits is not None
    node = yaml_edit.node_at(text, path)
    if not isinstance(node, yaml.SequenceNode) or len(node.value) != 2:
        return yaml_edit.replace(text, path, _key_text(key, new).removeprefix("limits: "))
    for index, number in enumerate(new.limits):
        text = _change_number(text, (*path, index), key, number)
    return text


def _change_number(text: str, path: Steps, key: str, new: str) -> str:
    node = yaml_edit.node_at(text, path)
    said = parse_yaml(yaml_edit.source_of(text, node), "", Diagnostics())
    if said is not None and repr(said.plain()) == repr(_typed(key, new)):
        return text
    return yaml_edit.replace(text, path, _written(key, new, getattr(node, "style", "") or ""))


def _reference_text(text: str, node: yaml.Node, old: End, new: End) -> str:
    """As the file writes it if it stays the same, else in the same quotes."""
    style = node.style or "" if isinstance(node, yaml.ScalarNode) else ""
    source = yaml_edit.source_of(text, node)
    safe = style in ('"', "'") or source == scalar_text(new.reference)
    same = old.reference == new.reference and safe and not yaml_edit.has_break(source)
    return source if same else scalar_text(new.reference, style)


def _without_braces(text: str, path: Steps, inner: Steps) -> str:
    """The value at ``inner``, all that is left between braces or brackets, stands for them; comments prevent it."""
    node = yaml_edit.node_at(text, path)
    if not yaml_edit.is_flow(node) or yaml_edit.has_break(yaml_edit.source_of(text, node)):
        return text
    return yaml_edit.replace(text, path, yaml_edit.source_of(text, yaml_edit.node_at(text, inner)))


def _as_list(text: str, path: Steps) -> str:
    """The one end at ``path`` as a list of one, in the file's style."""
    node = yaml_edit.node_at(text, path)
    indent = _list_indent(text)
    if isinstance(node, yaml.MappingNode) and not node.flow_style:
        return yaml_edit.indent_as_element(text, node)
    source = yaml_edit.source_of(text, node)
    if isinstance(node, yaml.ScalarNode) and (yaml_edit.has_break(source) or node.style is None):
        source = scalar_text(node.value)
    if indent is None or yaml_edit.has_break(source):
        return yaml_edit.replace(text, path, f"[{source}]")
    return yaml_edit.replace_by_lines(text, path, [f"{indent}- {source}"])


def _change_list(text: str, path: Steps, old: Sequence[End], new: Sequence[End]) -> str:
    """A list of ends: those with the same reference are the same ends, in the order of ``new``."""
    elements = yaml_edit.node_at(text, path).value
    # the word 'unconnected' beside others says nothing and stays
    places = [index for index, element in enumerate(elements) if element.value != UNCONNECTED]
    removed = False
    for what, first, last, start, stop in _changes(old, new):
        both = min(last - first, stop - start)
        if what == "equal" or what == "replace":
            for index in reversed(range(both)):
                text = _change_end(text, (*path, places[first + index]), old[first + index], new[start + index])
        for end in reversed(new[start + both : stop]):
            at = places[first + both - 1] + 1 if first + both > 0 else places[0]
            text = yaml_edit.insert(text, path, at, _end_text(end, str(path[0])))
        for index in reversed(range(first + both, last)):
            text = yaml_edit.remove(text, (*path, places[index]))
            removed = True
    if removed and len(yaml_edit.node_at(text, path).value) == 1:
        return _without_braces(text, path, (*path, 0))
    return text


def _changes(old: Sequence[End], new: Sequence[End]) -> Iterator[tuple[str, int, int, int, int]]:
    """How ``new`` comes of ``old``, from the end on, so that indices before a change stay true."""
    names = [replace(end, scale="", offset="", limits=None, unit="") for end in old]
    wanted = [replace(end, scale="", offset="", limits=None, unit="") for end in new]
    yield from reversed(SequenceMatcher(None, names, wanted, autojunk=False).get_opcodes())
