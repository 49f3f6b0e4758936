# SPDX-License-Identifier: Apache-2.0
"""The build folders of a project: the existing ones, those of its CMake presets, and the usual one, ``build``."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from epg.diagnostics import Diagnostics
from epg.documents.text_file import is_file
from epg.tools.find_tool import read_cmake_cache

USUAL = "build"
CACHE = "CMakeCache.txt"


@dataclass(frozen=True)
class BuildFolder:
    """A build folder.  ``variables`` are those of its CMake cache, or of the preset ``preset`` that would create it.

    If Zephyr's sysbuild has built several images, ``path`` is the folder around them, as ``west build -d`` takes it.
    """

    path: Path
    variables: Mapping[str, str] = field(default_factory=dict)
    preset: str = ""
    image: Path | None = None  # the folder that CMake has configured: ``path`` or, with sysbuild, a folder below it


def build_folders(source: Path) -> list[BuildFolder]:
    """All folders that may belong to the project in ``source``, the likeliest first.  The usual one is always last."""
    presets = list(_presets(source))
    places = [source / USUAL, *_below(source / USUAL), *(preset.path for preset in presets), *_below(source)]
    places += _below(source.parent / USUAL)  # sysbuild: the build folder of the application around an image
    found: dict[Path, BuildFolder] = {}
    names = {preset.path: preset.preset for preset in presets}
    for place in places:
        if place not in found and (variables := _variables(place, source)) is not None:
            above = place.parent
            of_sysbuild = "APP_DIR" in _cache(above / CACHE)
            found[place] = BuildFolder(above if of_sysbuild else place, variables, names.get(place, ""), place)
    return [*found.values(), *(preset for preset in presets if preset.path not in found), BuildFolder(source / USUAL)]


def _below(folder: Path) -> list[Path]:
    return sorted(cache.parent for cache in folder.glob(f"*/{CACHE}"))


def _variables(folder: Path, source: Path) -> dict[str, str] | None:
    """The variables in the cache of ``folder``, or None if CMake has not configured ``source`` there."""
    variables = _cache(folder / CACHE)
    return variables if _same(variables.get("CMAKE_HOME_DIRECTORY", ""), source) else None


def _cache(file: Path) -> dict[str, str]:
    return read_cmake_cache(file, Diagnostics()) if is_file(file) else {}


def _same(folder: str, other: Path) -> bool:
    return bool(folder) and os.path.realpath(folder) == os.path.realpath(other)


def _presets(source: Path) -> Iterator[BuildFolder]:
    """The build folders of the configure presets in ``source``.

    Files and macros that cannot be read are skipped: CMake reports them.
    """
    presets: dict[str, dict[str, Any]] = {}
    for name in ("CMakePresets.json", "CMakeUserPresets.json"):
        try:
            data = json.loads((source / name).read_text(encoding="utf-8-sig"))
            presets.update({str(preset["name"]): preset for preset in data.get("configurePresets", [])})
        except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
            continue
    for name, preset in presets.items():
        folder = _inherited(preset, "binaryDir", presets)
        if not preset.get("hidden") and isinstance(folder, str):
            path = _expand(folder, source, name)
            if path is not None:
                yield BuildFolder(source / path, dict(_cache_variables(preset, presets, source, name)), name)


def _inherited(preset: Mapping[str, Any], key: str, presets: Mapping[str, Mapping[str, Any]], depth: int = 0) -> object:
    if key in preset or depth > 16:
        return preset.get(key)
    for parent in _parents(preset):
        found = _inherited(presets.get(parent, {}), key, presets, depth + 1)
        if found is not None:
            return found
    return None


def _cache_variables(
    preset: Mapping[str, Any], presets: Mapping[str, Mapping[str, Any]], source: Path, name: str, depth: int = 0
) -> dict[str, str]:
    found: dict[str, str] = {}
    for parent in reversed(_parents(preset)) if depth <= 16 else ():
        found |= _cache_variables(presets.get(parent, {}), presets, source, name, depth + 1)
    own = preset.get("cacheVariables")
    for variable, value in own.items() if isinstance(own, dict) else ():
        text = value.get("value") if isinstance(value, dict) else value
        text = ("TRUE" if text else "FALSE") if isinstance(text, bool) else text
        expanded = _expand(text, source, name) if isinstance(text, str) else None
        if expanded is not None:
            found[variable] = expanded
    return found


def _parents(preset: Mapping[str, Any]) -> list[str]:
    inherits = preset.get("inherits", [])
    return [inherits] if isinstance(inherits, str) else [name for name in inherits if isinstance(name, str)]


def _expand(text: str, source: Path, preset: str) -> str | None:
    """``text`` with the macros of cmake-presets(7) replaced, or None if it has a macro that is not known here."""
    values = {
        "sourceDir": source.as_posix(),
        "sourceParentDir": source.parent.as_posix(),
        "sourceDirName": source.name,
        "presetName": preset,
        "dollar": "$",
    }
    unknown = False

    def value(match: re.Match[str]) -> str:
        nonlocal unknown
        found = os.environ.get(match[2], "") if match[1] else values.get(match[2])
        unknown = unknown or found is None
        return found or ""

    replaced = re.sub(r"\$(p?env)?\{(\w+)\}", value, text)
    return None if unknown else replaced
