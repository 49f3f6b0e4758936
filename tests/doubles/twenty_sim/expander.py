# SPDX-License-Identifier: Apache-2.0
"""Fills templates for 20-sim's C-code generation as 20-sim does, from the tokens of a model.

The language, as in public templates and exports:

``%NAME%``
    the token's value; unchanged if there is no such token (``%PATH%`` of a batch file)
``%IF%%NAME%`` ... ``%ELSE%`` ... ``%ENDIF%``
    can be nested; false are 0, an empty value, and a missing token
``%IF%%OR(A,B)%``, ``AND``, ``NOT(...)``, ``EQ(NAME,text)``, ``NEQ(NAME,text)``
    spaces after the comma are allowed
a line that contains only such marks
    is removed with its line end

``Targets.ini`` is not an INI file for Python's ConfigParser: keys repeat, and a section is a plain list.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

_MARK = re.compile(r"%(?:IF%%(?P<condition>[A-Za-z0-9_]+(?:\([^%\n]*\))?)|ELSE|ENDIF)%")
_TOKEN = re.compile(r"%([A-Za-z0-9_]+)%")
_CALL = re.compile(r"([A-Z]+)\((.*)\)")
NEW_LINES = {"0": "\r\n", "1": "\r", "2": "\n"}


@dataclass
class Target:
    """One section of ``Targets.ini``."""

    name: str
    folder: Path
    keys: dict[str, list[str]] = field(default_factory=dict)
    tokens: dict[str, str] = field(default_factory=dict)

    def value(self, key: str, default: str = "") -> str:
        return self.keys.get(key, [default])[-1].strip('"')

    @property
    def files(self) -> list[str]:
        return [name.strip().strip('"') for text in self.keys.get("templateFiles", []) for name in text.split(";")]

    def generate(self, tokens: Mapping[str, str], output: Path, configuration: str = "") -> list[Path]:
        """Writes the files of this target for the model of ``tokens`` into ``output``; returns their paths."""
        values = {**tokens, **self.tokens, "TEMPLATENAME": self.name}
        values.setdefault("GENERATION_DIR", str(output))
        values["MODEL_CONFIGURATION"] = configuration
        values["TOKENS"] = tokens_xml(values)
        written = []
        output.mkdir(parents=True, exist_ok=True)
        for name in self.files:
            template = (self.folder / name.replace("\\", "/")).read_bytes().decode().replace("\r\n", "\n")
            path = output / expand(name, values).replace("\\", "/")
            path.parent.mkdir(parents=True, exist_ok=True)
            text = expand(template, {**values, "FILE_NAME": path.name})
            newline = NEW_LINES[self.value("newLineCharacter", "0")]
            path.write_bytes(text.replace("\r\n", "\n").replace("\n", newline).encode())
            written.append(path)
        return written


def read_targets(path: Path) -> dict[str, Target]:
    """The targets of a ``Targets.ini`` by the name of their section, in the order of the list ``[targets]``."""
    listed: list[str] = []
    sections: dict[str, Target] = {}
    section = ""
    for line in path.read_text(encoding="utf-8").splitlines():
        line = line.strip()
        if not line or line.startswith(";"):
            continue
        if line.startswith("["):
            section = line.strip("[]")
            if section != "targets":
                sections[section] = Target(section, path.parent)
        elif section == "targets":
            listed.append(line)
        else:
            key, equals, value = line.partition("=")
            assert equals, f"neither a key nor a section: {line}"
            if key.startswith("%"):
                sections[section].tokens[key.strip("%")] = value
            else:
                sections[section].keys.setdefault(key, []).append(value)
    return {name: sections[name] for name in listed}


def read_tokens(path: Path) -> dict[str, str]:
    """The tokens in a ``tokens.xml`` of 20-sim."""
    return {token.attrib["name"]: token.text or "" for token in ElementTree.parse(path).getroot().iter("token")}


def tokens_xml(tokens: Mapping[str, str]) -> str:
    lines = [f'\t<token name="{name}"><![CDATA[{value}]]></token>\n' for name, value in tokens.items()]
    return f"<tokens>\n{''.join(lines)}</tokens>"


def expand(template: str, tokens: Mapping[str, str]) -> str:
    """20-sim's text for ``template``.  Raises ValueError if marks do not pair."""
    kept: list[str] = []
    open_marks: list[bool] = []  # for each open IF: whether its present branch is kept
    at = 0
    for start, end, mark in _marks(template):
        if all(open_marks):
            kept.append(template[at:start])
        at = end
        if mark["condition"] is not None:
            open_marks.append(_holds(mark["condition"], tokens))
        elif not open_marks:
            raise ValueError(f"{mark[0]} without %IF%")
        elif mark[0] == "%ELSE%":
            open_marks[-1] = not open_marks[-1]
        else:
            open_marks.pop()
    if open_marks:
        raise ValueError("%IF% without %ENDIF%")
    kept.append(template[at:])
    return _TOKEN.sub(lambda match: tokens.get(match[1], match[0]), "".join(kept))


def _marks(template: str) -> list[tuple[int, int, re.Match[str]]]:
    """Every mark with the range that it removes: the whole line if there is no other text in it."""
    result = []
    for match in _MARK.finditer(template):
        start, end = match.span()
        line_start = template.rfind("\n", 0, start) + 1
        line_end = template.find("\n", end)
        line_end = len(template) if line_end < 0 else line_end + 1
        if not _MARK.sub("", template[line_start:line_end]).strip():
            previous = result[-1][1] if result else 0
            start, end = max(line_start, previous), end if _MARK.search(template, end, line_end) else line_end
        result.append((start, end, match))
    return result


def _holds(condition: str, tokens: Mapping[str, str]) -> bool:
    call = _CALL.fullmatch(condition)
    if call is None:
        return tokens.get(condition, "").strip() not in ("", "0", "XXFALSE")
    function, text = call.groups()
    if function == "NOT":
        return not _holds(text.strip(), tokens)
    first, _, second = (part.strip() for part in text.partition(","))
    if function in ("EQ", "NEQ"):
        return (tokens.get(first, "").strip() == second) == (function == "EQ")
    if function in ("OR", "AND"):
        sides = _holds(first, tokens), _holds(second, tokens)
        return any(sides) if function == "OR" else all(sides)
    raise ValueError(f"unknown function {function}")
