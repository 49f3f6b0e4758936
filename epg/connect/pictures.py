# SPDX-License-Identifier: Apache-2.0
"""Draws the pictures of a session on request."""

from __future__ import annotations

from epg.connect.loaded import Loaded
from epg.connect.pinout import draw_pinout
from epg.connect.view import pictures
from epg.generator.emit.application import Emitter
from epg.graph.application import draw_application
from epg.graph.schedule import draw_schedule


def draw(loaded: Loaded, name: str, title: str) -> str | None:
    """The picture ``name`` as SVG; None if there is no picture of that name, or it cannot be drawn now."""
    if not pictures(loaded).get(name):
        return None
    if name == "wiring":
        return draw_pinout(loaded, title)
    application = loaded.parts.application
    assert application is not None
    if name == "schedule":
        return draw_schedule(application, title)
    return draw_application(application, Emitter(application, loaded.request.roots).topics(), title)
