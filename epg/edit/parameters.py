# SPDX-License-Identifier: Apache-2.0
"""Writes values of the model's parameters into a bindings file.  All other text of the file stays as it was written.

>>> text = "version: 1\\nmodel: JIWY\\nparameters:\\n  Pan.PID.kp: {value: 2.6, maximum: 20}   # gain\\n"
>>> print(set_parameters(text, "jiwy.bindings.yaml", {"Pan\\\\PID\\\\kp": 2.2}), end="")
version: 1
model: JIWY
parameters:
  Pan.PID.kp: {value: 2.2, maximum: 20}   # gain
"""

from __future__ import annotations

from collections.abc import Mapping

from epg.edit.tcf import set_value
from epg.edit.yaml_edit import parse_map
from epg.generator.source import YamlNode

PARAMETERS = "parameters"


def parameter_path(root: YamlNode | None, name: str) -> tuple[str, ...]:
    """The keys of the value of a parameter in bindings, which can write ``.`` for ``\\``, and a map with limits."""
    section = root.get(PARAMETERS) if root is not None else None
    for key, node in section.items() if section is not None else ():
        if key.replace(".", "\\") == name.replace(".", "\\"):
            return (PARAMETERS, key, "value") if node.is_mapping else (PARAMETERS, key)
    return PARAMETERS, name


def set_parameters(text: str, file: str, values: Mapping[str, float]) -> str:
    """``text`` with these values.  Raises :class:`~epg.edit.yaml_edit.CannotEdit` as :func:`set_value` does."""
    for name, value in values.items():
        root = parse_map(text.removeprefix("\ufeff"), file)
        text = set_value(text, file, parameter_path(root, name), value)
    return text
