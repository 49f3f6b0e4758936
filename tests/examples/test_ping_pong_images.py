# SPDX-License-Identifier: Apache-2.0
"""``examples/ping_pong`` for a Pico 2 builds without a warning."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.doubles.toolchain import pico_sdk, xrce_libraries
from tests.examples.pico_project import configure, freertos_kernel, picotool, run, skip_unless_buildable

EXAMPLE = Path(__file__).resolve().parents[2] / "examples/ping_pong"


@pytest.mark.parametrize("target", ["rpi_pico2_freertos"])
def test_images_for_boards(tmp_path: Path, target: str) -> None:
    skip_unless_buildable(xrce_libraries, freertos_kernel)
    options = [f"-DPICO_SDK_PATH={pico_sdk()}", f"-Dpicotool_DIR={picotool()}", f"-DPING_PONG_TARGET={target}"]
    configure(EXAMPLE, *options, build=tmp_path)
    output = run(tmp_path, "cmake", "--build", ".", "--target", f"ping_pong_default_best_{target}")
    assert "warning:" not in output
    assert (tmp_path / f"ping_pong_default_best_{target}.uf2").is_file()
