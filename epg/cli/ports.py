# SPDX-License-Identifier: Apache-2.0
"""``epg ports``: lists the ports and parameters of a model."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from epg.cli.report import to_json
from epg.cli.table import table
from epg.generator.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("model", type=Path, metavar="MODEL", help="folder of the model")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.generator.importers import load_model

    model = diagnostics.checked(load_model(options.model, diagnostics))
    if options.json:
        data: dict[str, Any] = {
            "name": model.name,
            "origin": model.origin,
            "language": model.language,
            "version": model.version,
            "method": model.method,
            "step": float(model.step),
        }
        for key, ports in (("inputs", model.inputs), ("outputs", model.outputs)):
            data[key] = [
                {"name": p.name, "unit": p.unit, "type": p.type, "index": p.index, "description": p.description}
                for p in ports
            ]
        data["parameters"] = [{"name": p.name, "value": p.value, "unit": p.unit} for p in model.parameters]
        sys.stdout.write(to_json(data))
        return 0
    version = f" {model.version}" if model.version else ""
    method = f", {model.method}" if model.method else ""
    print(f"{model.name}: {model.origin}{version}, step {float(model.step):g} s{method}")
    rows = [("input", p.name, p.unit, p.type) for p in model.inputs]
    rows += [("output", p.name, p.unit, p.type) for p in model.outputs]
    print(table(("port", "name", "unit", "type"), rows))
    if model.parameters:
        print(table(("parameter", "value", "unit"), [(p.name, repr(p.value), p.unit) for p in model.parameters]))
    return 0
