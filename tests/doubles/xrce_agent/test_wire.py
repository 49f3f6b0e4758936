# SPDX-License-Identifier: Apache-2.0
"""The parts of the agent without a board: framing, streams, faults, descriptions of entities."""

from __future__ import annotations

import random
import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.doubles.xrce_agent.faults import Faults
from tests.doubles.xrce_agent.framing import Deframer, crc16, frame
from tests.doubles.xrce_agent.representations import Description, Qos, read_description
from tests.doubles.xrce_agent.streams import BestEffortInput, Fragments, ReliableInput, ReliableOutput
from tests.doubles.xrce_agent.topics import Endpoint, Topics
from tests.doubles.xrce_agent.wire import CdrReader, Header, Id, Kind, WireError, later, split, submessage, submessages

QUICK = settings(max_examples=100, deadline=None, derandomize=True, database=None)


def test_crc_is_the_one_of_the_catalogue() -> None:
    """CRC-16/ARC in the catalogue of parametrised CRC algorithms: check value BB3D."""
    assert crc16(b"123456789") == 0xBB3D


@QUICK
@given(st.lists(st.binary(min_size=1, max_size=300), max_size=5), st.binary(max_size=40), st.integers(1, 9))
def test_frames_come_out_as_they_went_in(payloads: list[bytes], noise: bytes, chunk: int) -> None:
    """Wherever the line cuts the frames, and whatever bytes precede the first frame."""
    line = noise.replace(b"\x7e", b"") + b"".join(frame(payload, 1, 0) for payload in payloads)
    deframer = Deframer()
    found = [payload for at in range(0, len(line), chunk) for payload in deframer.feed(line[at : at + chunk])]
    assert found == [(1, payload) for payload in payloads]
    assert deframer.broken == 0


@QUICK
@given(st.binary(min_size=4, max_size=60), st.data())
def test_a_damaged_frame_is_dropped_and_the_next_is_not(payload: bytes, data: st.DataObject) -> None:
    line = bytearray(frame(payload, 1, 0))
    at = data.draw(st.integers(2, len(line) - 1))  # the source address is not checked
    line[at] ^= data.draw(st.integers(1, 255))
    found = Deframer().feed(bytes(line) + frame(b"next", 1, 0))
    assert found[-1:] == [(1, b"next")]
    assert (1, payload) not in found[:-1]


def test_sequence_numbers_wrap() -> None:
    assert later(0, 0xFFFF) and later(0x7FFF, 0) and not later(0x8000, 0) and not later(5, 5)


@settings(max_examples=25, deadline=None, derandomize=True, database=None)
@given(st.randoms(use_true_random=False), st.floats(0, 0.5))
def test_a_reliable_stream_brings_all_in_order(chance: random.Random, loss: float) -> None:
    """Over a line that loses, duplicates and reorders messages, beyond the wrap of sequence numbers."""
    output, inside = ReliableOutput(0x81, b"", 0x80), ReliableInput()
    output._next = inside._next = 0xFFF0
    inside._announced = 0xFFEF
    wanted = [bytes([number]) * 3 for number in range(60)]
    waiting, line, got = list(wanted), [], []
    for _ in range(3000):
        if waiting and (messages := output.push(waiting[0], 512)) is not None:
            waiting.pop(0)
            line += messages
        chance.shuffle(line)
        while line:
            message = line.pop()
            if chance.random() < loss:
                continue
            header, body = split(message)
            for _ in range(2):
                got += inside.receive(header.sequence, body)
        beat = output.heartbeat()
        if beat:
            (part,) = submessages(beat)
            got += inside.heartbeat(*struct.unpack_from("<HH", part.payload))
            (answer,) = submessages(inside.acknack(0x80))
            if chance.random() >= loss:
                first, missing = struct.unpack_from("<H", answer.payload)[0], int.from_bytes(answer.payload[2:4], "big")
                line += output.acknack(first, missing)
        if got == wanted and output.heartbeat() is None:
            break
    assert got == wanted


def test_large_messages_go_in_fragments() -> None:
    output, together = ReliableOutput(0x81, b"", 0x80), Fragments()
    content = submessage(Id.DATA, bytes(range(256)) * 4)
    messages = output.push(content, 200)
    assert messages is not None and all(len(message) <= 200 for message in messages)
    parts = [part for message in messages for part in submessages(split(message)[1])]
    whole = [together.add(part) for part in parts]
    assert whole[:-1] == [None] * (len(parts) - 1)
    assert whole[-1] == content


def test_a_full_window_takes_no_more() -> None:
    output = ReliableOutput(0x81, b"", 0x80)
    taken = [output.push(b"x", 512) is not None for _ in range(20)]
    assert taken == [True] * 15 + [False] * 5
    output.acknack(3, 0)
    assert [output.push(b"x", 512) is not None for _ in range(4)] == [True] * 3 + [False]


