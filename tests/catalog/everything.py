# SPDX-License-Identifier: Apache-2.0
"""Reads everything in a catalog, so that all mistakes in all its files are reported."""

from __future__ import annotations

from epg.generator.catalog.catalog import Catalog


def read_everything(catalog: Catalog) -> None:
    for category in ("component", "middleware", "platform"):
        read_with(catalog, category)


def read_with(catalog: Catalog, category: str) -> None:
    """Reads all items that may depend on a file of ``category``: all kinds, all middlewares, or all targets."""
    if category == "component":
        for name in catalog.kind_names():
            catalog.find_kind(name)
    elif category == "middleware":
        for name in catalog.names("middleware"):
            catalog.find_middleware(name)
    else:
        for name in catalog.target_names():
            catalog.find_target(name)
