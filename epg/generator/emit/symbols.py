# SPDX-License-Identifier: Apache-2.0
"""The C symbols of components."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from jinja2 import Environment

from epg.generator.catalog.kind import TEMPLATE
from epg.generator.emit.text import Code, identifier
from epg.generator.resolve.application import Application

CONSTANTS = ("COMPONENT", "SETPOINT", "PUBLISHED", "SIGNAL", "FAULT")
"""The second words of the constants in ``<name>.h`` and ``<name>_app.c``: ``JIWY_COMPONENT_PWM_PAN``."""

TEMPLATES = Path(__file__).resolve().parent / "templates"


def component_symbols(app: Application, env: Environment) -> dict[str, Code]:
    """The C symbol of each component, by the component's name.

    The prefix ``app.name`` makes it different from names of the C library and symbols of other targets.  Kinds make
    further symbols by appending words (``<symbol>_config``).  Therefore it must not be the beginning of another
    component's name: a component ``motor_config`` would have the same symbol.
    """
    names = {component.name for component in app.components}
    beginnings = {c.name[: match.start()] for c in app.components for match in re.finditer("(?<=.)_", c.name)}
    taken = _words_of_templates(app, env)
    result = {}
    for component in app.components:
        symbol = component.name
        # The library of the model or of the plant, and the functions for the user's program, have any last words.
        of_others = f"{symbol}_".casefold().startswith(("model_", "plant_", "get_", "set_"))
        if of_others or symbol.startswith(tuple(f"{word}_" for word in CONSTANTS)):
            symbol = f"component_{symbol}"
        others = names - {component.name}
        while symbol in beginnings or symbol in others or f"{app.name}_{symbol}" in taken:
            symbol += "_component"
        result[component.name] = identifier(f"{app.name}_{symbol}")
    return result


def constants(app: Application, word: str, names: Sequence[str]) -> list[Code]:
    """C constants for ``names``: ``JIWY_COMPONENT_PWM_PAN``.  Names that differ only in case keep their case."""
    beginning = f"{app.name}_{word}".upper()
    kept = [re.sub(r"\W", "_", name) for name in names]
    counts = Counter(name.upper() for name in kept)
    result: dict[str, None] = {}  # a set that keeps its order
    for name in kept:
        constant = f"{beginning}_{name.upper() if counts[name.upper()] == 1 else name}"
        while constant in result:
            constant += "_"
        result[constant] = None
    return [identifier(constant) for constant in result]


def _words_of_templates(app: Application, env: Environment) -> set[str]:
    """All words in the templates of ``<name>.h`` and ``<name>_app.c``: more than the names that they define.

    A component ``values`` of a target ``parameter`` must not have the name of the static array ``parameter_values``.
    """
    kinds = {f"components/{component.kind.name}" for component in app.components}
    middlewares = {f"middlewares/{part.name}" for part in app.communication.middlewares if part.has_template}
    templates = [path.name for path in TEMPLATES.glob("*.j2")]
    templates += [f"{folder}/{TEMPLATE}" for folder in kinds | middlewares]
    assert env.loader is not None
    words: set[str] = set()
    for template in templates:
        source = env.loader.get_source(env, template)[0]
        words.update(re.findall(r"\w+", re.sub(r"\{\{ *(m\.)?prefix *\}\}", _PREFIX, source)))
    prefixes = (app.name, "middleware", "console")  # the latter two are values of MiddlewareView.prefix
    return {word.replace(_PREFIX, prefix) for word in words for prefix in prefixes}


_PREFIX = "0prefix0"
"""Stands for a prefix in the text of a template.  No word of C begins with a digit."""