def test_best_effort_drops_what_is_old() -> None:
    inside = BestEffortInput()
    order = [0, 1, 3, 2, 3, 0x7000, 5, 0xE000, 1]
    assert [bool(inside.receive(number, b"x")) for number in order] == [
        True, True, True, False, False, True, False, True, True,
    ]  # fmt: skip


def test_all_fragments_of_a_message_are_sent_at_once() -> None:
    """Also if the window does not have room for them; the next message waits."""
    output = ReliableOutput(0x81, b"", 0x81)
    sent = output.push(bytes(range(200)) * 20, 100)
    assert sent is not None and len(sent) == -(-4000 // 92)
    assert output.push(b"x", 100) is None
    pieces, fragments = [part for message in sent for part in submessages(split(message)[1])], Fragments()
    assert {Id(piece.id) for piece in pieces} == {Id.FRAGMENT}
    assert [fragments.add(piece) for piece in pieces] == [None] * (len(pieces) - 1) + [bytes(range(200)) * 20]


def string(text: str) -> bytes:
    return struct.pack("<I", len(text) + 1) + text.encode() + b"\0"


@pytest.mark.parametrize(
    ("payload", "description"),
    [
        (
            b"\x02\x03\0\0" + struct.pack("<I", len(string("rt/abc")) + 2) + string("rt/abc") + b"\0\0" + b"\x00\x11",
            Description(Kind.TOPIC, b"\x00\x11", "rt/abc"),
        ),
        (
            b"\x05\x03\0\0" + struct.pack("<I", 13) + b"\x00\x12\x01\0" + b"\x03\x00\x01\0\x07\x00\0\0\0" + b"\x00\x13",
            Description(Kind.WRITER, b"\x00\x13", topic=b"\x00\x12", qos=Qos(True, True, 7)),
        ),
        (
            b"\x08\x03\0\0"
            + struct.pack("<I", 8 + 8 + 8 + 4 + 12 + 4 + 12)
            + (string("abc") + string("Req") + string("Rep") + b"\1\0\0\0" + string("rq/abcd") + b"\1\0\0\0")
            + string("rr/abcd")
            + b"\x00\x11",
            Description(Kind.REPLIER, b"\x00\x11", "rq/abcd", "Req", replies=("rr/abcd", "Rep")),
        ),
    ],
)
def test_descriptions_of_entities(payload: bytes, description: Description) -> None:
    assert read_description(CdrReader(payload)) == description


@QUICK
@given(st.binary(max_size=60))
def test_what_is_no_message_is_said_to_be_none(data: bytes) -> None:
    try:
        header, body = split(data)
        for part in submessages(body):
            if part.id == Id.CREATE:
                read_description(part.reader)
        assert data.startswith(header.pack())
    except WireError:
        pass


def test_header_with_and_without_key() -> None:
    for header in (Header(0x81, 0x80, 7), Header(0x01, 0x80, 0xFFFF, b"abcd")):
        assert split(header.pack() + b"rest") == (header, b"rest")


def test_faults_come_as_often_as_asked() -> None:
    chance = random.Random(3)
    assert (Faults().arrivals(chance), Faults().damage(b"abc", chance)) == ([0.0], b"abc")
    arrived = [wait for _ in range(2000) for wait in Faults(loss=0.1, duplicate=0.2).arrivals(chance)]
    assert 2000 * 0.9 * 1.2 * 0.95 < len(arrived) < 2000 * 0.9 * 1.2 * 1.05
    assert 1 <= len(Faults(truncate=1).damage(b"abc", chance)) < 3
    damaged = Faults(corrupt=1).damage(bytes(100), chance)
    assert len(damaged) == 100 and 1 <= sum(byte != 0 for byte in damaged) <= 4
    waits = [wait for _ in range(200) for wait in Faults(delay=(0.1, 0.2)).arrivals(chance)]
    assert 0.1 <= min(waits) < 0.12 and 0.18 < max(waits) <= 0.2


def test_matching_is_that_of_dds() -> None:
    topics = Topics()
    careful, quick = topics.subscribe("rt/a", reliable=True), topics.subscribe("rt/a", reliable=False)
    other = topics.subscribe("rt/a", reliable=False, type_name="other")
    topics.write(Endpoint("rt/a", "T", reliable=False), b"1")
    topics.write(Endpoint("rt/a", "T", reliable=True), b"2")
    topics.write(Endpoint("rt/b", "T", reliable=True), b"3")
    assert careful.samples == [b"2"]
    assert quick.samples == [b"1", b"2"]
    assert other.samples == []
