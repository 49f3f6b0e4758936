# SPDX-License-Identifier: Apache-2.0
"""Checks the options of middlewares and the lists of middlewares in platforms, which their schemas cannot check."""

from __future__ import annotations

from collections.abc import Sequence

from epg.generator.catalog.hardware import Computer
from epg.generator.catalog.parameter import parameter_problems
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.items import map_of, texts_of
from epg.generator.source import YamlNode

COMMON_OPTIONS = ("middleware", "transport", "period", "domain", "diagnostics", "parameters", "console", "usb")
"""Keys of ``communication`` that do not depend on the middleware."""


def check_middleware(node: YamlNode, diagnostics: Diagnostics) -> None:
    """Reports the mistakes in the file of a middleware."""
    options = map_of(node, "options")
    for name, option in options.items():
        span = node["options"].key_span(name)
        if name in COMMON_OPTIONS:
            message = f"'{name}' is a key that every 'communication' has"
            diagnostics.error("invalid-name", span, message, hint="choose another name for the option")
        parameter_problems(name, option, span, diagnostics)
    if "services" in texts_of(node, "uses") and "node" not in texts_of(node, "uses"):
        message = "a middleware that uses 'services' must use 'node', too"
        diagnostics.error("missing-key", node.key_span("uses"), message, hint="add 'node' to 'uses'")
    if "capture" in texts_of(node, "uses"):
        size = options.get("capture")
        if size is None or "type" not in size or size["type"].value != "integer":
            message = "a middleware that uses 'capture' must have an option 'capture'"
            hint = "add 'capture: {type: integer, minimum: 0, description: size of a recording}'"
            diagnostics.error("missing-key", node.key_span("uses"), message, hint=hint)
    if node["connection"].value != "none" and "driver" not in node and not _unfinished(node):
        message = "a middleware that connects to something must have a 'driver'"
        hint = "write 'driver: {symbol: ...}' with the name of its epg_middleware_t, or 'builds: false'"
        diagnostics.error("missing-key", node["middleware"].span, message, hint=hint)


def check_offers(target: Computer, known: Sequence[str], diagnostics: Diagnostics) -> None:
    """Reports names in ``middlewares`` of a platform that are not among the ``known`` middlewares."""
    offered = target.platform.offers["middlewares"]
    for name in target.platform.middlewares:
        span, message = offered.key_span(name), f"there is no middleware '{name}'"
        diagnostics.known_or_error("unknown-middleware", span, message, name, known, "in middlewares/")


def _unfinished(node: YamlNode) -> bool:
    return "builds" in node and node["builds"].value is False
