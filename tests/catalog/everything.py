# SPDX-License-Identifier: Apache-2.0
"""Reads everything in a catalog, so that all mistakes in all its files are reported."""

from __future__ import annotations

from epg.catalog.catalog import Catalog


def read_everything(catalog: Catalog) -> None:
    for name in catalog.kind_names():
        catalog.find_kind(name)
    for name in catalog.names("middleware"):
        catalog.find_middleware(name)
    for name in catalog.target_names():
        catalog.find_target(name)
