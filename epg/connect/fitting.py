# SPDX-License-Identifier: Apache-2.0
"""Which ends a wire can have without a word against it: what a page or a terminal offers first.

The wires themselves are judged by :mod:`epg.resolve.wires`; nothing is refused here.
"""

from __future__ import annotations

from epg.catalog.kind import KindPort
from epg.check.configuration import Component
from epg.models.model import Port
from epg.quantity import dimension_of, normal_unit
from epg.resolve.wires import component_steps


def fits(port: Port, component: Component, component_port: KindPort) -> bool:
    """Whether a port of the model and one of a component of its direction agree in type and unit, as they are."""
    if port.direction == "input" and component_port.type == "real" and port.type != "real":
        return False
    own, other = normal_unit(port.unit), component_steps(component, component_port)[1]
    if not own or not other or own == other:
        return True
    return dimension_of(own) is not None and dimension_of(own) == dimension_of(other)
