# SPDX-License-Identifier: Apache-2.0
"""Exports by EPG's own target for 20-sim, without 20-sim: EPG's templates, filled from the tokens of a model."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from tests.doubles.twenty_sim.expander import Target, read_targets, read_tokens
from tests.doubles.twenty_sim.exports import STATES, Export

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "integration/20-sim/EPG"

#: Tokens about people, licences, computers and time: no output may contain them.
PERSONAL = {
    "USER_NAME": 'Jane Doe */ "]]> & <b>%USER_NAME%</b>',
    "COMPANY_NAME": "20-sim 5.1 Classroom License (Doe's), do not copy",
    "MODEL_FILE": "C:\\Users\\jane.doe\\My Models\\new\\u0041 (x86)\\Servo & arm 100%.emx",
    "EXPERIMENT_NAME": "\\\\server\\jane.doe\\home\\run 1",
    "GENERATION_DIR": "C:\\Users\\jane.doe\\My Exports & more\\Servo (1)",
    "GENERATION_DATE": "June 19, 2018 (Doe)",
    "GENERATION_TIME": "2:04:27 PM Doe time",
    "20SIM_DIR": "C:\\Program Files (x86)\\20-sim 5.1 of Doe\\",
    "TEMPLATE_DIR": "C:\\Users\\jane.doe\\EPG\\.",
    "TEMPLATEDIR": "C:\\Users\\jane.doe\\EPG\\.",
    "MODEL_NAME": "Doe's model",
    "MODEL_DESCRIPTION": "by Jane Doe",
}


def targets() -> dict[str, Target]:
    return read_targets(FOLDER / "Targets.ini")


def generate(tokens: Mapping[str, str], output: Path, target: str = "EPG", configuration: str = "") -> Path:
    """The export by ``target``, in ``output``; without ModelConfiguration.xml if ``configuration`` is empty."""
    targets()[target].generate(tokens, output, configuration)
    if not configuration:
        (output / "ModelConfiguration.xml").unlink()
    return output


def generate_from(tokens_file: Path, output: Path, target: str = "EPG") -> Path:
    return generate(read_tokens(tokens_file), output, target)


def tokens_of(export: Export) -> dict[str, str]:
    """All tokens that EPG's templates use, in the form of 20-sim, for one of the tests' small models."""
    with tempfile.TemporaryDirectory() as folder:
        tokens = read_tokens(replace(export, rename={}, newline="\n").write_tokens(Path(folder)) / "tokens.xml")
    groups = {
        "INPUT": [name for name, _ in export.inputs],
        "OUTPUT": [name for name, _ in export.outputs],
        "PARAMETER": [name for name, _, _ in export.parameters],
    }
    for kind, names in groups.items():
        strings = [f'\t"{name}"' for name in (text.replace("\\", "\\\\") for text in names)]
        tokens[f"{kind}_NAMES"] = ",\n".join(strings) + "\n" if strings else "\tNULL"
    for kind, vector, ports in (("INPUT", "u", export.inputs), ("OUTPUT", "y", export.outputs)):
        units = [f" {{{unit}}}" if unit else "" for _, unit in ports]
        told = [f"{name}{unit}" for (name, _), unit in zip(ports, units, strict=True)]
        tokens[f"INITIALIZE_{kind}S"] = "".join(f"\t{vector}[{i}] = 0.0;\t\t/* {t} */\n" for i, t in enumerate(told))
        tokens[f"{kind}_UNITS"] = "".join(f"{unit}\n" for _, unit in ports)
    tokens["PARAMETER_VALUES"] = "".join(f"{value}\n" for _, value, _ in export.parameters)
    tokens["XX_CONSTANT_ARRAY_NAME"], tokens["XX_UNNAMED_ARRAY_NAME"] = "C", "U"
    assert tokens["NUMBER_STATES"] == str(STATES)
    return {**PERSONAL, **tokens}


def write_by_template(export: Export, folder: Path) -> Path:
    """The export of one of the tests' small models by EPG's target."""
    return generate(tokens_of(export), folder)
