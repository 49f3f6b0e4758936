# SPDX-License-Identifier: Apache-2.0
"""A ``.tcf`` and the chain of files that it extends.  The files are read but not merged: ``epg.generator.check.merge``
does that.

>>> # chain = load_tcf_chain(Path("rpi_pico2_freertos_jiwy.tcf"), roots, diagnostics)
>>> # [file.path.name for file in chain]  ->  target, wiring, robot
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, nearest, question
from epg.generator.documents.composed_tcf import FoundTcf, composed_names, composed_tcf, possible_targets
from epg.generator.documents.text_file import NO_DRAFTS, Drafts, is_file, is_folder, read_text
from epg.generator.documents.yaml_file import MAX_DEPTH, parse_yaml
from epg.generator.source import Span, YamlNode

_20SIM_4C = re.compile(r"\s*(<\?xml|<!DOCTYPE|<[A-Za-z])")
_MAX_CHAIN = 16
_LISTED = 8
"""The number of files that a hint lists."""


@dataclass(frozen=True)
class TcfFile:
    """One file of a chain.

    ``extended_by`` is the position of the ``extends`` that names it.  ``absent`` are the paths of files that do not
    exist, but that would be read instead of this one if they did.  The path of a composed configuration is one of them.
    """

    path: Path
    node: YamlNode
    extended_by: Span | None = None
    absent: tuple[Path, ...] = ()

    @property
    def is_composed(self) -> bool:
        """True if there is no such file."""
        return self.path in self.absent


def find_tcf(name: str, beside: Path, roots: Sequence[Path]) -> Path | None:
    """The file ``name``, with or without ``.tcf``; None if it does not exist.

    ``name`` is a path relative to ``beside``, or the name of a file in a folder ``robots/*`` of ``roots``, or of a
    composed configuration: the path is then where its file would be.
    """
    found = _find(name, beside, roots)
    return None if found is None else found.path


def files_of(chain: Iterable[TcfFile]) -> list[Path]:
    """The files that were read for a chain."""
    return [file.path for file in chain if not file.is_composed]


def _find(name: str, beside: Path, roots: Sequence[Path]) -> FoundTcf | None:
    """The file ``name``, or the configuration that is composed if there is no such file."""
    names = _file_names(name)
    for path in _candidates(name, beside):
        if is_file(path):
            return FoundTcf(path)
    if any(separator in name for separator in "/\\"):
        return None
    for root in roots:
        robots = sorted((root / "robots").glob("*/"))
        for candidate in names:
            files = [robot / candidate for robot in robots if is_file(robot / candidate)]
            if files:
                return FoundTcf(files[0])
    return composed_tcf(name, roots)


def _file_names(name: str) -> list[str]:
    return [name] if name.endswith(".tcf") else [name, f"{name}.tcf"]


def _candidates(name: str, beside: Path) -> list[Path]:
    return [beside / candidate for candidate in _file_names(name)]


def predefined_tcf_names(targets: Iterable[str], roots: Sequence[Path]) -> list[str]:
    """The names of all ``.tcf`` files in the folders ``robots/*`` of ``roots``, and those composed for ``targets``."""
    files = {path.name for root in roots for path in (root / "robots").glob("*/*.tcf")}
    return sorted(files | composed_names(targets, roots))


def load_tcf_chain(
    name: str,
    roots: Sequence[Path],
    diagnostics: Diagnostics,
    *,
    beside: Path | None = None,
    wanted_by: Span | None = None,
    drafts: Drafts = NO_DRAFTS,
) -> tuple[TcfFile, ...]:
    """The file ``name`` and all files that it extends, ``name`` itself first.

    Empty after reporting a file that cannot be read, or a chain that never ends.
    """
    chain: list[TcfFile] = []
    beside = beside or Path()
    while True:
        read = {file.path.resolve() for file in chain}  # A file must not extend itself.
        found = _find(name, beside, roots)
        if found is not None and found.path.resolve() in read:
            # A user's file may extend a file of EPG that has the same name: search there only.
            found = _find(name, beside / "nowhere", roots) or found
        if found is None:
            hint = _missing_hint(name, beside, read, predefined_tcf_names(possible_targets(roots), roots))
            diagnostics.error("tcf-not-found", wanted_by or Span(name), f"there is no file '{name}'", hint=hint)
            return ()
        if found.path.resolve() in read:
            assert wanted_by is not None
            message = f"'{found.path.name}' extends itself"
            diagnostics.error("extends-loop", wanted_by, message, hint="remove this 'extends'")
            return ()
        if len(chain) == _MAX_CHAIN:
            assert wanted_by is not None
            diagnostics.error("extends-depth", wanted_by, f"this chain of 'extends' has more than {_MAX_CHAIN} files")
            return ()
        node = _load(found, diagnostics, wanted_by, drafts)
        if node is None:
            return ()
        chain.append(TcfFile(found.path, node, wanted_by, (*_absent(name, beside, found.path), *found.absent)))
        extends = node.get("extends")
        if extends is None or not isinstance(extends.value, str):
            return tuple(chain)
        name, beside, wanted_by = extends.value, found.path.parent, extends.span


