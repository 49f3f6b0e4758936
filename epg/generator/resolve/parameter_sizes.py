# SPDX-License-Identifier: Apache-2.0
"""The sizes of ROS 2 messages about parameters as CDR, in bytes.

Each number is aligned to its own size, at most 8 bytes.  The sizes here count the padding in the worst case.
"""

from __future__ import annotations

from fractions import Fraction

from epg.generator.check.configuration import Configuration
from epg.generator.check.names import ros_parameter_name
from epg.generator.diagnostics import Diagnostics
from epg.generator.resolve.parameters import RosParameters

_PREFIXES = 256
"""For a request to list parameters, which can name prefixes."""
LARGEST_SHARE = Fraction(1, 16)
"""The largest share of a chip's memory that parameters of a ROS 2 node get without being asked for."""

_COUNT = 4
_VALUE = 2 + 6 + 8 + 8 + 8 + 5 * 4
"""rcl_interfaces/msg/ParameterValue of a double: type, bool, integer, double, an empty text, five empty sequences."""
_STATE = 32
"""What the node and its store keep for each parameter, rounded up from JIWY's."""
_EVENT = 8 + 4 + 192 + 3 + 3 * _COUNT + 8
"""rcl_interfaces/msg/ParameterEvent without parameters: stamp, longest name of a node, three sequences, padding."""


def request_size(parameters: RosParameters) -> int:
    """The largest request that a target must take: one that sets all its parameters, as `ros2 param load` sends it."""
    return max(_PREFIXES, _COUNT + sum(_parameter(name) for name in _names(parameters)))


def names_size(parameters: RosParameters) -> int:
    """The largest request that reads parameters by name: one with all names, as `ros2 param dump` sends it."""
    return max(_PREFIXES, _COUNT + sum(_text(name) for name in _names(parameters)))


def event_size(parameters: RosParameters | None) -> int:
    """A message about one changed parameter.  Several changes use the room of the node's largest message."""
    return _EVENT + max((_parameter(name) for name in _names(parameters)), default=0) if parameters else 0


def parameters_fit(parameters: RosParameters, configuration: Configuration, diagnostics: Diagnostics) -> bool:
    """Whether the node of a target serves ``parameters``.

    If the ``.tcf`` does not say so, their memory must not be more than :data:`LARGEST_SHARE` of the chip's.  Reports a
    warning if it is.
    """
    memory = configuration.target.soc.memory
    needed = request_size(parameters) + names_size(parameters) + _STATE * len(parameters.parameters)
    communication = configuration.communication
    if communication.parameters or memory is None or needed <= memory * LARGEST_SHARE:
        return True
    message = f"the ROS 2 node does not serve the model's parameters: {len(parameters.parameters)} would take about "
    message += f"{needed / 1024:.1f} of {memory / 1024:.0f} KiB of {configuration.target.soc.title}"
    hint = "write 'parameters: true' in 'communication' to serve them all the same, or 'parameters: false'"
    diagnostics.warning("parameters-left-out", communication.span, message, hint=hint)
    return False


def _names(parameters: RosParameters) -> list[str]:
    return [ros_parameter_name(parameter.name) for parameter in parameters.parameters]


def _text(text: str) -> int:
    """A text with its length, its zero, and the padding before what follows."""
    return 4 + (len(text) + 1 + 3) // 4 * 4


def _parameter(name: str) -> int:
    return _text(name) + _VALUE
