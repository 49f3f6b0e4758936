# SPDX-License-Identifier: Apache-2.0
"""``epg rates``: prints how often the functions of a controller with two rates run."""

from __future__ import annotations

import argparse
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.importers import load_model
from epg_two_rates import TwoRates

SUMMARY = "print how often the functions of a controller with two rates run"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("model", type=Path, help="folder of the model, or its .rates file")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    model = diagnostics.checked(load_model(options.model, diagnostics))
    if isinstance(model.code, TwoRates):
        print(f"{model.code.fast}: {1 / model.step} Hz, {model.code.slow}: {1 / (model.step * model.code.every)} Hz")
    return 0
