# SPDX-License-Identifier: Apache-2.0
"""A checker of USB configuration descriptors, as an operating system reads them.

>>> interfaces(bytes.fromhex("09021200010100807d" "0904000000ff000105"))
[Interface(number=0, kind=(255, 0, 1), text=5, endpoints=())]
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

CONFIGURATION, STRING, INTERFACE, ENDPOINT, ASSOCIATION, BOS, CLASS = 2, 3, 4, 5, 11, 15, 0x24
CDC_ACM, CDC_DATA, PICOTOOL_RESET, ASSOCIATED_ACM = (2, 2, 0), (10, 0, 0), (0xFF, 0, 1), (2, 2, 0)
BULK, INTERRUPT = 2, 3
HEADER, CALL_MANAGEMENT, ABSTRACT_CONTROL, UNION = 0, 1, 2, 6


class DescriptorError(Exception):
    """A descriptor breaks a rule of the USB specification."""


@dataclass(frozen=True)
class Interface:
    """``kind``: class, subclass, protocol; ``text``: index of its string; ``endpoints``: (address, type, packet)."""

    number: int
    kind: tuple[int, int, int]
    text: int
    endpoints: tuple[tuple[int, int, int], ...]


@dataclass(frozen=True)
class Function:
    """An interface association: the interfaces that one driver uses."""

    first: int
    count: int
    kind: tuple[int, int, int]


@dataclass(frozen=True)
class SerialPort:
    """A CDC ACM function: its two interfaces, the string of the first, and its bulk endpoints."""

    control: int
    data: int
    text: int
    bulk_in: int
    bulk_out: int


def parts(data: bytes) -> Iterator[bytes]:
    """The descriptors in ``data``, which must fill it without a gap."""
    at = 0
    while at < len(data):
        length = data[at]
        if length < 2 or at + length > len(data):
            raise DescriptorError(f"a descriptor of {length} bytes at {at} of {len(data)}")
        yield data[at : at + length]
        at += length


def interfaces(configuration: bytes) -> list[Interface]:
    """The interfaces.  Checks lengths, counts, the order of numbers, and that each endpoint exists once."""
    head, *rest = parts(configuration)
    if (head[0], head[1]) != (9, CONFIGURATION) or int.from_bytes(head[2:4], "little") != len(configuration):
        raise DescriptorError("the configuration states another length than it has")
    found: list[Interface] = []
    expected: list[int] = []
    for part in rest:
        if part[1] == INTERFACE:
            found.append(Interface(part[2], (part[5], part[6], part[7]), part[8], ()))
            expected.append(part[4])
        elif part[1] == ENDPOINT:
            endpoint = (part[2], part[3] & 3, int.from_bytes(part[4:6], "little"))
            found[-1] = replace(found[-1], endpoints=(*found[-1].endpoints, endpoint))
    if [interface.number for interface in found] != list(range(head[4])):
        raise DescriptorError(f"{head[4]} interfaces are stated: {found}")
    if [len(interface.endpoints) for interface in found] != expected:
        raise DescriptorError(f"the interfaces state {expected} endpoints: {found}")
    addresses = [address for interface in found for address, _, _ in interface.endpoints]
    if len(set(addresses)) != len(addresses) or any(address & 0xF == 0 for address in addresses):
        raise DescriptorError(f"endpoints {addresses}")
    return found


def functions(configuration: bytes) -> list[Function]:
    """The interface associations, which must not overlap."""
    found = [Function(p[2], p[3], (p[4], p[5], p[6])) for p in parts(configuration) if p[1] == ASSOCIATION]
    members = [number for function in found for number in range(function.first, function.first + function.count)]
    if len(set(members)) != len(members):
        raise DescriptorError(f"associations overlap: {found}")
    return found


def serial_ports(configuration: bytes) -> list[SerialPort]:
    """The serial ports.  Each must have everything that a CDC ACM driver needs."""
    known = {interface.number: interface for interface in interfaces(configuration)}
    associations = {function.first: function for function in functions(configuration)}
    unions = _unions(configuration)
    found = []
    for control in (interface for interface in known.values() if interface.kind == CDC_ACM):
        function = associations.get(control.number)
        if function is None or function.count != 2 or function.kind != ASSOCIATED_ACM:
            raise DescriptorError(f"interface {control.number} and its data are not associated: {function}")
        if unions.get(control.number) != control.number + 1:
            raise DescriptorError(f"the union of interface {control.number} names {unions.get(control.number)}")
        if [kind for _, kind, _ in control.endpoints] != [INTERRUPT]:
            raise DescriptorError(f"interface {control.number} has no endpoint for notifications")
        data = known[control.number + 1]
        bulk = {bool(address & 0x80): address for address, kind, size in data.endpoints if (kind, size) == (BULK, 64)}
        if data.kind != CDC_DATA or set(bulk) != {True, False}:
            raise DescriptorError(f"interface {data.number} does not carry data: {data}")
        found.append(SerialPort(control.number, data.number, control.text, bulk[True], bulk[False]))
    return found


def _unions(configuration: bytes) -> dict[int, int]:
    """The data interface that each CDC control interface names in its own union descriptor; checks that descriptor."""
    result: dict[int, int] = {}
    current, kinds = -1, set()
    for part in parts(configuration):
        if part[1] == INTERFACE:
            current, kinds = part[2], set()
        elif part[1] == CLASS:
            kinds.add(part[2])
            if part[2] == CALL_MANAGEMENT and part[4] != current + 1:
                raise DescriptorError(f"interface {current}: calls are managed over interface {part[4]}")
            if part[2] == UNION:
                if part[3] != current or not {HEADER, CALL_MANAGEMENT, ABSTRACT_CONTROL} <= kinds:
                    raise DescriptorError(f"interface {current}: union of {part[3]}, functional descriptors {kinds}")
                result[current] = part[4]
    return result


def text(string: bytes) -> str:
    """The text of a string descriptor."""
    if string[1] != STRING or string[0] != len(string):
        raise DescriptorError(f"no string: {string.hex()}")
    return string[2:].decode("utf-16-le")
