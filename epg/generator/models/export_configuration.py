# SPDX-License-Identifier: Apache-2.0
"""Reads types, sizes and descriptions of ports from ``ModelConfiguration.xml`` or an FMU's ``modelDescription.xml``.

Both files list variables in the order of their declarations.  This is not the order of ``u[]`` and ``y[]``: ports must
be found by their names only.
"""

from __future__ import annotations

import re
from functools import cached_property
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.xml_file import Element, load_xml
from epg.generator.models.folders import entries
from epg.generator.source import Span

_INDEX = r"[0-9]{1,9}"


@dataclass(frozen=True)
class ConfiguredPort:
    """A port as these files describe it.  For an FMU, ``array`` is empty and ``index`` is the value reference."""

    name: str
    direction: str  # "input" or "output"
    type: str  # "real", "integer" or "boolean"
    unit: str
    description: str
    array: str
    index: int
    span: Span


@dataclass(frozen=True)
class ExportConfiguration:
    """The data of one file.  ``step`` is a text in seconds, or empty."""

    path: Path
    step: str
    step_span: Span
    ports: tuple[ConfiguredPort, ...]

    @cached_property
    def _by_name(self) -> dict[tuple[str, str], ConfiguredPort]:
        return {(port.direction, port.name): port for port in reversed(self.ports)}

    def port(self, direction: str, name: str) -> ConfiguredPort | None:
        """The port called ``name``, or None."""
        return self._by_name.get((direction, name))


def find_configuration(directory: Path) -> Path | None:
    """The configuration in the folder of the sources or in its ``config``, or None.

    It is called ``ModelConfiguration.xml``, ``*.mcf`` or ``*.xxsim``.
    """
    for folder in (directory, directory / "config"):
        for file in entries(folder):
            named = file.name.lower() == "modelconfiguration.xml" or file.suffix.lower() in (".mcf", ".xxsim")
            if named and file.is_file():
                return file
    return None


def load_configuration(path: Path, diagnostics: Diagnostics) -> ExportConfiguration | None:
    """The configuration in ``path``.  None if it cannot be used; an unreadable file is reported as a warning."""
    root = load_xml(path, diagnostics, required=False)
    if root is None or root.name != "modelConfiguration":
        return None
    variables = root.find("modelVariables")
    ports = [_port(element) for element in (variables.children if variables else [])]
    step = root.find("run", "stepSize")
    return ExportConfiguration(
        path,
        root.text_of("run", "stepSize"),
        step.span if step else root.span,
        tuple(port for port in ports if port is not None),
    )


def load_model_description(path: Path, diagnostics: Diagnostics) -> ExportConfiguration | None:
    """The ports of an FMU 1.0 or 2.0.  None if ``path`` cannot be used; an unreadable file is reported as a warning."""
    root = load_xml(path, diagnostics, required=False)
    if root is None or root.name != "fmiModelDescription":
        return None
    variables = root.find("ModelVariables")
    experiment = root.find("DefaultExperiment")
    ports = []
    for element in variables.children if variables else []:
        direction = element.attributes.get("causality", "")
        reference = element.attributes.get("valueReference", "")
        if direction not in ("input", "output") or not re.fullmatch(_INDEX, reference):
            continue
        kind = element.children[0].name.lower() if element.children else "real"
        unit = element.children[0].attributes.get("unit", "") if element.children else ""
        name = element.attributes.get("name", "")
        description = element.attributes.get("description", "")
        ports.append(ConfiguredPort(name, direction, _type(kind), unit, description, "", int(reference), element.span))
    attributes = experiment.attributes if experiment else {}
    step_span = experiment.span if experiment else root.span
    return ExportConfiguration(path, attributes.get("stepSize", ""), step_span, tuple(ports))


def _port(element: Element) -> ConfiguredPort | None:
    direction = element.text_of("kind")
    if element.name != "modelVariable" or direction not in ("input", "output"):
        return None
    index = element.text_of("storage", "index")
    return ConfiguredPort(
        element.text_of("name"),
        direction,
        _type(element.text_of("type")),
        element.text_of("physical", "unit", "name"),
        element.text_of("description"),
        element.text_of("storage", "name"),
        int(index) if re.fullmatch(_INDEX, index) else -1,
        element.span,
    )


def _type(word: str) -> str:
    return word if word in ("integer", "boolean") else "real"
