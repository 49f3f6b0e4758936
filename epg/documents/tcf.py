# SPDX-License-Identifier: Apache-2.0
"""A ``.tcf`` with the files it extends, each still as it was written.

>>> # chain = load_tcf_chain(Path("rpi_pico2_freertos_jiwy.tcf"), roots, diagnostics)
>>> # [file.path.name for file in chain]  ->  target, wiring, robot
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from epg.diagnostics import Diagnostics, did_you_mean
from epg.documents.text_file import NO_DRAFTS, Drafts, is_file, read_text
from epg.documents.yaml_file import MAX_DEPTH, parse_yaml
from epg.source import Span, YamlNode

_20SIM_4C = re.compile(r"\s*(<\?xml|<!DOCTYPE|<[A-Za-z])")
_MAX_CHAIN = 16


@dataclass(frozen=True)
class TcfFile:
    """One file of a chain; ``extended_by`` is where the file before it in the chain names it.

    ``absent`` are files that would be read instead of this one if they existed.
    """

    path: Path
    node: YamlNode
    extended_by: Span | None = None
    absent: tuple[Path, ...] = ()


def find_tcf(name: str, beside: Path, roots: Iterable[Path]) -> Path | None:
    """The file ``name`` (with or without ``.tcf``): a path relative to ``beside``, or a robot's file in ``roots``."""
    names = _file_names(name)
    for path in _candidates(name, beside):
        if is_file(path):
            return path
    if any(separator in name for separator in "/\\"):
        return None
    for root in roots:
        robots = sorted((root / "robots").glob("*/"))
        for candidate in names:
            found = [robot / candidate for robot in robots if is_file(robot / candidate)]
            if found:
                return found[0]
    return None


def _file_names(name: str) -> list[str]:
    return [name] if name.endswith(".tcf") else [name, f"{name}.tcf"]


def _candidates(name: str, beside: Path) -> list[Path]:
    return [beside / candidate for candidate in _file_names(name)]


def predefined_tcf_names(roots: Iterable[Path]) -> list[str]:
    """Names of all ``.tcf`` files that can be found by name."""
    return sorted({path.name for root in roots for path in (root / "robots").glob("*/*.tcf")})


def load_tcf_chain(
    name: str,
    roots: Sequence[Path],
    diagnostics: Diagnostics,
    *,
    beside: Path | None = None,
    wanted_by: Span | None = None,
    drafts: Drafts = NO_DRAFTS,
) -> tuple[TcfFile, ...]:
    """The file ``name`` and all that it extends, innermost first; empty after reporting why it cannot be read."""
    chain: list[TcfFile] = []
    beside = beside or Path()
    while True:
        read = {file.path.resolve() for file in chain}  # a file must not extend itself
        path = find_tcf(name, beside, roots)
        if path is None:
            others = [file.name for file in sorted(beside.glob("*.tcf")) if file.resolve() not in read]
            known = [*predefined_tcf_names(roots), *others]
            span = wanted_by or Span(name)
            diagnostics.error("tcf-not-found", span, f"there is no file '{name}'", hint=did_you_mean(name, known))
            return ()
        if path.resolve() in read:  # one of EPG's may have the same name
            path = find_tcf(name, beside / "nowhere", roots) or path
        if path.resolve() in read:
            assert wanted_by is not None
            message = f"'{path.name}' is extended by itself"
            diagnostics.error("extends-loop", wanted_by, message, hint="remove this 'extends'")
            return ()
        if len(chain) == _MAX_CHAIN:
            assert wanted_by is not None
            diagnostics.error("extends-depth", wanted_by, f"more than {_MAX_CHAIN} files extend each other")
            return ()
        node = _load(path, diagnostics, wanted_by, drafts)
        if node is None:
            return ()
        candidates = _candidates(name, beside)
        before = candidates[: candidates.index(path)] if path in candidates else candidates
        absent = [candidate for candidate in before if not is_file(candidate)]
        chain.append(TcfFile(path, node, wanted_by, tuple(absent)))
        extends = node.get("extends")
        if extends is None or not isinstance(extends.value, str):
            return tuple(chain)
        name, beside, wanted_by = extends.value, path.parent, extends.span


def _load(path: Path, diagnostics: Diagnostics, wanted_by: Span | None, drafts: Drafts) -> YamlNode | None:
    text = read_text(path, diagnostics, wanted_by, drafts)
    if text is None:
        return None
    if _20SIM_4C.match(text):
        kind = "a target configuration of 20-sim 4C" if "arget" in text[:4096] or "4C" in text[:4096] else "XML"
        diagnostics.error(
            "tcf-is-20-sim-4c",
            Span(str(path), 1, 1, 2),
            f"this is {kind}, not of EPG",
            hint="both are called .tcf; EPG's are YAML: 'epg targets' lists those it brings",
        )
        return None
    node = parse_yaml(text, str(path), diagnostics)
    if node is not None and not node.is_mapping:
        diagnostics.error(
            "wrong-type", Span(str(path), 1, 1, 2), "a .tcf is a map (key: value)", hint="it begins with 'version: 1'"
        )
        return None
    return node


def settings_node(
    settings: Iterable[tuple[str, Span]], diagnostics: Diagnostics
) -> list[tuple[tuple[str, ...], YamlNode]]:
    """Settings ``a.b=value`` from a command line or CMake, each with the place to name in messages."""
    result: list[tuple[tuple[str, ...], YamlNode]] = []
    for text, span in settings:
        key, equals, value = text.partition("=")
        path = tuple(key.strip().split("."))
        if not equals or not all(path) or len(path) > MAX_DEPTH:
            diagnostics.error(
                "wrong-setting",
                span,
                f"'{text}' is no setting",
                hint="write KEY.KEY=VALUE, such as control.period=2 ms",
            )
            continue
        problems = Diagnostics()
        node = parse_yaml(value, span.file, problems)
        for problem in problems:
            diagnostics.error("wrong-setting", span, f"in '{text}': {problem.message}", hint=problem.hint)
        if node is not None:
            result.append((path, _moved(node, span)))
    return result


def _moved(node: YamlNode, span: Span) -> YamlNode:
    """The same value standing at ``span``."""
    if node.is_mapping:
        value = {key: _moved(child, span) for key, child in node.items()}
        return YamlNode(value, span, dict.fromkeys(value, span))
    if node.is_sequence:
        return YamlNode(tuple(_moved(child, span) for child in node.elements()), span)
    return YamlNode(node.value, span)
