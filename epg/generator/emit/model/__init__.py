# SPDX-License-Identifier: Apache-2.0
"""The library of one model: a typed header, its implementation, and files that separate it from other models.

>>> # files = emit_model(model, "pan")           # {"pan.h": ..., "pan.c": ..., "pan_export.c": ...}
>>> # build = model_build(model, "pan")          # what to compile, and how

Names of generated files and symbols begin with the name of the library:

``<name>.h``, ``<name>.c``
    the interface, in which ports have names; compiled with the project's warnings
``<name>_export.h``, ``<name>_export.c`` or ``.cpp``
    access to the model's own code; compiled like that code, without warnings
``<name>_names.h``
    renames the global symbols of a C model; included before every file of the model
``<name>_copies/<file>``
    a copy of one of the model's files with other parameter values
``<name>_headers/``
    headers under the names by which the model includes them, and the headers of FMI
``<name>_fmu/``
    the unpacked sources of an FMU that is an archive
"""

from __future__ import annotations

from collections.abc import Mapping

from epg.generator.emit.model.render import render
from epg.generator.models.code import ModelBuild, ModelLibrary
from epg.generator.models.model import Model


def emit_model(
    model: Model,
    name: str,
    parameters: Mapping[str, float] | None = None,
    instances: int = 1,
    *,
    terminate: bool = True,
) -> dict[str, str]:
    """The generated files of ``model`` as the library ``name``: file name to text.

    ``parameters`` holds new values by the names of 20-sim.  They replace the exported values as if the model had been
    exported with them, so that the first initial equation already uses them.

    Without ``terminate``, the library lacks ``<name>_terminate()``, which a target never calls.

    ``name`` must be a C identifier.  Each name in ``parameters`` must be a parameter of the model.  ``instances`` must
    be 1 unless ``model.instantiable``.  Raises ValueError otherwise; callers must check before.
    """
    values = dict(parameters or {})
    unknown = sorted(values.keys() - {parameter.name for parameter in model.parameters})
    if unknown:
        raise ValueError(f"{model.name} has no parameter {unknown[0]!r}")
    if instances < 1 or (instances > 1 and not model.instantiable):
        raise ValueError(f"{model.name} cannot have {instances} instances")
    return render(ModelLibrary(model, name, values, instances, terminate))


def model_build(model: Model, name: str, parameters: Mapping[str, float] | None = None) -> ModelBuild:
    """How to compile the files that ``emit_model(model, name, parameters)`` returns."""
    suffix = "cpp" if model.language == "c++" else "c"
    frame = ModelBuild((f"{name}.c",), (f"{name}_export.{suffix}",), (), (), None, model.language)
    return model.code.build(ModelLibrary(model, name, parameters or {}), frame)
