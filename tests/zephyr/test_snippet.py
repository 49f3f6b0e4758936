# SPDX-License-Identifier: Apache-2.0
"""The snippet `epg-debug`: the settings that it enables; an application's own settings have priority."""

from __future__ import annotations

from functools import partial

from tests.doubles.toolchain import arm_gcc, skip_if_missing

from .workspace import build, workspace


def test_epg_debug() -> None:
    skip_if_missing(partial(workspace, "rpi_pico"), arm_gcc)
    settings = {"SNIPPET": "epg-debug", "CONFIG_ASSERT": "n"}
    folder = build("tests/zephyr/empty", "rpi_pico", settings=settings, only="main.c")
    lines = set((folder / "zephyr" / ".config").read_text(encoding="utf-8").splitlines())
    wanted = ("DEBUG_THREAD_INFO", "INIT_STACKS", "LOG", "LOG_BACKEND_UART", "STACK_SENTINEL", "THREAD_NAME")
    assert {f"CONFIG_{name}=y" for name in wanted} <= lines
    assert "# CONFIG_ASSERT is not set" in lines