def _absent(name: str, beside: Path, found: Path) -> tuple[Path, ...]:
    """The files that do not exist, but that the name would mean in place of the ``found`` one if they did."""
    candidates = _candidates(name, beside)
    before = candidates[: candidates.index(found)] if found in candidates else candidates
    return tuple(candidate for candidate in before if not is_file(candidate))


def _missing_hint(name: str, beside: Path, read: Collection[Path], predefined: Iterable[str]) -> str:
    """The files that the user can mean: one with a similar name, or those in the same folder that are not ``read``.

    A file of EPG is meant only if its name is very similar: otherwise the user's own file is missing.
    """
    wanted, inside = Path(_file_names(name)[-1]).name, Path(name).parent
    folder = beside / inside
    if not is_folder(folder):
        return f"there is no folder '{folder}'"
    there = [path.name for path in sorted(folder.glob("*.tcf")) if path.resolve() not in read]
    near = [(inside / file).as_posix() for file in nearest(wanted, there)] or nearest(name, predefined, cutoff=0.75)
    if near:
        return question(near, name)
    listed = ", ".join(there[:_LISTED]) + (", ..." if len(there) > _LISTED else "")
    has = f"the folder has {listed}" if there else "the folder has no .tcf"
    return f"{has}; 'epg targets' lists the files of EPG"


def _load(found: FoundTcf, diagnostics: Diagnostics, wanted_by: Span | None, drafts: Drafts) -> YamlNode | None:
    path = found.path
    text = read_text(path, diagnostics, wanted_by, drafts) if found.text is None else found.text
    if text is None:
        return None
    if _20SIM_4C.match(text):
        kind = "a target configuration of 20-sim 4C" if "arget" in text[:4096] or "4C" in text[:4096] else "XML"
        message = f"this is {kind}, not a target configuration of EPG"
        hint = "EPG's .tcf files are YAML: 'epg targets' lists the ones that EPG provides"
        diagnostics.error("tcf-is-20-sim-4c", Span(str(path), 1, 1, 2), message, hint=hint)
        return None
    node = parse_yaml(text, str(path), diagnostics)
    if node is None:
        return None
    if not node.is_mapping:
        message, hint = "a .tcf must be a map (key: value)", "begin the file with 'version: 1'"
        diagnostics.error("wrong-type", Span(str(path), 1, 1, 2), message, hint=hint)
        return None
    return None if _is_other_file(node, diagnostics) else node


def _is_other_file(node: YamlNode, diagnostics: Diagnostics) -> bool:
    """True after reporting that a map is not a target configuration, but another file of EPG."""
    if "model" in node and "components" not in node and ("inputs" in node or "outputs" in node):
        message = "these are bindings, not a target configuration"
        hint = "name this file by BINDINGS or --bindings, and the target configuration by TCF or --tcf"
        diagnostics.error("tcf-is-bindings", node.key_span("model"), message, hint=hint)
        return True
    if "system" in node and "targets" in node:
        message = "this is a system, not a target configuration"
        hint = "the name of a system ends with '.system.yaml': rename the file"
        diagnostics.error("tcf-is-system", node.key_span("system"), message, hint=hint)
        return True
    return False


def settings_node(
    settings: Iterable[tuple[str, Span]], diagnostics: Diagnostics
) -> list[tuple[tuple[str, ...], YamlNode]]:
    """The keys and the value of each setting ``a.b=value`` from a command line or CMake; mistakes are reported.

    The position in ``settings`` becomes the position of the value.
    """
    result: list[tuple[tuple[str, ...], YamlNode]] = []
    for text, span in settings:
        key, equals, value = text.partition("=")
        path = tuple(key.strip().split("."))
        if not equals or not all(path) or len(path) > MAX_DEPTH:
            hint = "write KEY.KEY=VALUE, for example 'control.period=2 ms', in quotes if the value has a blank"
            diagnostics.error("wrong-setting", span, f"'{text}' is not a setting", hint=hint)
            continue
        problems = Diagnostics()
        node = parse_yaml(value, span.file, problems)
        for problem in problems:
            diagnostics.error("wrong-setting", span, f"in '{text}': {problem.message}", hint=problem.hint)
        if node is not None:
            result.append((path, _moved(node, span)))
    return result


def _moved(node: YamlNode, span: Span) -> YamlNode:
    """The same value with the position ``span``."""
    if node.is_mapping:
        value = {key: _moved(child, span) for key, child in node.items()}
        return YamlNode(value, span, dict.fromkeys(value, span))
    if node.is_sequence:
        return YamlNode(tuple(_moved(child, span) for child in node.elements()), span)
    return YamlNode(node.value, span)
