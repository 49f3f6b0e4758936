# SPDX-License-Identifier: Apache-2.0
"""The conversion that a component states, and the component ports that fit a model port in type and unit.

Nothing is refused here: :mod:`epg.generator.resolve.wires` checks the wires, and :mod:`epg.generator.resolve.matching`
proposes them.
"""

from __future__ import annotations

from fractions import Fraction

from epg.generator.catalog.kind import KindPort
from epg.generator.check.bindings import Conversion
from epg.generator.check.configuration import Component
from epg.generator.models.model import Port
from epg.generator.quantity import conversion_factor, dimension_of, normal_unit
from epg.generator.resolve.application import ConversionStep


def fits(port: Port, component: Component, component_port: KindPort, *, plant: bool = False) -> bool:
    """True if a model port and a component port of the matching direction agree in type and in the dimension of units.

    A real value does not fit an input of another type.  A port without a unit fits every unit.  A duty has no unit, so
    a port with a unit does not fit it, unless the component states a conversion.  With ``plant``, the port belongs to
    the simulated robot, to which the conversion of the component does not apply.
    """
    if port.direction == "input" and component_port.type == "real" and port.type != "real":
        return False
    if not plant and is_share_with_unit(port.unit, component, component_port):
        return False
    own = normal_unit(port.unit)
    other = normal_unit(component_port.unit) if plant else component_steps(component, component_port)[1]
    if not own or not other or own == other:
        return True
    return dimension_of(own) is not None and dimension_of(own) == dimension_of(other)


def component_steps(component: Component, port: KindPort) -> tuple[list[ConversionStep], str]:
    """The conversion that the component itself states, and the unit on its model side (empty: unknown)."""
    conversion = component.conversion
    unit = normal_unit(port.unit)
    steps: list[ConversionStep] = []
    if not port.default and port.type == "boolean":
        return steps, unit  # The conversion of a component applies to its main value, not to boolean ports beside it.
    given = normal_unit(conversion.unit) if conversion.unit is not None else ""
    if conversion.scale is None and given and unit and given != unit and dimension_of(given) == dimension_of(unit):
        steps.append(ConversionStep(scale=conversion_factor(unit, given), reason=f"{unit} -> {given}"))
    steps += stated_step(conversion, f"components.{component.name}")
    return steps, given or ("" if conversion.scale is not None else unit)


def is_share_with_unit(unit: str, component: Component, port: KindPort) -> bool:
    """True if a value with a unit is given to a port that takes a share, from -1 to 1, without a conversion."""
    return port.drive and bool(normal_unit(unit)) and not component_steps(component, port)[0]


def stated_step(conversion: Conversion, reason: str) -> list[ConversionStep]:
    """The step with the scale, the offset and the limits that a wire or a component states; none without them."""
    if conversion.scale is None and conversion.offset is None and conversion.limits is None:
        return []
    return [ConversionStep(conversion.scale or Fraction(1), conversion.offset or 0.0, conversion.limits, reason)]
