# SPDX-License-Identifier: Apache-2.0
"""The SDKs, compilers and programs that targets need: ``tools/<name>.json`` in the folders of targets.

The files are JSON because CMake reads them, too, and because ``epg doctor`` must work before any Python package is
installed.

>>> # tools = load_tools(targets_roots(), diagnostics)
>>> # tools["pico_sdk"].get["any"]  ->  git clone ...
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import field
from pathlib import Path
from typing import Any

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import read_text
from epg.generator.source import Span

_NUMBERS = r"(\d+(?:\.\d+)+)"


@dataclass(frozen=True)
class Tool:
    """A program or a folder.

    ``programs`` are the possible names of a program, the best first.  ``holds`` is a file by which the folder is
    recognized.  A project with one of the files ``in_project`` does not need the tool.  ``places`` are patterns of
    folders; ``cached`` is a pattern in EPG's cache.  ``tested`` is the version that EPG was tested with, ``oldest`` the
    oldest version that EPG accepts.  ``fetched`` is the address of the Git repository from which a build downloads the
    tool if it is missing.  ``get`` maps package managers, or ``any``, to the command that installs the tool;
    ``{cache}`` in it is replaced by EPG's cache.  ``optional`` is the reason why the tool may be missing.
    ``project_version`` is "required" or "preferred" if ``epg_use_versions()`` takes a version of the tool; if it is
    "required", another version is an error.
    """

    name: str
    title: str
    needed_for: str
    optional: str = ""
    programs: tuple[str, ...] = ()
    holds: str = ""
    in_project: tuple[str, ...] = ()
    variables: tuple[str, ...] = ()  # variables of CMake
    environment: tuple[str, ...] = ()
    places: tuple[str, ...] = ()
    registry: str = ""  # name in CMake's user package registry
    cached: str = ""
    oldest: str = ""
    tested: str = ""
    project_version: str = ""
    fetched: str = ""
    version_file: str = ""  # the file with the version of a folder; a program prints it with --version
    version_patterns: tuple[str, ...] = (_NUMBERS,)  # a regular expression for each part of the version
    get: Mapping[str, str] = field(default_factory=dict)


def load_tools(roots: Iterable[Path], diagnostics: Diagnostics) -> dict[str, Tool]:
    """All tools by name, in the order of their files.  If two have the same name, that of the first root is used."""
    tools: dict[str, Tool] = {}
    for root in roots:
        for path in sorted((root / "tools").glob("*.json")):
            tool = _load(path, diagnostics)
            if tool is not None:
                tools.setdefault(tool.name, tool)
    return tools


def _load(path: Path, diagnostics: Diagnostics) -> Tool | None:
    text = read_text(path, diagnostics)
    if text is None:
        return None
    try:
        return _tool(json.loads(text))
    except json.JSONDecodeError as error:
        span = Span(str(path), error.lineno, error.colno, error.colno + 1)
        diagnostics.error("wrong-value", span, f"this is not JSON: {error.msg}")
    except (KeyError, TypeError, ValueError, AttributeError, RecursionError, re.error):
        span = Span(str(path), 1, 1, 2)
        hint = "schemas/tool.schema.json describes the contents of such a file"
        diagnostics.error("wrong-value", span, "this does not describe a tool", hint=hint)
    return None


def _tool(data: Mapping[str, Any]) -> Tool:
    """The tool that a file describes.

    Raises KeyError, TypeError, ValueError, AttributeError or re.error if the data do not follow
    ``schemas/tool.schema.json``.
    """
    if data["api"] != 1 or bool(data.get("programs")) == bool(data.get("holds")):
        raise ValueError
    version = data.get("version", {})
    patterns = _texts(version.get("patterns", [_NUMBERS]))
    return Tool(
        name=_text(data["tool"]),
        title=_text(data["title"]),
        needed_for=_text(data["needed_for"]),
        optional=_text(data.get("optional", "")),
        programs=_texts(data.get("programs", [])),
        holds=_text(data.get("holds", "")),
        in_project=_texts(data.get("in_project", [])),
        variables=_texts(data.get("variables", [])),
        environment=_texts(data.get("environment", data.get("variables", []))),
        places=_texts(data.get("places", [])),
        registry=_text(data.get("registry", "")),
        cached=_text(data.get("cached", f"{data['tool']}-*")),
        oldest=_text(data.get("oldest", "")),
        tested=_text(data.get("tested", "")),
        project_version=_text(data.get("project_version", "")),
        fetched=_text(data.get("fetch", {}).get("git", "")),
        version_file=_text(version.get("file", "")),
        version_patterns=tuple(re.compile(pattern).pattern for pattern in patterns),
        get={_text(key): _text(command) for key, command in data["get"].items()},
    )


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError
    return value


def _texts(values: object) -> tuple[str, ...]:
    if not isinstance(values, list):
        raise TypeError
    return tuple(_text(value) for value in values)
