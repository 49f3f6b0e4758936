# SPDX-License-Identifier: Apache-2.0
"""The control cycle of both RP2350 images on an emulated Cortex-M33 gives the host's bits over the motion profile.

There is no tolerance: the models of the examples use only + - x / and comparisons.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.simulate.load_scenario import load_scenario
from tests.doubles.rp2040.build import build
from tests.doubles.rp2350.cortex_m33 import COMPILER_ARITHMETIC, Processor
from tests.doubles.toolchain import ROOT, skip_if_missing, unicorn
from tests.platforms.pico.closed_loop.comparison import CONTROL
from tests.platforms.pico.closed_loop.host import Columns, host_programs, simulated
from tests.platforms.pico.closed_loop.recording import INPUTS, OUTPUTS
from tests.platforms.pico.closed_loop.robot import AXES
from tests.platforms.pico.images import PLATFORMS, PROJECT, skip_unless_buildable

from .profile import PWM_TOP, cycles, decoder_counts, start

SCENARIO = ROOT / "examples" / "jiwy" / "tracking.yaml"


def image(platform: str) -> Path:
    """JIWY for Pico 2 with its console and the compiler's doubles."""
    skip_unless_buildable(platform)
    skip_if_missing(unicorn)
    variables = {"PLATFORM": platform, "MIDDLEWARE": "console", **COMPILER_ARITHMETIC}
    return build(PROJECT, board="pico2", targets=["jiwy_firmware"], variables=variables) / "jiwy_firmware.elf"


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Columns:
    """The host's run of homing and the motion profile, 18,000 cycles."""
    diagnostics = Diagnostics()
    scenario = load_scenario(SCENARIO, diagnostics)
    assert scenario is not None, diagnostics.items
    programs = host_programs({"pan": 1.2, "tilt": 0.7})
    return simulated(programs, scenario, list(CONTROL), tmp_path_factory.mktemp("host"))


@pytest.mark.parametrize("platform", PLATFORMS)
def test_every_cycle_computes_the_bits_of_the_host(platform: str, host: Columns) -> None:
    processor = Processor(image(platform))
    start(processor)
    different = []
    for number, cycle in enumerate(cycles(processor, host)):
        inputs = tuple(host[f"inputs.{name}"][number] for name in INPUTS)
        outputs = tuple(host[f"outputs.{name}"][number] for name in OUTPUTS)
        if (cycle.inputs, cycle.outputs) != (inputs, outputs):
            different.append(number)
        for axis, duty in zip(AXES, cycle.duties, strict=True):
            wanted = host[f"outputs.pwm_{axis.name}"][number]
            assert abs(duty - wanted) <= 0.5001 / (PWM_TOP + 1), "the pins give the model's duty, to a clock of the PWM"
    assert number == 17_999
    assert different == []


def test_a_cycle_executes_few_thousand_instructions(host: Columns) -> None:
    """Counted in every 200th cycle; docs/benchmarks.md lists the parts."""
    processor = Processor(image("bare_metal"))
    start(processor)
    counts: Counter[int] = Counter()

    def around(number: int, run: object) -> None:
        assert callable(run)
        if number % 200 == 0:
            processor.trace(lambda pc: counts.update([number]), run)
        else:
            run()

    first = {name: values[:7_000] for name, values in host.items()}
    for _ in cycles(processor, first, around):
        pass
    initialising, *others = (counts[number] for number in sorted(counts))
    print(f"instructions in a cycle: {min(others)} ... {max(others)}, in the first {initialising}")
    assert len(others) == 34
    assert 1_000 < min(others) <= max(others) < 12_000
    assert initialising < 20_000


def test_counts_before_resets_are_found() -> None:
    axis = AXES[0]
    positions = [n * axis.rad_per_count for n in (0, -3, -5, -5, 0, 2)]
    columns = {"inputs.position_pan": positions, "outputs.encoder_reset_pan": [0.0, 0.0, 0.0, 1.0, 1.0, 0.0]}
    assert decoder_counts(columns, axis) == [0, -3, -5, -5, -5, -3]
