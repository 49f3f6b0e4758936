# SPDX-License-Identifier: Apache-2.0
"""The names of the device, from a target configuration and from an executable's definitions."""

from __future__ import annotations

from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.usb_descriptors import STRING, text
from tests.platforms.pico.images import images, skip_unless_emulated

DEVICE = 1
"""USB 2.0, table 9-5."""


def test_names() -> None:
    """A definition sets the product and has priority over the target configuration, which sets the other names."""
    skip_unless_emulated("bare_metal")
    with Emulator(images("pico", "bare_metal", "named_firmware") / "named_firmware.elf", usb={"seed": 5}) as pico:
        assert pico.run(milliseconds=1000, configured=True)["usb"] == "configured"
        device = bytes.fromhex(pico.call("usb_descriptor", kind=DEVICE, number=0, index=0))
        assert tuple(int.from_bytes(device[at : at + 2], "little") for at in (8, 10)) == (0x1209, 0x0001)
        strings = [pico.call("usb_descriptor", kind=STRING, number=device[at], index=0x409) for at in (14, 15, 16)]
        assert [text(bytes.fromhex(string)) for string in strings] == ['Robots "R" Us', "Other bench", "B-7"]
