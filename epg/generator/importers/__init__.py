# SPDX-License-Identifier: Apache-2.0
"""The importers of models, one folder for each format: how EPG recognises it, reads it, and calls its code.

>>> # model = load_model(Path("model"), diagnostics)
>>> # [port.name for port in model.inputs]
"""

from epg.generator.importers.recognise import load_model
from epg.generator.models.model import Model, Parameter, Port

__all__ = ["Model", "Parameter", "Port", "load_model"]
