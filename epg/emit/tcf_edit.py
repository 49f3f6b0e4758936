"""A ``.tcf`` extends another file, and everything else in it stays as it was written."""

from __future__ import annotations

from epg.diagnostics import Diagnostics
from epg.emit import yaml_edit
from epg.emit.yaml_edit import CannotEdit
from epg.emit.yaml_text import scalar_text
from epg.load.yaml_file import parse_yaml

KEY = "extends"


def set_extends(text: str, file: str, name: str) -> str:
    """``text`` with ``extends: name``.  Raises CannotEdit where it is no ``.tcf`` that extends another file."""
    root = parse_yaml(text, file, Diagnostics())
    if root is None or not root.is_mapping:
        raise CannotEdit(f"'{file}' has a mistake that must be mended in an editor first")
    old = root.get(KEY)
    if old is None or not isinstance(old.value, str):
        raise CannotEdit(f"'{file}' extends no other file: it says itself what the target consists of")
    return yaml_edit.replace(text, (KEY,), scalar_text(name))
