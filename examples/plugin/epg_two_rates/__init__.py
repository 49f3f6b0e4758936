# SPDX-License-Identifier: Apache-2.0
"""An importer of controllers with two rates: a file ``<name>.rates`` beside a C source.

>>> # fast: position_loop                      a function that runs in each step
>>> # slow: {function: trajectory, every: 10}  a function that runs before it in every tenth step
>>> # step: 1 ms
>>> # source: controller.c
>>> # inputs: {angle: int16}                   global variables of the source, with their types
>>> # outputs: {duty: double}
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.schema import quantity_of
from epg.generator.documents.yaml_file import load_yaml
from epg.generator.importers.importer import FoundModel, Importer
from epg.generator.models.code import ModelBuild, ModelCode, ModelLibrary, Render
from epg.generator.models.model import Model, Port
from epg.generator.source import YamlNode

TARGETS = Path(__file__).parent / "targets"
KEYS = ("fast", "slow", "step", "source", "inputs", "outputs")
TYPES = ("double", "int16")


@dataclass(frozen=True)
class TwoRates(ModelCode):
    """The functions of such a controller.  The library renames its global symbols, so that several can be linked."""

    fast: str
    slow: str
    every: int  # steps
    source: Path
    symbols: tuple[str, ...]

    templates = Path(__file__).parent
    alone = "keeps its state in global variables"

    @property
    def instantiable(self) -> bool:
        return False

    def files(self, library: ModelLibrary, render: Render) -> dict[str, str]:
        name = library.name
        return {
            f"{name}_export.c": render("two_rates.c.j2"),
            f"{name}_names.h": render("names.h.j2", renames=self.symbols),
        }

    def build(self, library: ModelLibrary, frame: ModelBuild) -> ModelBuild:
        return replace(frame, exported=(self.source,), forced_header=f"{library.name}_names.h")

    def limits_values(self, model: Model) -> bool:
        return True

    def about(self, model: Model) -> str:
        return f"Two rates: {self.slow}() runs in every {self.every}th step."


class TwoRatesImporter(Importer):
    """Files with the suffix ``.rates``."""

    rank = 10

    def find(self, folder: Path) -> list[FoundModel]:
        return [FoundModel(file, partial(_load, file)) for file in sorted(folder.glob("*.rates"))]

    def may_be(self, path: Path) -> bool:
        return path.suffix == ".rates"

    def at(self, path: Path, diagnostics: Diagnostics) -> FoundModel | None:
        return FoundModel(path, partial(_load, path))


def _load(path: Path, diagnostics: Diagnostics) -> Model | None:
    """The model that a file describes; None after reporting its mistakes."""
    node = load_yaml(path, diagnostics)
    if node is None:
        return None
    for key in KEYS:
        if key not in node:
            diagnostics.error("two-rates-key", node.span, f"the key '{key}' is missing", hint=f"add '{key}:'")
            return None
    step = quantity_of(node["step"], "time", diagnostics)
    inputs, outputs = (_ports(node[f"{each}s"], each, diagnostics) for each in ("input", "output"))
    if step is None or inputs is None or outputs is None:
        return None
    fast, slow = str(node["fast"].value), str(node["slow"]["function"].value)
    source = path.parent / str(node["source"].value)
    return Model(
        name=path.stem,
        origin="two rates",
        language="c",
        version="",
        method="",
        step=Fraction(step),
        inputs=inputs,
        outputs=outputs,
        parameters=(),
        directory=path.parent,
        files=(path, source),
        span=node.span,
        code=TwoRates(
            fast,
            slow,
            int(str(node["slow"]["every"].value)),
            source,
            (fast, slow, *(port.name for port in (*inputs, *outputs))),
        ),
    )


def _ports(node: YamlNode, direction: str, diagnostics: Diagnostics) -> tuple[Port, ...] | None:
    """The ports of one direction.  Their values are numbers; the code holds those of an int16 as whole numbers."""
    ports = []
    for index, (name, type) in enumerate(node.items()):
        if type.value not in TYPES:
            message = f"the type of '{name}' must be double or int16, not '{type.value}'"
            diagnostics.error("two-rates-type", type.span, message)
            return None
        ports.append(Port(name, name, direction, "", "real", index, type.span, whole=type.value == "int16"))
    return tuple(ports)


IMPORTER = TwoRatesImporter()
