# SPDX-License-Identifier: Apache-2.0
"""The list of ports: a board's target describes itself; other devices, and ports in use, are not touched."""

from __future__ import annotations

import os
import subprocess
import sys
import time
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest

from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import own_roots
from epg.generator.diagnostics import Diagnostics
from epg.live import found
from epg.live.ports import linux

from .target import Target

VENDORS = load_catalog(own_roots(), Diagnostics()).usb_vendors()


def test_the_vendors_are_those_of_the_boards() -> None:
    assert {"2e8a", "0483", "2fe3"} == VENDORS


@pytest.fixture
def system(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder like /sys/class/tty."""
    folder = tmp_path / "tty"
    folder.mkdir()
    monkeypatch.setattr(linux, "DEVICES", folder)
    yield folder


def attach(system: Path, port: Path, vendor: str) -> None:
    """Makes ``port`` the serial port of a USB device."""
    device = system.parent / f"usb {port.resolve().name}"
    (device / "interface").mkdir(parents=True)
    (device / "idVendor").write_text(f"{vendor}\n")
    (system / port.resolve().name).mkdir()
    (system / port.resolve().name / "device").symlink_to(device / "interface")


@pytest.fixture
def silent() -> Iterator[tuple[int, Path]]:
    """A device that does not answer: the end of the device, and its port."""
    own, other = os.openpty()
    tty.setraw(other)
    os.set_blocking(own, False)
    name = Path(os.ttyname(other))
    yield own, name
    os.close(own)
    os.close(other)


def got(own: int) -> bytes:
    try:
        return os.read(own, 4096)
    except BlockingIOError:
        return b""


def test_targets_are_found_beside_a_silent_board(system: Path, target: Target, silent: tuple[int, Path]) -> None:
    own, path = silent
    attach(system, target.port, "2e8a")
    attach(system, path, "0483")
    begin = time.monotonic()  # the time that a user waits
    one, two = found.look_at_all({target.port: "Pico", path: "STLINK"}, VENDORS)
    assert time.monotonic() - begin < 2  # the time that a user waits
    assert one.target is not None and (one.target.name, one.device) == ("jiwy", "Pico")
    assert two.target is None and "does not answer" in two.reason
    assert got(own)


@pytest.mark.parametrize("vendor", ["1a86", None])
def test_another_device_is_not_touched(system: Path, silent: tuple[int, Path], vendor: str | None) -> None:
    own, path = silent
    if vendor is not None:
        attach(system, path, vendor)
    (one,) = found.look_at_all({path: ""}, VENDORS)
    assert (one.target, one.reason) == (None, "not asked: it is not a board that EPG knows")
    assert got(own) == b""


def test_a_port_in_use_is_not_touched(system: Path, silent: tuple[int, Path]) -> None:
    own, path = silent
    attach(system, path, "2e8a")
    hold = "import sys; file = open(sys.argv[1], 'rb+', 0); print(flush=True); sys.stdin.read()"
    with subprocess.Popen(
        [sys.executable, "-c", hold, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as user:
        assert user.stdout is not None and user.stdin is not None
        user.stdout.readline()
        (one,) = found.look_at_all({path: ""}, VENDORS)
        user.stdin.close()
    assert one.target is None and f"(process {user.pid})" in one.reason
    assert got(own) == b""
