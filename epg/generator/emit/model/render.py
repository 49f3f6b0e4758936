# SPDX-License-Identifier: Apache-2.0
"""Renders the templates of a model's library."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import jinja2

from epg.generator.emit.template import environment
from epg.generator.emit.text import Code, comment
from epg.generator.models.code import ModelLibrary
from epg.generator.models.model import Parameter, Port


def render(library: ModelLibrary) -> dict[str, str]:
    """The text of all files of the library, by file name."""
    model, name, code = library.model, library.name, library.model.code
    variables: dict[str, Any] = {
        "model": model,
        "name": Code(name),
        "instances": library.instances,
        "parameters": list(zip(parameter_constants(name, model.parameters), model.parameters)),
        "tunable": sum(parameter.tunable for parameter in model.parameters),
        "terminate": library.terminate,
        "in_order": all(parameter.index == index for index, parameter in enumerate(model.parameters)),
        "e": code,
        "derives": code.derives,
        "direct": code.writes_every_output,
        "limited": code.limits_values(model),
        "cpp": model.language == "c++",
        "about": code.about(model),
        "on_end": Code(code.on_end),
        "on_stop": Code(code.on_stop),
        "finite_while": Code(code.finite_while),
    }
    env = _environment(code.templates)

    def fill(template: str, **more: Any) -> str:
        return env.get_template(template).render(variables | more)

    frame = {f"{name}.h": "header.h.j2", f"{name}.c": "wrapper.c.j2", f"{name}_export.h": "export.h.j2"}
    return {file: fill(template) for file, template in frame.items()} | code.files(library, fill)


_PUBLIC = """t inputs inputs_t outputs outputs_t parameter parameter_t instance init step terminate stopped finite
get_parameter set_parameter set_parameters heap_used clamped""".split()
"""The parts after ``<name>_`` in the names of the types and functions of a library."""


def parameter_constants(name: str, parameters: Sequence[Parameter]) -> list[str]:
    """The names of the parameters in the C enumeration: ``PAN_PID1_KP``.

    Parameters whose names differ only in case keep their case: ``PAN_Kp``, ``PAN_KP``.
    """
    upper = [f"{name}_{parameter.identifier}".upper() for parameter in parameters]
    reserved = {
        f"{name}_{word}".upper()
        for word in ("h", "step_size", "instances", "parameters", "heap_size", "export_h", "names_h")
    }
    # A library named in capitals: PAN_step() is a function, and the parameters can be called "step" and "STEP".
    reserved |= {f"{name}_{word}" for word in _PUBLIC}
    result: dict[str, None] = {}  # a set that keeps its order
    counts = Counter(upper)
    for constant, parameter in zip(upper, parameters, strict=True):
        unique = constant if counts[constant] == 1 else f"{name.upper()}_{parameter.identifier}"
        while unique in reserved or unique in result:
            unique += "_"
        result[unique] = None
    return list(result)


@cache
def _environment(own: Path) -> jinja2.Environment:
    """The environment of the templates in the importer's folder, and of those for all importers."""
    env = environment([own.resolve(), Path(__file__).resolve().parent / "templates"])
    env.filters["parsed"] = Code  # text that EPG's parsers took from a C source: it is C already
    env.filters["told"] = _told
    env.filters["last_name"] = lambda text: str(text).rpartition("::")[2].removeprefix("struct ")
    return env


def _told(item: Port | Parameter) -> Code:
    """The text about a port or parameter in a C comment: ``in {rad}``."""
    unit = f" {{{item.unit}}}" if item.unit else ""
    kind = f", {item.type}" if isinstance(item, Port) and item.type != "real" else ""
    told = f": {item.description}" if isinstance(item, Port) and item.description else ""
    value = f" = {item.value!r}" if isinstance(item, Parameter) else ""
    return comment(f"{item.name}{unit}{kind}{value}{told}")
