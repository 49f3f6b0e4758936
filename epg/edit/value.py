# SPDX-License-Identifier: Apache-2.0
"""The value of one port of a bindings file as YAML text: writes new values, and changes existing ones.

Maps are changed key by key and lists element by element, so that their comments stay.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher

import yaml

from epg.edit import yaml_edit
from epg.edit.ends import KEYS, REFERENCE, WireEnd, typed_value
from epg.edit.scalars import scalar_text
from epg.edit.yaml_edit import Steps
from epg.generator.check.bindings import UNCONNECTED
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import parse_yaml


def change_value(text: str, path: Steps, old: Sequence[WireEnd], new: Sequence[WireEnd]) -> str:
    """``text`` with the ends ``new`` at ``path`` in place of ``old``."""
    node = yaml_edit.node_at(text, path)
    if not old or not new or not yaml_edit.source_of(text, node):
        return _replace_value(text, path, new)
    if isinstance(node, yaml.SequenceNode):
        return _change_list(text, path, old, new)
    if len(new) == 1:
        return _change_end(text, path, old[0], new[0])
    return _change_list(_as_list(text, path), path, old, new)


def _written(key: str, value: str, style: str = "") -> str:
    """``value`` of ``key`` as YAML text: a number as the user has typed it, a text in the same quotes as before."""
    return value if not isinstance(typed_value(key, value), str) else scalar_text(value, style)


def _key_text(key: str, end: WireEnd) -> str:
    if key == "limits":
        assert end.limits is not None
        return f"limits: [{', '.join(_written(key, number) for number in end.limits)}]"
    return f"{key}: {_written(key, getattr(end, key))}"


def _keys_of(end: WireEnd) -> list[str]:
    return [key for key in KEYS if getattr(end, key) not in ("", None)]


def _end_text(end: WireEnd, section: str, reference: str = "") -> str:
    """``end`` on one line.  ``reference`` is the YAML text of its reference in the file, or empty."""
    reference = reference or scalar_text(end.reference)
    if not _keys_of(end):
        return reference
    parts = [f"{REFERENCE[section]}: {reference}", *(_key_text(key, end) for key in _keys_of(end))]
    return "{" + ", ".join(parts) + "}"


def value_text(text: str, ends: Sequence[WireEnd], section: str) -> str | list[str]:
    """The value of a port on one line, or as indented lines of a list if the file has its lists in this style."""
    texts = [_end_text(end, section) for end in ends]
    if not texts:
        return UNCONNECTED
    indent = _list_indent(text)
    if len(texts) > 1 and indent is not None:
        return [f"{indent}- {element}" for element in texts]
    return texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]"


def _list_indent(text: str) -> str | None:
    """The blanks before the dashes of lists, relative to their key; None if the lists of the file are in brackets."""
    outputs = yaml_edit.find(text, ("outputs",))
    if not isinstance(outputs, yaml.MappingNode) or outputs.flow_style:
        return None
    lists = [(key, value) for key, value in outputs.value if isinstance(value, yaml.SequenceNode)]
    if not lists or any(yaml_edit.is_flow(value) for _, value in lists):
        return None
    key, value = lists[0]
    return " " * int(value.start_mark.column - key.start_mark.column)


def _replace_value(text: str, path: Steps, ends: Sequence[WireEnd]) -> str:
    value = value_text(text, ends, str(path[0]))
    if isinstance(value, str):
        return yaml_edit.replace(text, path, value)
    return yaml_edit.replace_by_lines(text, path, value)


def _change_end(text: str, path: Steps, old: WireEnd, new: WireEnd) -> str:
    """``text`` with the end ``new`` at ``path``.  The node there is a scalar or a map that holds ``old``."""
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
    return _change_keys(text, path, key, present, new)


def _change_keys(text: str, path: Steps, key: str, present: list[str], new: WireEnd) -> str:
    """``text`` with the numbers of ``new`` in the map at ``path``, which has ``key`` and the other keys ``present``."""
    removed = False
    for name in KEYS:
        if name not in _keys_of(new):
            # An empty unit can stay, because it means the same as no unit.
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


def _change_key(text: str, path: Steps, key: str, new: WireEnd) -> str:
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
    if said is not None and repr(said.plain()) == repr(typed_value(key, new)):
        return text
    return yaml_edit.replace(text, path, _written(key, new, getattr(node, "style", "") or ""))


def _reference_text(text: str, node: yaml.Node, old: WireEnd, new: WireEnd) -> str:
    """The reference of ``new`` as YAML text: unchanged if it is that of ``old``, else in the same quotes."""
    style = node.style or "" if isinstance(node, yaml.ScalarNode) else ""
    source = yaml_edit.source_of(text, node)
    safe = style in ('"', "'") or source == scalar_text(new.reference)
    same = old.reference == new.reference and safe and not yaml_edit.has_break(source)
    return source if same else scalar_text(new.reference, style)


def _without_braces(text: str, path: Steps, inner: Steps) -> str:
    """``text`` with the value at ``inner`` in place of the braces or brackets at ``path``, if it is their only content.

    Braces over several lines stay, because they can hold comments.
    """
    node = yaml_edit.node_at(text, path)
    if not yaml_edit.is_flow(node) or yaml_edit.has_break(yaml_edit.source_of(text, node)):
        return text
    return yaml_edit.replace(text, path, yaml_edit.source_of(text, yaml_edit.node_at(text, inner)))


def _as_list(text: str, path: Steps) -> str:
    """``text`` with a list of one element in place of the single end at ``path``, in the style of the file's lists."""
    node = yaml_edit.node_at(text, path)
    indent = _list_indent(text)
    if isinstance(node, yaml.MappingNode) and not node.flow_style:
        return yaml_edit.indent_as_element(text, node)
    source = yaml_edit.source_of(text, node)
    if isinstance(node, yaml.ScalarNode) and (yaml_edit.has_break(source) or not node.style):
        source = scalar_text(node.value)
    if indent is None or yaml_edit.has_break(source):
        return yaml_edit.replace(text, path, f"[{source}]")
    return yaml_edit.replace_by_lines(text, path, [f"{indent}- {source}"])


def _change_list(text: str, path: Steps, old: Sequence[WireEnd], new: Sequence[WireEnd]) -> str:
    """``text`` with the list ``new`` at ``path``.  An end of ``new`` replaces the end of ``old`` with its reference."""
    elements = yaml_edit.node_at(text, path).value
    # The word 'unconnected' beside other elements has no meaning, and stays.
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


def _changes(old: Sequence[WireEnd], new: Sequence[WireEnd]) -> Iterator[tuple[str, int, int, int, int]]:
    """The differences between ``old`` and ``new``, the last first, so that indices before a change stay valid."""
    names, wanted = [end.reference for end in old], [end.reference for end in new]
    yield from reversed(SequenceMatcher(None, names, wanted, autojunk=False).get_opcodes())
