# SPDX-License-Identifier: Apache-2.0
"""Reads the ``model.yaml`` of an FMU, which names the FMU and replaces or adds settings of it.

>>> # version: 1
>>> # fmu: servo.fmu
>>> # step: 1 ms
>>> # heap: 4 KiB
>>> # definitions: {FMI_COSIMULATION: 1}
"""

from __future__ import annotations

import re
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import is_file
from epg.generator.importers.by_hand.model_yaml import step_of
from epg.generator.importers.fmu.fmu import HEAP, FmuSettings, load_fmu
from epg.generator.importers.fmu.fmu_files import SUFFIX, is_fmu_folder
from epg.generator.importers.fmu.fmu_sources import is_definition
from epg.generator.models.model import Model
from epg.generator.source import YamlNode

_UNITS = {"B": 1, "KiB": 1 << 10, "MiB": 1 << 20}
_LARGEST_HEAP = 64 << 20


def load_fmu_settings(path: Path, node: YamlNode, diagnostics: Diagnostics) -> Model | None:
    """The FMU that a ``model.yaml`` with the key ``fmu`` names.  None after an error.  ``node`` fits its schema."""
    before = diagnostics.error_count
    written = node.get("step")
    step = step_of(written, diagnostics) if written is not None else None
    heap = _heap(node.get("heap"), diagnostics)
    definitions = _definitions(node.get("definitions"), diagnostics)
    name = str(node["fmu"].value)
    fmu = path.parent / name
    if not (is_file(fmu) and fmu.suffix.lower() == SUFFIX) and not is_fmu_folder(fmu):
        message = f"'{name}' is not an .fmu file or the folder of an FMU"
        hint = "name the file, or the folder with its modelDescription.xml, relative to this file"
        diagnostics.error("file-not-found", node["fmu"].span, message, hint=hint)
    if diagnostics.error_count > before:
        return None
    step_span = written.span if written is not None else None
    return load_fmu(fmu, diagnostics, FmuSettings(step, step_span, heap, definitions, path))


def _definitions(node: YamlNode | None, diagnostics: Diagnostics) -> tuple[tuple[str, str], ...]:
    """The macros for the FMU's sources, with their values."""
    definitions = {}
    for name, value in node.items() if node is not None else ():
        definitions[name] = "" if value.value is None else str(value.value)
        if not is_definition(definitions[name]):
            message = f"'{name}' cannot have this value"
            diagnostics.error("wrong-value", value.span, message, hint="the value must fit in one line of C")
    return tuple(definitions.items())


def _heap(node: YamlNode | None, diagnostics: Diagnostics) -> int:
    """The size of the heap in bytes."""
    if node is None:
        return HEAP
    number, unit = re.findall(r"\d+|[A-Za-z]+", str(node.value))
    size = int(number) * _UNITS[unit]
    if not 64 <= size <= _LARGEST_HEAP:
        message = "the heap must be from 64 B to 64 MiB"
        diagnostics.error("out-of-range", node.span, message, hint="write for example '4 KiB'")
    return size
