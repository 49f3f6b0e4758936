# SPDX-License-Identifier: Apache-2.0
"""The common part of all kinds of ``model.yaml``: version, step, check of keys, reports of mistakes."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from epg.diagnostics import Diagnostics, did_you_mean
from epg.documents.yaml_file import VERSION, newer_version
from epg.models.assignments import is_step
from epg.quantity import QuantityError, parse_quantity
from epg.source import Span, YamlNode

FILE_NAME = "model.yaml"


class ModelYaml:
    """Reads one ``model.yaml``."""

    def __init__(self, path: Path, node: YamlNode, diagnostics: Diagnostics) -> None:
        self.path = path
        self.node = node
        self.diagnostics = diagnostics

    def _begin(self, keys: tuple[str, ...], required: tuple[str, ...]) -> bool:
        """True if the file is a map of this version.  Also reports keys that are unknown or missing."""
        if not self.node.is_mapping:
            hint = "it begins with 'version: 1'"
            self._error("wrong-type", self.node.span, "a model.yaml is a map (key: value)", hint)
            return False
        if not self._version():
            return False
        self._known_keys(self.node, keys, "")
        for key in required:
            if key not in self.node:
                self._error("missing-key", Span(str(self.path), 1, 1, 2), f"'{key}' is missing", "")
        return True

    def _version(self) -> bool:
        node = self.node.get("version")
        if node is None or (node.value == VERSION and not isinstance(node.value, bool)):
            return True
        if not newer_version(self.node, "version", self.diagnostics):
            self._error("wrong-value", node.span, f"expected version {VERSION}", f"write 'version: {VERSION}'")
        return False

    def _step(self) -> Fraction | None:
        node = self.node.get("step")
        if node is None:
            return None
        try:
            value = parse_quantity(node.value, "time")
        except QuantityError as problem:
            self._error(
                "wrong-unit" if "unit" in str(problem) else "wrong-quantity", node.span, str(problem), problem.hint
            )
            return None
        step = Fraction(value)
        if not is_step(step):
            words = "must be more than 0" if step <= 0 else "must be from 1 ns to 1000000 s"
            self._error("out-of-range", node.span, f"the step {words}", "write for example '1 ms'")
            return None
        return step

    def _text(self, key: str) -> str:
        node = self.node.get(key)
        if node is None:
            return ""
        if not isinstance(node.value, str) or not node.value.strip():
            self._error("wrong-type", node.span, f"'{key}' must be text", "")
            return ""
        return node.value

    def _known_keys(self, node: YamlNode, keys: tuple[str, ...], where: str) -> None:
        for key, _ in node.items():
            if key not in keys:
                hint = did_you_mean(key, keys, "known keys")
                self._error("unknown-key", node.key_span(key), f"unknown key '{key}'{where}", hint)

    def _error(self, id: str, span: Span, message: str, hint: str) -> None:
        self.diagnostics.error(id, span, message, hint=hint)
