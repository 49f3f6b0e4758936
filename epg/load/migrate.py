# SPDX-License-Identifier: Apache-2.0
"""Files of older formats, rewritten in the newest one with everything else left as its author wrote it.

Every file says the version of its format (``version: 1``, in the folders of ``targets`` ``api: 1``).  When a format
changes, its version grows by one and :data:`FORMATS` gets a migration from the version before: a function that returns
the edits of a file, as replacements of keys and values.  Comments, order and line ends stay because nothing else is
touched.  There has been no change so far: all formats are of version 1.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from epg.diagnostics import Diagnostics
from epg.load.yaml_file import parse_yaml
from epg.source import Node, Span

_LINE_END = re.compile("\r\n|\r|\n|\x85|\u2028|\u2029")  # as PyYAML counts lines


@dataclass(frozen=True)
class Edit:
    """A stretch of a line, and what stands there afterwards."""

    span: Span
    text: str


Migration = Callable[[Node], Iterable[Edit]]
"""From the root of a file to the edits that bring it to the next version; the version itself is not among them."""


@dataclass(frozen=True)
class Format:
    """A sort of file: the key with its version, the newest version, and the migration from each older one."""

    name: str
    key: str = "version"
    newest: int = 1
    migrations: Mapping[int, Migration] = field(default_factory=dict)

    @property
    def oldest(self) -> int:
        return min(self.migrations, default=self.newest)


FORMATS = {
    **{name: Format(name) for name in ("tcf", "bindings", "model", "scenario")},
    **{name: Format(name, key="api") for name in ("soc", "board", "platform", "middleware", "component")},
}


@dataclass(frozen=True)
class Migrated:
    """A file in the newest format; ``first`` is the version it had."""

    text: str
    format: Format
    first: int


def rename_key(node: Node, old: str, new: str) -> list[Edit]:
    """The edit that calls the key ``old`` of a map ``new``; none if it has no such key."""
    return [Edit(node.key_span(old), new)] if old in node else []


def replace_value(node: Node, text: str) -> list[Edit]:
    """The edit that writes ``text`` (as YAML) in the place of a scalar that stands on one line."""
    assert not node.is_mapping and not node.is_sequence
    return [Edit(node.span, text)]


def format_of(path: Path, node: Node) -> Format | None:
    """The format of a file: by its name where that says it, else by its keys."""
    if path.suffix == ".tcf":
        return FORMATS["tcf"]
    if path.suffix == ".yaml" and path.stem in FORMATS:
        return FORMATS[path.stem]
    if "setpoints" in node and "axes" in node:
        return FORMATS["scenario"]
    return FORMATS["bindings"] if "model" in node else None


def migrate(text: str, path: Path, diagnostics: Diagnostics) -> Migrated | None:
    """The text of ``path`` in the newest format, or None after reporting why it cannot be migrated."""
    node = parse_yaml(text, str(path), diagnostics)
    if node is None:
        return None
    format = format_of(path, node)
    if format is None:
        hint = "EPG's are .tcf files, bindings, scenarios, model.yaml and the descriptions in targets folders"
        diagnostics.error("unknown-file", Span(str(path), 1, 1, 2), "this is no file of EPG's", hint=hint)
        return None
    first = _version(node, format, diagnostics)
    if first is None:
        return None
    for version in range(first, format.newest):
        bumped = replace_value(node[format.key], str(version + 1))
        text = apply_edits(text, [*format.migrations[version](node), *bumped])
        following = parse_yaml(text, str(path), diagnostics)
        if following is None or following[format.key].value != version + 1:
            raise AssertionError(f"the migration of {format.name} from version {version} breaks the file")
        node = following
    return Migrated(text, format, first)


def apply_edits(text: str, edits: Iterable[Edit]) -> str:
    """``text`` with all edits made; raises ValueError when two of them overlap."""
    starts = [0, *(end.end() for end in _LINE_END.finditer(text))]
    places = sorted((starts[e.span.line - 1] + e.span.column - 1, e.span.end - e.span.column, e.text) for e in edits)
    result, done = [], 0
    for start, length, new in places:
        if start < done:
            raise ValueError("two edits overlap")
        result += [text[done:start], new]
        done = start + length
    return "".join([*result, text[done:]])


def _version(node: Node, format: Format, diagnostics: Diagnostics) -> int | None:
    """The version a file states, if there is a way from it to the newest."""
    stated = node.get(format.key)
    if stated is None:
        hint = f"write '{format.key}: {format.newest}' if it is of the newest format"
        diagnostics.error("missing-key", node.span, f"'{format.key}' is missing", hint=hint)
        return None
    version = stated.value
    if not isinstance(version, int) or isinstance(version, bool):
        diagnostics.error("wrong-type", stated.span, f"expected a whole number, found '{version}'")
        return None
    if version > format.newest:
        message = f"file format {version} is newer than this EPG, which reads up to {format.newest}"
        diagnostics.error("newer-version", stated.span, message, hint="update EPG")
        return None
    if version < format.oldest:
        message = f"there is no file format {version}: the oldest is {format.oldest}"
        diagnostics.error("wrong-value", stated.span, message)
        return None
    return version
