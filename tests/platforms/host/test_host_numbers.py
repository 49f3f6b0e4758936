# SPDX-License-Identifier: Apache-2.0
"""The parts of the host platform: distribution of times, numbers in files, and the number of a start."""

from __future__ import annotations

import math
import random
import struct
import subprocess
from pathlib import Path

import pytest

from .program import HOST, PROGRAMS, compile_program


def filtered(program: Path, lines: list[str]) -> list[str]:
    done = subprocess.run([str(program)], input="\n".join(lines), capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.splitlines()


@pytest.fixture(scope="module")
def histogram(tmp_path_factory: pytest.TempPathFactory) -> Path:
    sources = [PROGRAMS / "histogram_quantiles.c", HOST / "src" / "loop" / "histogram.c"]
    return compile_program(tmp_path_factory.mktemp("histogram") / "histogram", sources)


@pytest.fixture(scope="module")
def numbers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    sources = [PROGRAMS / "numbers.c", HOST / "src" / "files" / "number.c"]
    return compile_program(tmp_path_factory.mktemp("numbers") / "numbers", sources)


@pytest.mark.parametrize("seed", range(5))
def test_quantiles(histogram: Path, seed: int) -> None:
    source = random.Random(seed)
    values = [int(math.exp(source.uniform(0, [3, 8, 14, 30, 43][seed]))) for _ in range(3000)]
    count, low, high, mean, *quantiles, between = filtered(histogram, [str(value) for value in values])[0].split()
    assert (int(count), int(low), int(high), int(between)) == (len(values), min(values), max(values), len(values))
    assert float(mean) == pytest.approx(sum(values) / len(values), rel=1e-12)
    ordered = sorted(values)
    for share, quantile in zip([0.5, 0.9, 0.99, 0.999, 1.0], quantiles[1:]):
        exact = ordered[math.ceil(share * len(values)) - 1]
        assert exact <= int(quantile) <= exact * (1 + 1 / 32)


def test_limits_of_the_histogram(histogram: Path) -> None:
    assert filtered(histogram, [])[0].split() == ["0"] * 11
    largest = str(2**64 - 1)
    count, low, high, _, *quantiles, between = filtered(histogram, ["0", largest])[0].split()
    assert (count, low, high, between) == ("2", "0", largest, "2")
    assert quantiles[-1] == largest


def test_numbers_survive_a_file(numbers: Path) -> None:
    source = random.Random(1)
    bits = [source.getrandbits(64) for _ in range(5000)]
    values = [0.1, 0.033, 1 / 3, 1e22, 5e-324, 1.7976931348623157e308, -0.0, 123456789.0, 2.5]
    bits += [int.from_bytes(struct.pack(">d", value), "big") for value in values]
    written = filtered(numbers, [f"{word:x}" for word in bits])
    for word, text in zip(bits, written, strict=True):
        value = struct.unpack(">d", word.to_bytes(8, "big"))[0]
        if math.isnan(value):
            assert text == "nan"
        else:
            assert struct.pack(">d", float(text)) == word.to_bytes(8, "big")
    assert written[-9:-5] == ["0.1", "0.033", "0.3333333333333333", "1e+22"]
    assert written[-3:] == ["-0", "123456789", "2.5"]


def test_the_number_of_a_start(tmp_path: Path) -> None:
    """Another one for each run in real time; the same one for all runs in simulated time."""
    sources = [
        PROGRAMS / "boot_id.c",
        *(HOST / "src/port" / f"{name}.c" for name in ("clock", "posix/monotonic", "posix/random", "linux/system")),
    ]
    program = compile_program(tmp_path / "boot_id", sources)

    def number(*arguments: str) -> int:
        done = subprocess.run([program, *arguments], capture_output=True, text=True, check=True)
        first, again = done.stdout.split()
        assert first == again != "0"
        return int(first)

    assert len({number() for _ in range(10)}) == 10
    assert {number("simulated") for _ in range(3)} == {1}
