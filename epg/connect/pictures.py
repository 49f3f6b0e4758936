# SPDX-License-Identifier: Apache-2.0
"""Draws the pictures of a session on request."""

from __future__ import annotations

from epg.connect.loaded import Loaded
from epg.connect.view import pictures
from epg.emit.application import Emitter
from epg.graph.application import draw_application
from epg.graph.schedule import draw_schedule
from epg.graph.wiring import draw_wiring


def draw(loaded: Loaded, name: str, title: str) -> str | None:
    """The picture ``name`` as SVG; None if there is no picture of that name, or it cannot be drawn now."""
    if not pictures(loaded).get(name):
        return None
    if name == "wiring":
        configuration = loaded.parts.configuration
        assert configuration is not None
        return draw_wiring(configuration.target, configuration.components, loaded.hardware, title)
    application = loaded.parts.application
    assert application is not None
    if name == "schedule":
        return draw_schedule(application, title)
    return draw_application(application, Emitter(application, loaded.request.roots).topics(), title)
