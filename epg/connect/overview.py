# SPDX-License-Identifier: Apache-2.0
"""A system as the page and the terminal show it: its targets, connections and messages, as plain data.

The messages are those of ``epg check``.  Targets are listed even if they, or their connections, have mistakes.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from epg.connect.files import Watch
from epg.connect.json_data import Data
from epg.connect.loaded import Loaded, Models, files_of_model, load
from epg.connect.view import diagnostic_view
from epg.generator.catalog.catalog import Catalog
from epg.generator.diagnostics import Diagnostic, Diagnostics
from epg.generator.quantity import show
from epg.system.check_system import CheckedSystem, check_whole
from epg.system.load_system import parse_system
from epg.system.loader import Loader
from epg.system.picture import draw_system
from epg.system.system import Connection, End, System, SystemPlant

NO_CHANGES = {
    "changed": False,
    "can_undo": False,
    "can_redo": False,
    "diff": "",
    "conflict": None,
    "external": None,
}
"""The draft of a system: its file is changed in an editor only."""


class Overview:
    """The system in the file ``path``.  It is read again when one of its files changes."""

    def __init__(self, path: Path, user_roots: Sequence[Path]) -> None:
        self.path = path
        self._user_roots = tuple(user_roots)
        self._models = Models()
        self.load()

    def look(self) -> bool:
        """Reads all files again if one has changed.  Returns True if one has."""
        changed = bool(self._watch.changed())
        if changed:
            self.load()
        return changed

    @property
    def name(self) -> str:
        return self.system.name if self.system is not None else self.path.name

    def load(self) -> None:
        """Reads the system and all files of its targets."""
        self._problems = Diagnostics()
        self.system = parse_system(self.path, self._problems)
        is_right = not self._problems.has_errors
        loader = Loader(self._user_roots, self._problems, self._models.read)
        self._targets = self._load_targets(loader.catalog) if self.system is not None else {}
        applications = {
            name: loaded.parts.application
            for name, loaded in self._targets.items()
            if loaded.parts.application is not None
        }
        self._checked: CheckedSystem | None = None
        if self.system is not None and is_right:
            self._checked = check_whole(self.system, loader, applications, self._problems)
        plant = self.system.plant if self.system is not None else None
        files = {self.path, *(file for loaded in self._targets.values() for file in loaded.files())}
        self._watch = Watch(files if plant is None else {*files, plant.bindings, *self._files_of(plant, loader)})

    def picture(self) -> str | None:
        """The picture of ``epg graph`` as SVG; None while there are errors that prevent it."""
        return draw_system(self._checked) if self._checked is not None else None

    def show(self) -> Data:
        """The state of a session while no target of the system is open."""
        system = self.system
        return {
            "phase": "system",
            "project": {
                "name": self.name,
                "folder": str(self.path.parent),
                "files": {"system": self.path.name},
                "system": self.name,
            },
            "create": None,
            "model": None,
            "system": None if system is None else self._view(system),
            "diagnostics": [
                {**diagnostic_view(problem), "targets": self._targets_of(problem)} for problem in self._problems
            ],
            "pictures": {"system": self._checked is not None},
            "draft": NO_CHANGES,
        }

    def _load_targets(self, catalog: Catalog) -> dict[str, Loaded]:
        assert self.system is not None
        targets = {
            name: load(self.system.request(target, self._user_roots), self._models, catalog)
            for name, target in self.system.targets.items()
        }
        if not self._problems.has_errors:  # else a connection that the file has wrong could be missing in its targets
            for loaded in targets.values():
                self._problems.add_all(loaded.diagnostics)
        return targets

    def _files_of(self, plant: SystemPlant, loader: Loader) -> list[Path]:
        return list(files_of_model(plant.model, loader.model(plant.model, Diagnostics())))

    def _targets_of(self, problem: Diagnostic) -> list[str]:
        """The targets whose files have the problem; none for a problem of the system as a whole."""
        return [name for name, loaded in self._targets.items() if problem in loaded.diagnostics]

    def _view(self, system: System) -> Data:
        checked = self._checked
        return {
            "name": system.name,
            "targets": [self._target(name) for name in system.targets],
            "connections": [self._connection(system, connection) for connection in system.connections],
            "world": [{**_end(end), "topic": system.topic(end)} for end in system.world],
            "loops": [str(loop) for loop in checked.loops] if checked is not None else [],
            "plant": None if system.plant is None else self._plant(system.plant),
        }

    def _target(self, name: str) -> Data:
        loaded = self._targets[name]
        configuration, model = loaded.parts.configuration, loaded.parts.model
        period = configuration.control.period if configuration is not None else None
        period = period or (model.step if model is not None else None)
        return {
            "name": name,
            "target": configuration.target.name if configuration is not None else "",
            "middleware": configuration.communication.middleware.name if configuration is not None else "",
            "period": show(period, "time") if period else "",
            "model": model.name if model is not None else "",
        }

    def _connection(self, system: System, connection: Connection) -> Data:
        """A connection.  The texts about its message are empty as long as errors prevent them."""
        links = self._checked.links if self._checked is not None else ()
        link = next((link for link in links if link.connection is connection), None)
        return {
            "from": _end(connection.sender),
            "to": _end(connection.receiver),
            "topic": system.topic(connection.sender),
            "message": link.message if link is not None else "",
            "unit": link.unit if link is not None else "",
            "sent": link.sent if link is not None else "",
            "age": show(link.age, "time") if link is not None else "",
        }

    def _plant(self, plant: SystemPlant) -> Data:
        checked = self._checked
        known = checked.plant if checked is not None else None
        return {
            "name": known.model.name if known is not None else plant.model.name,
            "step": show(known.model.step, "time") if known is not None else "",
            "wires": dict(checked.plant_wires) if checked is not None else {},
        }


def _end(end: End) -> Data:
    return {"target": end.target, "component": end.component, "port": end.port}
