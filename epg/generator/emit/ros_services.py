# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 services of an application, for ``templates/ros_services.c.j2``.

A middleware serves them if its ``uses`` names ``services``.  Other middlewares have none.
"""

from __future__ import annotations

from collections.abc import Iterator

from epg.generator.dataclass import dataclass
from epg.generator.emit.text import Code
from epg.generator.resolve.application import Application
from epg.generator.resolve.parameter_sizes import names_size, request_size
from epg.generator.resolve.parameters import RosParameters

_EMPTY = 8
"""Bytes for the request of a service of std_srvs, whose content is one byte at most, with padding."""


@dataclass(frozen=True)
class RosService:
    """A service of the node.

    ``kind`` is the name of its ``epg_service_kind_t`` in C, and ``request`` the size in bytes of the largest request.
    """

    name: str
    kind: Code
    request: int


def ros_services_of(app: Application) -> tuple[RosService, ...]:
    """The services of ``app`` in the order of their numbers.

    A target whose topic for enabling is switched off has no service for it either.
    """
    if "services" not in app.communication.middleware.uses:
        return ()
    enable = [topic.name for topic in app.subscriptions if topic.role == "enable"]
    return (
        *(RosService(name, Code("epg_service_enable"), _EMPTY) for name in enable),
        RosService("~/reset", Code("epg_service_reset"), _EMPTY),
        *(_parameter_services(app.ros_parameters) if app.ros_parameters else ()),
    )


def _parameter_services(parameters: RosParameters) -> Iterator[RosService]:
    limit = parameters.request
    names, values = (
        size if limit is None else min(size, limit) for size in (names_size(parameters), request_size(parameters))
    )
    for name, size in (
        ("list_parameters", names),
        ("get_parameters", names),
        ("get_parameter_types", names),
        ("describe_parameters", names),
        ("set_parameters", values),
        ("set_parameters_atomically", values),
        ("store_parameters", _EMPTY),
    ):
        yield RosService(f"~/{name}", Code(f"epg_service_{name}"), size)
