# SPDX-License-Identifier: Apache-2.0
"""Frames between lines of text, whole and damaged; rows of a stream."""

from __future__ import annotations

import random
from array import array

import pytest

from epg.live.client import Rows
from epg.live.frames import LONGEST, Decoder, decode, encode
from epg.live.rows import Stream

LENGTHS = [1, 2, 100, 249, 250, 251, 252, 253, 254, 255, 256, 500, 508, 1000]


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("fill", ["zeros", "ones", "any"])
def test_a_frame_gives_its_message_back(length: int, fill: str) -> None:
    generator = random.Random(length)
    message = {"zeros": bytes(length), "ones": b"\1" * length, "any": generator.randbytes(length)}[fill]
    frame = encode(message)
    assert frame[0] == frame[-1] == 0
    assert 0 not in frame[1:-1]
    assert len(frame) <= length + 4 + 2 + 1 + (length + 4) // 254
    assert decode(frame[1:-1]) == message


def test_every_flipped_bit_is_noticed() -> None:
    frame = encode(b"A\5parameter Pan\\PID\\kp=2.6")[1:-1]
    for index in range(len(frame)):
        for bit in range(8):
            damaged = bytearray(frame)
            damaged[index] ^= 1 << bit
            assert decode(bytes(damaged)) is None, (index, bit)


def test_frames_and_lines_come_in_their_order_in_pieces_of_any_size() -> None:
    generator = random.Random(5)
    parts: list[bytes | str] = []
    data = b""
    for number in range(300):
        if generator.random() < 0.5:
            parts.append(generator.randbytes(generator.randint(1, 300)))
            data += encode(parts[-1])  # type: ignore[arg-type]
        else:
            parts.append(f"watch {number} outputs.duty=0.5")
            data += f"{parts[-1]}\r\n".encode()
    decoder = Decoder()
    found: list[bytes | str] = []
    while data:
        size = generator.randint(1, 40)
        found += decoder.feed(data[:size])
        data = data[size:]
    assert found == parts
    assert decoder.damaged == 0


def test_a_decoder_finds_the_frames_after_noise() -> None:
    generator = random.Random(6)
    for _ in range(500):
        decoder = Decoder()
        decoder.feed(generator.randbytes(generator.randint(1, 600)))
        decoder.feed(b"\0")
        found = decoder.feed(encode(b"C1disable") * 2)
        assert b"C1disable" in found
    decoder = Decoder()
    decoder.feed(b"x" * (LONGEST + 1))
    assert decoder.damaged == 1
    assert decoder.feed(b"ready\n") == ["ready"]


def test_rows_that_are_missing_are_counted_across_the_end_of_the_numbers() -> None:
    stream = Stream(("a",), period=0.5)
    times = [row.time for row in stream.take(Rows((1 << 32) - 2, 100.0, array("f", [1.0])))]
    times += [row.time for row in stream.take(Rows(3, 102.5, array("f", [2.0, 3.0])))]
    assert times == [0.0, 2.5, 3.0]
    assert (stream.rows, stream.dropped) == (3, 4)
