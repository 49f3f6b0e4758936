# SPDX-License-Identifier: Apache-2.0
"""A scenario in Zephyr on this computer forces an input that the plant drives; the numbers are those of the host."""

from __future__ import annotations

import subprocess
from pathlib import Path

from epg.simulate import simulate
from tests.doubles.toolchain import arm_gcc, skip_if_missing
from tests.simulate.test_emergency_stop import CART, EXPECTED, enabled
from tests.simulate.test_emergency_stop import build as build_host

from .workspace import NATIVE, build, workspace


def test_forced_inputs_have_the_hosts_numbers(tmp_path: Path) -> None:
    skip_if_missing(lambda: workspace(NATIVE), arm_gcc)
    image = build("tests/zephyr/cart", NATIVE) / "zephyr" / "zephyr.exe"
    host = build_host(tmp_path / "build")
    for program, output in ((image, tmp_path / "native"), (host, tmp_path / "host")):
        assert simulate(program, CART / "emergency_stop.yaml", output).passed
    assert enabled(tmp_path / "native" / "trace.csv") == EXPECTED
    assert (tmp_path / "native" / "trace.csv").read_bytes() == (tmp_path / "host" / "trace.csv").read_bytes()
    names = [
        subprocess.run([program, "--interface"], capture_output=True, check=True).stdout for program in (image, host)
    ]
    assert names[0] == names[1]
    assert b"input,emergency_stop\n" in names[0]
