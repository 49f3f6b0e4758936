# SPDX-License-Identifier: Apache-2.0
"""Measurements over many seeds; as many run at the same time as there are processors."""

from __future__ import annotations

import os
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor

from .measure import Load, Timing, measure
from .programs import Program


def measure_many(program: Program, load: Load, seeds: Iterable[int], seconds: float) -> Timing:
    """The sum of :func:`measure` over ``seeds``: each is a USB host with its own phase, clock and packets."""
    image = program.image()
    total = Timing()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for timing in pool.map(lambda seed: measure(program, load, seed, seconds, image=image), seeds):
            total.add(timing)
    return total
