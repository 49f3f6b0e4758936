# SPDX-License-Identifier: Apache-2.0
"""Loads the targets of a system: files that several targets share are read once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import field
from functools import cached_property
from pathlib import Path

from epg.generator.catalog.catalog import Catalog, load_catalog
from epg.generator.catalog.platform import Family
from epg.generator.data import targets_roots
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.importers import load_model
from epg.generator.models.model import Model
from epg.generator.project import ModelReader, Request, load_parts
from epg.generator.resolve.application import Application


@dataclass
class Loader:
    """Has the catalog of the user's folders of targets ``user_roots``, and each model that was read."""

    user_roots: Sequence[Path]
    diagnostics: Diagnostics
    read_model: ModelReader = load_model
    _models: dict[Path, Model | None] = field(default_factory=dict)

    @property
    def roots(self) -> tuple[Path, ...]:
        return targets_roots(self.user_roots)

    @cached_property
    def catalog(self) -> Catalog:
        return load_catalog(self.roots, self.diagnostics)

    def family(self, name: str) -> Family | None:
        """The family of chips ``name``, or None if it has no port layer."""
        return self.catalog.find_family(name)

    def applications(self, requests: Iterable[tuple[str, Request]]) -> dict[str, Application]:
        """The applications of requests, by the names that are given with them.

        Reports the mistakes in all files, and leaves out targets that have mistakes.
        """
        loaded = {
            name: load_parts(request, self.diagnostics, self.model, self.catalog).application
            for name, request in requests
        }
        return {name: application for name, application in loaded.items() if application is not None}

    def model(self, path: Path, diagnostics: Diagnostics) -> Model | None:
        """The model in ``path``, which is read once; None after reporting mistakes."""
        if path not in self._models:
            self._models[path] = self.read_model(path, diagnostics)
        return self._models[path]
