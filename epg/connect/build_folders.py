# SPDX-License-Identifier: Apache-2.0
"""The build folders of a project: the existing ones, those of its CMake presets, and the usual one, ``build``."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import is_file
from epg.generator.tools.find_tool import read_cmake_cache

USUAL = "build"
CACHE = "CMakeCache.txt"


@dataclass(frozen=True)
class BuildFolder:
    """A build folder, and the preset ``preset`` that creates it.  ``board`` is Zephyr's board of a configured one.

    If Zephyr's sysbuild has built several images, ``path`` is the folder around them, as ``west build -d`` takes it.
    """

    path: Path
    board: str = ""
    preset: str = ""
    image: Path | None = None  # the folder that CMake has configured: ``path`` or, with sysbuild, a folder below it


def build_folders(source: Path) -> list[BuildFolder]:
    """All folders that may belong to the project in ``source``, the likeliest first.  The usual one is always last."""
    presets = list(_presets(source))
    places = [source / USUAL, *_below(source / USUAL), *(preset.path for preset in presets), *_below(source)]
    places += _below(source.parent / USUAL)  # sysbuild: the build folder of the application around an image
    folders: dict[Path, BuildFolder] = {}
    names = {preset.path: preset.preset for preset in presets}
    for place in places:
        variables = _cache(place / CACHE) if place not in folders else {}
        if _same(variables.get("CMAKE_HOME_DIRECTORY", ""), source):
            above = place.parent
            path = above if "APP_DIR" in _cache(above / CACHE) else place
            folders[place] = BuildFolder(path, variables.get("BOARD", ""), names.get(place, ""), place)
    return [
        *folders.values(),
        *(preset for preset in presets if preset.path not in folders),
        BuildFolder(source / USUAL),
    ]


def _below(folder: Path) -> list[Path]:
    return sorted(cache.parent for cache in folder.glob(f"*/{CACHE}"))


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
                yield BuildFolder(source / path, preset=name)


def _inherited(preset: Mapping[str, Any], key: str, presets: Mapping[str, Mapping[str, Any]], depth: int = 0) -> object:
    if key in preset or depth > 16:
        return preset.get(key)
    inherits = preset.get("inherits", [])
    for parent in [inherits] if isinstance(inherits, str) else inherits:
        value = _inherited(presets.get(str(parent), {}), key, presets, depth + 1)
        if value is not None:
            return value
    return None


def _expand(text: str, source: Path, preset: str) -> str | None:
    """``text`` with the macros of cmake-presets(7) replaced, or None if it has a macro that is not known here."""
    values = {
        "sourceDir": source.as_posix(),
        "sourceParentDir": source.parent.as_posix(),
        "sourceDirName": source.name,
        "presetName": preset,
        "dollar": "$",
    }
    try:
        return re.sub(
            r"\$(p?env)?\{(\w+)\}", lambda name: os.environ.get(name[2], "") if name[1] else values[name[2]], text
        )
    except KeyError:
        return None
