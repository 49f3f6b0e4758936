# SPDX-License-Identifier: Apache-2.0
"""The library of one model: a typed header, its implementation, and what keeps the model apart from others.

>>> # files = emit_model(model, "pan")           # {"pan.h": ..., "pan.c": ..., "pan_export.c": ...}
>>> # build = model_build(model, "pan")          # what to compile, and how

Names of generated files and symbols begin with the name of the library:

``<name>.h``, ``<name>.c``
    the interface, and ports by name; compiled with the project's warnings
``<name>_export.h``, ``<name>_export.c`` or ``.cpp``
    access to the model's own code; compiled with it, without warnings
``<name>_names.h``
    renames the global symbols of a C model; included before every file of the model
``<name>_copies/<file>``
    a copy of one of the model's files with other parameter values
``<name>_headers/``
    headers the model includes under a name of another case, and those of FMI
``<name>_fmu/``
    the sources of an FMU that is an archive
"""

from __future__ import annotations

from collections.abc import Mapping

from epg.emit.model.build import ModelBuild, model_build
from epg.emit.model.copies import copies, shims
from epg.emit.model.render import render
from epg.models.model import Model

__all__ = ["ModelBuild", "emit_model", "model_build"]


def emit_model(
    model: Model, name: str, parameters: Mapping[str, float] | None = None, instances: int = 1
) -> dict[str, str]:
    """The generated files of ``model`` as library ``name``: file name to text.

    ``parameters`` replaces exported values by their 20-sim names, as if the model had been exported with these: they
    act from the first initial equation on.  ``name`` must be a C identifier and ``parameters`` hold names of the model
    only; ``instances`` is 1 unless ``model.instantiable``.  Raises ValueError otherwise: callers check first.
    """
    values = dict(parameters or {})
    unknown = sorted(values.keys() - {parameter.name for parameter in model.parameters})
    if unknown:
        raise ValueError(f"{model.name} has no parameter {unknown[0]!r}")
    if instances < 1 or (instances > 1 and not model.instantiable):
        raise ValueError(f"{model.name} cannot have {instances} instances")
    files = render(model, name, values, instances)
    files |= copies(model, name, values)
    files |= shims(model, name)
    return files
