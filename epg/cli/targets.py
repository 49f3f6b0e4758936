# SPDX-License-Identifier: Apache-2.0
"""``epg targets``: lists targets, component kinds and predefined ``.tcf`` files, including those of the user."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from epg.cli.arguments import user_roots
from epg.cli.report import to_json
from epg.cli.table import table
from epg.generator.diagnostics import Diagnostics

if TYPE_CHECKING:
    from epg.generator.catalog.catalog import Catalog
    from epg.generator.catalog.hardware import Computer
    from epg.generator.catalog.kind import Kind


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--kinds", action="store_true", help="list component kinds with their ports and parameters")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.generator.catalog.catalog import load_catalog
    from epg.generator.check.middleware import offered
    from epg.generator.data import targets_roots

    roots = targets_roots(user_roots())
    catalog = load_catalog(roots, diagnostics)
    targets = [target for name in catalog.target_names() if (target := catalog.find_target(name)) is not None]
    kinds = [kind for name in catalog.kind_names() if (kind := catalog.find_kind(name)) is not None]
    files = catalog.configuration_names()
    if options.json:
        data = {"targets": [_target(t, catalog) for t in targets], "kinds": [_kind(k) for k in kinds], "tcf": files}
        sys.stdout.write(to_json(data))
    elif options.kinds:
        print(table(("kind", "ports", "short description"), [(k.name, _ports(k), k.summary) for k in kinds]))
    else:
        rows = [
            (t.name, t.board.summary, t.platform.summary, ", ".join(offered(t, catalog)), _builds(t)) for t in targets
        ]
        print(table(("target", "board", "platform", "middlewares", "builds"), rows))
        print("\ncomponent kinds: " + ", ".join(k.name for k in kinds) + "   (epg targets --kinds)")
        print("predefined .tcf: " + ", ".join(files))
    return 0


def _target(target: Computer, catalog: Catalog) -> dict[str, Any]:
    from epg.generator.check.middleware import offered

    frequencies = {clock.name: clock.frequency for clock in target.clocks.values()}
    return {
        "name": target.name,
        "board": target.board.name,
        "platform": target.platform.name,
        "builds": target.platform.builds,
        "clocks": {name: None if value is None else float(value) for name, value in frequencies.items()},
        "middlewares": {name: list(transports) for name, transports in offered(target, catalog).items()},
    }


def _builds(target: Computer) -> str:
    return "yes" if target.platform.builds else "check only"


def _kind(kind: Kind) -> dict[str, Any]:
    ports = [
        {"name": kind.shown_port(port), "direction": port.direction, "unit": port.unit, "type": port.type}
        for port in kind.ports
    ]
    return {"name": kind.name, "summary": kind.summary, "ports": ports}


def _ports(kind: Kind) -> str:
    return ", ".join(f"{kind.shown_port(p)} ({p.direction}{', ' + p.unit if p.unit else ''})" for p in kind.ports)
