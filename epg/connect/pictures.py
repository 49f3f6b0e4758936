# SPDX-License-Identifier: Apache-2.0
"""Pictures of what a session shows, drawn when somebody asks for them."""

from __future__ import annotations

from epg.connect.loaded import Loaded
from epg.connect.view import pictures
from epg.emit.application import application_topics
from epg.graph.application import draw_application
from epg.graph.schedule import draw_schedule
from epg.graph.wiring import draw_wiring


def draw(loaded: Loaded, name: str, title: str) -> str | None:
    """The picture called ``name`` as SVG; None where there is no such picture, or it cannot be drawn now."""
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
    return draw_application(application, application_topics(application, loaded.request.roots), title)
