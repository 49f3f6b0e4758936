# SPDX-License-Identifier: Apache-2.0
"""Models: exports of 20-sim, FMUs, and controllers written by hand.

>>> # model = load_model(Path("model"), diagnostics)
>>> # [port.name for port in model.inputs]
"""

from epg.models.model import Model, Parameter, Port
from epg.models.recognise import load_model

__all__ = ["Model", "Parameter", "Port", "load_model"]
