# SPDX-License-Identifier: Apache-2.0
"""Classes of messages for CycloneDDS, as ``epg record`` makes them."""

from __future__ import annotations

from types import SimpleNamespace

from epg.generator.diagnostics import Diagnostics
from epg.generator.messages.library import Library
from epg.generator.source import Span
from epg.ros.dds_types import dds_type


def _all() -> Library:
    library = Library()
    for name in library.names():
        assert library.load(name, Span(name), Diagnostics())
    return library


LIBRARY = _all()
TYPES = {name: dds_type(LIBRARY, name) for name in LIBRARY.names()}
msg = SimpleNamespace(**{name.rpartition("/")[2]: type for name, type in TYPES.items()})
