# SPDX-License-Identifier: Apache-2.0
"""Checks the files in folders of targets: first against their schema, then by the rules that no schema can express."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from pathlib import Path

from epg.generator.catalog.added_class import check_class
from epg.generator.catalog.check_hardware import check_board, check_family, check_platform, check_soc
from epg.generator.catalog.check_kind import check_kind
from epg.generator.catalog.check_middleware import check_middleware
from epg.generator.catalog.kind import TEMPLATE
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.documents.items import elements_of, map_of
from epg.generator.documents.schema import load_schema, validate
from epg.generator.documents.text_file import is_file
from epg.generator.documents.yaml_file import newer_version
from epg.generator.source import Span, YamlNode

_CHECKS = {
    "soc": check_soc,
    "board": check_board,
    "platform": check_platform,
    "middleware": check_middleware,
    "component": check_kind,
    "class": check_class,
}


def check_file(category: str, node: YamlNode, name: str, platforms: Sequence[str], diagnostics: Diagnostics) -> bool:
    """True if the file of the item ``name`` has no mistakes.  Reports them otherwise.

    ``platforms`` are the names of all platforms of the catalog.
    """
    key = "kind" if category == "component" else category
    if not node.is_mapping:
        span = Span(node.span.file, 1, 1, 2)
        diagnostics.error(
            "wrong-type", span, f"a {category}.yaml must be a map (key: value)", hint="begin the file with 'api: 1'"
        )
        return False
    if newer_version(node, "api", diagnostics) or not validate(node, load_schema(category), diagnostics):
        return False
    errors = diagnostics.error_count
    if node[key].value != name:
        message = f"{key} '{node[key].value}' is in a folder called '{name}'"
        hint = f"write '{key}: {name}', or rename the folder"
        diagnostics.error("wrong-folder", node[key].span, message, hint=hint)
    if category == "family":
        check_family(node, platforms, diagnostics)
        _beside(node["family"], "family.cmake", "docs/adding-a-family.md", diagnostics)
    else:
        _CHECKS[category](node, diagnostics)
    if category == "platform" and node["builds"].value is True:
        _beside(node["builds"], "platform.cmake", "docs/adding-a-platform.md", diagnostics)
    if category in ("platform", "family"):
        _files_exist(node, ("templates",), diagnostics)
        _check_templates(elements_of(node, "templates"), diagnostics)
    for path in _lists_of_files(category, node):
        _files_exist(node, path, diagnostics)
    if category == "component":
        _beside(node["kind"], TEMPLATE, "docs/adding-a-component-kind.md", diagnostics)
    return diagnostics.error_count == errors


_FILE = re.compile(r"(?:[A-Za-z0-9_+-][A-Za-z0-9_+.-]*/)*[A-Za-z0-9_+-][A-Za-z0-9_+.-]*")
"""Names that are possible in ``#include`` and in CMake, and that do not lead out of the folder."""


def _lists_of_files(category: str, node: YamlNode) -> list[tuple[str, ...]]:
    """The places of the lists of C files in the file of an item."""
    if category == "class":
        return [("headers",), *(("ports", name) for name in map_of(node, "ports"))]
    return [("driver", "headers"), ("driver", "sources")]


def _files_exist(node: YamlNode, path: tuple[str, ...], diagnostics: Diagnostics) -> None:
    """Reports names in the list at ``path`` that are not files in the folder of ``node``."""
    folder = Path(node.span.file).parent
    for name in elements_of(node, *path):
        if not _FILE.fullmatch(str(name.value)):
            message = f"{'.'.join(path)}: '{name.value}' is not the name of a file in this folder"
            hint = "use letters, digits and '_+.-', and '/' for subfolders"
            diagnostics.error("wrong-value", name.span, message, hint=hint)
        elif not is_file(folder / str(name.value)):
            there = [file.name for file in folder.iterdir() if file.is_file()]
            hint = did_you_mean(str(name.value), there, "files in that folder")
            message = f"{'.'.join(path)}: there is no file '{name.value}'"
            diagnostics.error("file-not-found", name.span, message, hint=hint)


def _check_templates(names: Collection[YamlNode], diagnostics: Diagnostics) -> None:
    """Reports names of a platform's templates that have a wrong form, or that would replace a file of every target."""
    for name in names:
        if not _TEMPLATE.fullmatch(str(name.value)) or str(name.value) in _TAKEN:
            message = f"templates: '{name.value}' cannot be the name of a platform's template"
            hint = "name it for example 'NAME_<platform>.c.j2': EPG replaces NAME by the name of the target"
            diagnostics.error("wrong-value", name.span, message, hint=hint)


_TEMPLATE = re.compile(r"(?:NAME(?:_[a-z0-9_]+)?|epg_[a-z0-9_]+)\.[A-Za-z]+\.j2")
_TAKEN = {
    f"NAME_{part}.j2"
    for of in ("model", "plant")
    for part in (f"{of}.h", f"{of}.c", f"{of}_names.h", *(f"{of}_export.{suffix}" for suffix in ("h", "c", "cpp")))
} | {"NAME_app.c.j2", "NAME_access.c.j2", "NAME.h.j2", "NAME.cmake.j2", "NAME.json.j2"}
"""The templates of files that every target has."""


def _beside(node: YamlNode, name: str, page: str, diagnostics: Diagnostics) -> None:
    """Reports that the folder of ``node`` lacks the file ``name``, which it needs because of ``node``."""
    folder = Path(node.span.file).parent
    if not (folder / name).is_file():
        hint = f"{page} describes the contents of this file"
        diagnostics.error("file-not-found", node.span, f"'{folder.name}' has no {name}", hint=hint)
