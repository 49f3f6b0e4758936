# SPDX-License-Identifier: Apache-2.0
"""The middlewares and transports that a target can have, and checks of the ones that it names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from epg.generator.catalog.catalog import Catalog, Computer
from epg.generator.catalog.middleware import Middleware
from epg.generator.correction import correction
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.documents.items import texts_of
from epg.generator.documents.schema import extended_from
from epg.generator.source import YamlNode


def offered(target: Computer, catalog: Catalog) -> dict[str, tuple[str, ...]]:
    """The possible middlewares of a target, with their transports.

    First the middlewares that the platform names, then those whose own file names the platform and the family of chips.
    """
    result = dict(target.platform.middlewares)
    for name in catalog.names("middleware"):
        middleware = catalog.find_middleware(name) if name not in result else None
        if middleware is not None and target.platform.name in middleware.platforms and _supports(middleware, target):
            result[name] = middleware.platforms[target.platform.name]
    return result


def _supports(middleware: Middleware, target: Computer) -> bool:
    family = target.platform.family
    return family is None or not middleware.families or family.name in middleware.families


def first_middleware(target: Computer, catalog: Catalog) -> str:
    """The name of the first middleware of the platform that can be built; "none" if there is no other."""
    found = (catalog.find_middleware(name) for name in target.platform.middlewares)
    good = (middleware.name for middleware in found if middleware is not None and middleware.builds)
    return next((name for name in good if name != "none"), "none")


def unoffered_hint(name: str, possible: Iterable[str], catalog: Catalog) -> str:
    """The hint for a middleware ``name`` that is not among the ``possible`` ones of a target."""
    possible = sorted(possible)
    meant = sorted(_meant(name, catalog), key=lambda each: each.name not in possible)
    if len(meant) > 1:
        parts = [f"'{each.name}' is {each.summary.partition(';')[0]}" for each in meant]
        absent = [", but this target does not have it" if each.name not in possible else "" for each in meant]
        return "; ".join(part + end for part, end in zip(parts, absent, strict=True))
    middleware = meant[0] if meant else None
    if middleware is not None and middleware.name in possible:
        return correction(name, middleware.name, "write '{}'")
    if middleware is None or not middleware.platforms:
        return did_you_mean(name, possible, "it has")
    chips = f" (chips: {', '.join(middleware.families)})" if middleware.families else ""
    runs_on = f"{', '.join(sorted(middleware.platforms))}{chips}"
    return f"it has: {', '.join(possible)}; '{middleware.name}' runs on: {runs_on}"


def _meant(name: str, catalog: Catalog) -> list[Middleware]:
    """The middleware ``name``, or those that users also call by this name."""
    word = name.casefold().replace("-", "_")
    found = [each for known in catalog.names("middleware") if (each := catalog.find_middleware(known)) is not None]
    own = [each for each in found if each.name == name]
    return own or [each for each in found if word in (each.name, *texts_of(each.node, "also"))]


def needs_component(middleware: Middleware, target: Computer, own: Sequence[str]) -> bool:
    """True if only a component can carry the bytes of ``middleware``: the port layer has no transport of its own."""
    return middleware.connection == "stream" and target.platform.family is not None and not own


def check_offer(target: Computer, middleware: Middleware, diagnostics: Diagnostics) -> None:
    """Reports a platform that names transports for a middleware that does not use one."""
    transports = target.platform.offers.get("middlewares", middleware.name)
    if transports is None:
        transports = middleware.node["platforms"][target.platform.name]
    if middleware.connection != "stream" and transports.elements():
        message = f"middleware '{middleware.name}' does not use a transport"
        notes = [Note("the middleware", middleware.span)]
        hint = f"write '{middleware.name}: []'"
        diagnostics.error("wrong-value", transports.span, message, hint=hint, notes=notes)


def check_lack(target: Computer | None, transport: str | None, where: YamlNode, diagnostics: Diagnostics) -> None:
    """Reports a transport that the platform has on other boards, but not on the board of this target."""
    if target is not None and transport is not None and transport in target.board.lacks:
        message = f"{target.board.name} has no transport '{transport}': {target.board.lacks[transport]}"
        hint = "name a component that carries bytes, such as a uart, in 'transport', or write 'middleware: none'"
        diagnostics.error("unknown-transport", where.span, message, hint=hint, notes=extended_from(where))
