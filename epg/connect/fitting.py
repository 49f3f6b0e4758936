# SPDX-License-Identifier: Apache-2.0
"""Finds the component ports that fit a model port in type and unit.  The page and the terminal offer them first.

Nothing is refused here: :mod:`epg.resolve.wires` checks the wires.
"""

from __future__ import annotations

from epg.catalog.kind import KindPort
from epg.check.configuration import Component
from epg.models.model import Port
from epg.quantity import dimension_of, normal_unit
from epg.resolve.wires import component_steps, is_share_with_unit


def fits(port: Port, component: Component, component_port: KindPort) -> bool:
    """True if a model port and a component port of the matching direction agree in type and in the dimension of units.

    A real value does not fit an input of another type.  A port without a unit fits every unit.  A duty has no unit, so
    a port with a unit does not fit it, unless the component states a conversion.
    """
    if port.direction == "input" and component_port.type == "real" and port.type != "real":
        return False
    if is_share_with_unit(port.unit, component, component_port):
        return False
    own, other = normal_unit(port.unit), component_steps(component, component_port)[1]
    if not own or not other or own == other:
        return True
    return dimension_of(own) is not None and dimension_of(own) == dimension_of(other)
