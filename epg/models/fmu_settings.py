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

from epg.documents.text_file import is_file
from epg.models.fmu import load_fmu
from epg.models.fmu_files import SUFFIX, is_fmu_folder
from epg.models.fmu_sources import is_definition, is_identifier
from epg.models.model import Model
from epg.models.model_yaml import ModelYaml

_KEYS = ("version", "description", "fmu", "step", "heap", "definitions")
_SIZE = re.compile(r"\s*(\d{1,9})\s*(B|KiB|MiB)\s*", re.ASCII)
_UNITS = {"B": 1, "KiB": 1 << 10, "MiB": 1 << 20}
_LARGEST_HEAP = 64 << 20


class FmuSettings(ModelYaml):
    """Reads a ``model.yaml`` with the key ``fmu``."""

    def load(self) -> Model | None:
        if not self._begin(_KEYS, ("version",)):
            return None
        before = self.diagnostics.error_count
        step = self._step()
        heap = self._heap()
        definitions = self._definitions()
        name = self._text("fmu")
        if not name:
            return None
        path = self.path.parent / name
        if not (is_file(path) and path.suffix.lower() == SUFFIX) and not is_fmu_folder(path):
            message = f"'{name}' is neither an .fmu nor the folder of one"
            hint = "name the file, or the folder with its modelDescription.xml, relative to this file"
            self._error("file-not-found", self.node["fmu"].span, message, hint)
        if self.diagnostics.error_count > before:
            return None
        node = self.node.get("step")
        span = node.span if node is not None else None
        return load_fmu(
            path,
            self.diagnostics,
            step=step,
            step_span=span,
            heap=heap,
            definitions=definitions,
            beside=self.path,
        )

    def _definitions(self) -> tuple[tuple[str, str], ...]:
        """The macros for the FMU's sources, with their values."""
        node = self.node.get("definitions")
        if node is None:
            return ()
        if not node.is_mapping:
            hint = "write for example {FMI_COSIMULATION: 1}"
            self._error("wrong-type", node.span, "'definitions' is a map of macros and their values", hint)
            return ()
        found = []
        for name, value in node.items():
            text = "" if value.value is None else str(value.value)
            if not is_identifier(name):
                self._error("invalid-name", node.key_span(name), f"'{name}' is not a C identifier", "it names a macro")
            elif not isinstance(value.value, (str, int, float, type(None))) or isinstance(value.value, bool):
                self._error("wrong-type", value.span, f"'{name}' must be a number or text", "put it into quotes")
            elif not is_definition(text):
                self._error("wrong-value", value.span, f"'{name}' cannot have this value", "it stands on one line of C")
            else:
                found.append((name, text))
        return tuple(found)

    def _heap(self) -> int | None:
        """The size of the heap in bytes, or None if the file does not set it."""
        node = self.node.get("heap")
        if node is None:
            return None
        match = _SIZE.fullmatch(node.value) if isinstance(node.value, str) else None
        size = int(match[1]) * _UNITS[match[2]] if match else 0
        if match is None:
            self._error("wrong-unit", node.span, "'heap' is a size in B, KiB or MiB", "write for example '4 KiB'")
        elif not 64 <= size <= _LARGEST_HEAP:
            self._error("out-of-range", node.span, "the heap must be from 64 B to 64 MiB", "write for example '4 KiB'")
        return size
