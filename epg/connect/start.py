# SPDX-License-Identifier: Apache-2.0
"""The state of a session for a model without a project, until the user has chosen a target."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from epg.connect.creation import proposal
from epg.connect.files import Watch
from epg.connect.loaded import files_of_model
from epg.connect.view import diagnostic_view, model_view
from epg.generator.catalog.catalog import Catalog
from epg.generator.diagnostics import Diagnostics
from epg.generator.importers import load_model


class Start:
    """The model at ``path``.  It is read again when its files change."""

    def __init__(self, path: Path, catalog: Catalog) -> None:
        self.path = path
        self._create = proposal(path, catalog)
        self._load()

    def look(self) -> bool:
        """Reads the model again if its files have changed.  Returns True if they have."""
        changed = bool(self._watch.changed())
        if changed:
            self._load()
        return changed

    def show(self) -> dict[str, Any]:
        """The state without a project: values that belong to a project are left out."""
        model = self.model
        return {
            "phase": "choose",
            "project": None,
            "create": self._create,
            "model": model_view(model) if model is not None else None,
            "diagnostics": [diagnostic_view(problem) for problem in self._problems],
        }

    def _load(self) -> None:
        self._problems = Diagnostics()
        self.model = load_model(self.path, self._problems)
        self._watch = Watch(files_of_model(self.path, self.model))
