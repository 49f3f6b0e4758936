"""What the device is called: EPG's default, what a target configuration says, what an executable's definitions say."""

from __future__ import annotations

import pytest

from tests.emulator.emulator import Emulator
from tests.platforms.pico.images import images, skip_unless_emulated
from tests.platforms.pico.usb.descriptors import STRING, text

DEVICE = 1
"""USB 2.0, table 9-5."""


@pytest.mark.parametrize(
    ("executable", "numbers", "names"),
    [
        ("named_firmware", (0x1209, 0x0001), ['Robots "R" Us', "Bench", "B-7"]),
        ("renamed_firmware", (0x1209, 0x0002), ['Robots "R" Us', "Other bench", "B-7"]),
    ],
)
def test_names(executable: str, numbers: tuple[int, int], names: list[str]) -> None:
    skip_unless_emulated("bare_metal")
    with Emulator(images("pico", "bare_metal", executable) / f"{executable}.elf", usb={"seed": 5}) as pico:
        assert pico.run(milliseconds=1000, configured=True)["usb"] == "configured"
        device = bytes.fromhex(pico.call("usb_descriptor", kind=DEVICE, number=0, index=0))
        assert tuple(int.from_bytes(device[at : at + 2], "little") for at in (8, 10)) == numbers
        strings = [pico.call("usb_descriptor", kind=STRING, number=device[at], index=0x409) for at in (14, 15, 16)]
        assert [text(bytes.fromhex(string)) for string in strings] == names
