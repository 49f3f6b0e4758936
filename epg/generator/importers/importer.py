# SPDX-License-Identifier: Apache-2.0
"""An importer: it recognises models of one format, and reads them.

EPG's own importers are the folders beside this file, in the table of ``__init__.py``.  An importer of a plug-in derives
from the same class.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.models.model import Model


@dataclass(frozen=True)
class FoundModel:
    """A model that was found.  The user can name ``file`` to choose it among several.

    ``load`` reads the model.  It returns None after reporting the reasons.
    """

    file: Path
    load: Callable[[Diagnostics], Model | None]


@dataclass(frozen=True)
class NearlyModel:
    """A reason why something is nearly a model: the end of a message, which begins with ``:``, and a hint."""

    reason: str
    hint: str


class Importer(ABC):
    """One format of models.

    ``rank`` decides between the formats in a folder: the importer with the highest rank gets it, and two models of one
    rank are an error that names both.  EPG's importers have the ranks 10 to 40; a plug-in's importer is asked only if
    none of these recognises a model.
    """

    rank: int

    @abstractmethod
    def find(self, folder: Path) -> list[FoundModel]:
        """The models whose main files are in ``folder`` itself, recognised by the contents of the files."""

    @abstractmethod
    def may_be(self, path: Path) -> bool:
        """True if a file has a name that the main file of such a model can have."""

    @abstractmethod
    def at(self, path: Path, diagnostics: Diagnostics) -> FoundModel | None:
        """The model of which ``path`` is the main file; None if it is not one.  Reports a file that cannot be read."""

    def considered(self, folder: Path) -> list[Path]:
        """The files that :meth:`find` reads: a change of one of them can change the model that is found."""
        return []

    def nearly(self, path: Path) -> NearlyModel | None:
        """Why a folder or file is nearly a model of this format; None if it is not."""
        return None
