# SPDX-License-Identifier: Apache-2.0
"""What the schema of middlewares cannot say: that their options make sense, and that platforms can carry them."""

from __future__ import annotations

from collections.abc import Iterable

from epg.catalog.catalog import Catalog
from epg.catalog.hardware import Target
from epg.catalog.middleware import Middleware
from epg.check.compose import parameter_problems
from epg.diagnostics import Diagnostics, Note, did_you_mean
from epg.documents.items import map_of, texts_of
from epg.documents.schema import extended_from
from epg.source import Node

COMMON_OPTIONS = ("middleware", "transport", "period", "domain", "diagnostics", "console", "usb")
"""Keys of ``communication`` that do not depend on the middleware."""


def check_middleware(node: Node, diagnostics: Diagnostics) -> None:
    """A middleware in itself."""
    options = map_of(node, "options")
    for name, option in options.items():
        span = node["options"].key_span(name)
        if name in COMMON_OPTIONS:
            message = f"'{name}' is a key that every 'communication' has"
            diagnostics.error("invalid-name", span, message, hint="choose another name for the option")
        parameter_problems(name, option, span, diagnostics)
    if "capture" in texts_of(node, "uses"):
        size = options.get("capture")
        if size is None or "type" not in size or size["type"].value != "integer" or "default" not in size:
            message = "a middleware that uses 'capture' has an option 'capture'"
            hint = "capture: {type: integer, minimum: 0, default: 2048, description: numbers a recording can hold}"
            diagnostics.error("missing-key", node.key_span("uses"), message, hint=hint)
    if node["connection"].value != "none" and "driver" not in node and not _unfinished(node):
        message = "a middleware that connects to something has a 'driver'"
        hint = "name its epg_middleware_t: 'driver: {symbol: ...}'; or write 'builds: false'"
        diagnostics.error("missing-key", node["middleware"].span, message, hint=hint)


def check_offers(target: Target, catalog: Catalog, diagnostics: Diagnostics) -> None:
    """Whatever a platform offers in ``middlewares`` exists."""
    offered = target.platform.node["middlewares"]
    known = catalog.names("middleware")
    for name in target.platform.middlewares:
        if name not in known:
            hint = did_you_mean(name, known, "in middlewares/")
            message = f"there is no middleware '{name}'"
            diagnostics.error("unknown-middleware", offered.key_span(name), message, hint=hint)


def offered(target: Target, catalog: Catalog) -> dict[str, tuple[str, ...]]:
    """Middlewares of a target with their transports: those its platform names, then those that name the platform."""
    result = dict(target.platform.middlewares)
    for name in catalog.names("middleware"):
        middleware = catalog.find_middleware(name) if name not in result else None
        if middleware is not None and target.platform.name in middleware.platforms:
            result[name] = middleware.platforms[target.platform.name]
    return result


def unoffered_hint(name: str, possible: Iterable[str], catalog: Catalog) -> str:
    """What to write instead of a middleware that is not among the ``possible`` ones of a target."""
    middleware = catalog.find_middleware(name) if name in catalog.names("middleware") else None
    if middleware is None or not middleware.platforms:
        return did_you_mean(name, possible, "it has")
    return f"it has: {', '.join(sorted(possible))}; '{name}' runs on: {', '.join(sorted(middleware.platforms))}"


def check_offer(target: Target, middleware: Middleware, diagnostics: Diagnostics) -> None:
    """Transports are named for middlewares only that use one."""
    transports = target.platform.node.get("middlewares", middleware.name)
    if transports is None:
        transports = middleware.node["platforms"][target.platform.name]
    if middleware.connection != "stream" and transports.elements():
        message = f"middleware '{middleware.name}' uses no transport"
        notes = [Note("this middleware", middleware.span)]
        hint = f"write '{middleware.name}: []'"
        diagnostics.error("wrong-value", transports.span, message, hint=hint, notes=notes)


def _unfinished(node: Node) -> bool:
    return "builds" in node and node["builds"].value is False


def check_lack(target: Target | None, transport: str | None, where: Node, diagnostics: Diagnostics) -> None:
    """Reports a transport that the target's platform has on other boards."""
    if target is not None and transport is not None and transport in target.board.lacks:
        message = f"{target.board.name} has no transport '{transport}': {target.board.lacks[transport]}"
        hint = "name a component that carries bytes, such as a uart, in 'transport', or write 'middleware: none'"
        diagnostics.error("unknown-transport", where.span, message, hint=hint, notes=extended_from(where))
