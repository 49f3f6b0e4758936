# SPDX-License-Identifier: Apache-2.0
"""Faults in words: the cause of a latched fault, and the next steps of the user.

The texts are data: ``targets/runtime/faults.yaml`` for the faults of the runtime, and the files of the component kinds
for their faults.

>>> found = Faults().explain({"enabled": "0", "fault": "gap", "component": "encoder_pan"})
>>> found.text
"Fault 'gap' of encoder_pan: more time has passed between two readings than 'max_speed' permits: counts can be lost."
"""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import data_folder, targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.items import text_of
from epg.generator.documents.yaml_file import load_yaml

FILE = data_folder("targets") / "runtime" / "faults.yaml"


class Fault(NamedTuple):
    """A latched fault: a sentence with its name, component and cause, and the next steps of the user."""

    text: str
    remedy: str


class Faults:
    """The faults of the runtime and of the component kinds in the folders of targets ``roots``."""

    def __init__(self, roots: Sequence[Path] = ()) -> None:
        self._roots = tuple(roots) or targets_roots()
        self._words: dict[str, tuple[str, str]] = {}
        self._lock = threading.Lock()

    def explain(self, state: Mapping[str, str]) -> Fault | None:
        """The fault of a state, which is the words of a line "state enabled=0 fault=gap"; None: there is none."""
        word = state.get("fault", "none")
        if word == "none":
            return None
        with self._lock:
            if not self._words:
                self._words = self._load()
        name = word.replace("_", " ")
        description, remedy = self._words.get(name, ("", ""))
        component = f" of {state['component']}" if state.get("component") else ""
        text = f"Fault '{name}'{component}{f': {description}' if description else ''}."
        remedy = remedy or "look at the component, and enable the target again"
        if setpoint := state.get("setpoint"):
            text += f" The setpoint {setpoint} is at its limit."
            remedy = f"send another setpoint, which does not press the axis against its end stop; otherwise {remedy}"
        return Fault(text, _sentence(remedy))

    def _load(self) -> dict[str, tuple[str, str]]:
        catalog = load_catalog([root for root in self._roots if root.is_dir()], Diagnostics())
        kinds = (catalog.find_kind(name) for name in catalog.kind_names())
        words = {fault.name: (fault.description, fault.remedy) for kind in kinds if kind for fault in kind.faults}
        return words | runtime_faults()


def runtime_faults() -> dict[str, tuple[str, str]]:
    """The description and the remedy of each fault of the runtime, by name."""
    diagnostics = Diagnostics()
    node = diagnostics.checked(load_yaml(FILE, diagnostics))
    return {name: (text_of(fault, "description"), text_of(fault, "remedy")) for name, fault in node.items()}


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."
