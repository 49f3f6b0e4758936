# SPDX-License-Identifier: Apache-2.0
"""``epg targets``: lists targets, component kinds and predefined ``.tcf`` files, including those of the user."""

from __future__ import annotations

import argparse
import sys

from epg.cli.arguments import user_roots
from epg.cli.report import to_json
from epg.cli.table import table
from epg.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--kinds", action="store_true", help="list component kinds with their ports and parameters")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.catalog.catalog import load_catalog
    from epg.check.middleware import offered
    from epg.data import targets_roots
    from epg.documents.tcf import predefined_tcf_names

    roots = targets_roots(user_roots())
    catalog = load_catalog(roots, diagnostics)
    targets = [target for name in catalog.target_names() if (target := catalog.find_target(name)) is not None]
    kinds = [kind for name in catalog.kind_names() if (kind := catalog.find_kind(name)) is not None]
    files = predefined_tcf_names(roots)
    if options.json:
        sys.stdout.write(
            to_json(
                {
                    "targets": [
                        {
                            "name": t.name,
                            "board": t.board.name,
                            "platform": t.platform.name,
                            "builds": t.platform.builds,
                            "clocks": {
                                clock.name: None if clock.frequency is None else float(clock.frequency)
                                for clock in t.clocks.values()
                            },
                            "middlewares": {name: list(transports) for name, transports in offered(t, catalog).items()},
                        }
                        for t in targets
                    ],
                    "kinds": [
                        {
                            "name": k.name,
                            "summary": k.summary,
                            "ports": [
                                {"name": k.shown_port(p), "direction": p.direction, "unit": p.unit, "type": p.type}
                                for p in k.ports
                            ],
                        }
                        for k in kinds
                    ],
                    "tcf": files,
                }
            )
        )
        return 0
    if options.kinds:
        rows = [
            (
                k.name,
                ", ".join(f"{k.shown_port(p)} ({p.direction}{', ' + p.unit if p.unit else ''})" for p in k.ports),
                k.summary,
            )
            for k in kinds
        ]
        print(table(("kind", "ports", "short description"), rows))
        return 0
    lines = [
        (
            t.name,
            t.board.summary,
            t.platform.summary,
            ", ".join(offered(t, catalog)),
            "yes" if t.platform.builds else "check only",
        )
        for t in targets
    ]
    print(table(("target", "board", "platform", "middlewares", "builds"), lines))
    print("\ncomponent kinds: " + ", ".join(k.name for k in kinds) + "   (epg targets --kinds)")
    print("predefined .tcf: " + ", ".join(files))
    return 0
