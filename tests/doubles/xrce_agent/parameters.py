# SPDX-License-Identifier: Apache-2.0
"""Requests and responses of the parameter services of ROS 2 (rcl_interfaces), for parameters that are numbers."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from .wire import CdrReader

DOUBLE = 3
"""rcl_interfaces/msg/ParameterType/PARAMETER_DOUBLE."""


class CdrWriter:
    def __init__(self) -> None:
        self.data = b""

    def number(self, code: str, value: float) -> None:
        """Writes a number; ``code`` is one of ``struct``'s."""
        self.data += bytes(-len(self.data) % struct.calcsize(code)) + struct.pack("<" + code, value)

    def string(self, text: str) -> None:
        encoded = text.encode() + b"\0"
        self.number("I", len(encoded))
        self.data += encoded

    def value(self, number: float) -> None:
        """A ParameterValue."""
        self.number("B", DOUBLE)
        self.number("?", False)
        self.number("q", 0)
        self.number("d", number)
        self.string("")
        for _ in range(5):
            self.number("I", 0)  # an array


def names(parameters: Iterable[str]) -> bytes:
    """The request of GetParameters, GetParameterTypes and DescribeParameters."""
    found = list(parameters)
    writer = CdrWriter()
    writer.number("I", len(found))
    for name in found:
        writer.string(name)
    return writer.data


def values(parameters: Mapping[str, float]) -> bytes:
    """The request of SetParameters and SetParametersAtomically."""
    writer = CdrWriter()
    writer.number("I", len(parameters))
    for name, number in parameters.items():
        writer.string(name)
        writer.value(number)
    return writer.data


def _value(reader: CdrReader) -> float:
    assert reader.u8() == DOUBLE
    reader.flag()
    reader.number("q")
    number = float(reader.number("d"))
    reader.string()
    assert [reader.u32() for _ in range(5)] == [0] * 5
    return number


@dataclass(frozen=True)
class Parameters:
    """The parameter services of the node ``node``, such as "/JIWY_node"; ``ask`` returns the reply to a request."""

    ask: Callable[[str, bytes], bytes]
    node: str

    def call(self, service: str, request: bytes) -> CdrReader:
        return CdrReader(self.ask(f"{self.node}/{service}", request))

    def list(self) -> list[str]:
        request = CdrWriter()
        request.number("I", 0)
        request.number("Q", 0)
        reply = self.call("list_parameters", request.data)
        return [reply.string() for _ in range(reply.u32())]

    def get(self, parameters: Iterable[str]) -> list[float]:
        reply = self.call("get_parameters", names(parameters))
        found = [_value(reply) for _ in range(reply.u32())]
        assert reply.position == len(reply.data)
        return found

    def types(self, parameters: Iterable[str]) -> list[int]:
        reply = self.call("get_parameter_types", names(parameters))
        return [reply.u8() for _ in range(reply.u32())]

    def described(self, parameters: Iterable[str]) -> dict[str, str]:
        """The names and descriptions in the descriptors."""
        reply = self.call("describe_parameters", names(parameters))
        found = {}
        for _ in range(reply.u32()):
            name, _type, description, _constraints = reply.string(), reply.u8(), reply.string(), reply.string()
            found[name] = description
            reply.flag(), reply.flag()  # read only, dynamic typing
            for code in ("d", "q"):  # the ranges of numbers and of integers
                for _ in range(3 * reply.u32()):
                    reply.number(code)
        assert reply.position == len(reply.data)
        return found

    def set(self, parameters: Mapping[str, float]) -> list[tuple[bool, str]]:
        """For each parameter, true if it was set, and otherwise the reason."""
        reply = self.call("set_parameters", values(parameters))
        return [(reply.flag(), reply.string()) for _ in range(reply.u32())]

    def set_atomically(self, parameters: Mapping[str, float]) -> tuple[bool, str]:
        reply = self.call("set_parameters_atomically", values(parameters))
        return reply.flag(), reply.string()
