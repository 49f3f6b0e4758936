# SPDX-License-Identifier: Apache-2.0
"""Measures the text of JIWY's images on a Pico beside eProsima's client without EPG.

Three programs for the same robot are written by hand, with EPG's model and encoder driver: ``client_alone``.  The first
one does not communicate.  The second one uses the SDK's serial port on USB.  The third one uses eProsima's client, and
is a node of an XRCE agent.
"""

from __future__ import annotations

from pathlib import Path

from measure import need
from report import Table, arguments, command_line, show

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js, tool
from tests.platforms.pico.images import images, size_of
from tests.platforms.pico.xrce.agent import BoardAgent

MIDDLEWARES = {
    "none": "none",
    "xrce_topics": "xrce, topics only",
    "xrce": "xrce",
    "console": "console",
    "xrce_console": "xrce and console",
}
HANDWRITTEN = {
    "none": "by hand, no communication",
    "serial": "by hand, a serial port on USB",
    "client": "by hand, eProsima's client",
}
OTHERS = (("published: Micro XRCE-DDS client, publisher and subscriber [1]", "less than 75,000", "about 3,000"),)
"""Programs that cannot be built here: text, and data with bss."""


def main() -> None:
    options = arguments(__doc__)
    need(pico_sdk, arm_gcc, node, rp2040js, lambda: tool("micro_xrce_dds_client"), lambda: tool("micro_cdr"))
    client = {"CLIENT": str(tool("micro_xrce_dds_client")), "CDR": str(tool("micro_cdr"))}
    ours = {name: images("pico", "bare_metal", "jiwy_in_ram", middleware=name) for name in MIDDLEWARES}
    by_hand = build("benchmarks/client_alone", variables=client)
    check_that_it_publishes(by_hand / "by_hand_client.elf")
    table = comparison(
        {MIDDLEWARES[name]: folder / "jiwy_in_ram.elf" for name, folder in ours.items()},
        {title: by_hand / f"by_hand_{name}.elf" for name, title in HANDWRITTEN.items()},
    )
    show("pico_text", [table], options.write, command_line("pico_text"))


def check_that_it_publishes(elf: Path) -> None:
    """The program written by hand is a node, too: it connects to an agent, and its positions arrive."""
    with Emulator(elf, usb={"seed": 3, "open": False}) as pico:
        pico.run(milliseconds=300)  # until the host has configured the device
        with BoardAgent(pico) as agent:
            agent.wait_for("rt/pan_publisher", milliseconds=4000)
            agent.wait_for("rt/tilt_publisher")


def verdict(size: int, aim: int) -> str:
    return f"holds ({size:,})" if size <= aim else f"missed by {size - aim:,} ({size:,})"


def comparison(ours: dict[str, Path], by_hand: dict[str, Path]) -> Table:
    rows = []
    text_of = {}
    for group, programs in (("EPG, ", ours), ("", by_hand)):
        sizes = {title: size_of(elf) for title, elf in programs.items()}
        least = next(iter(sizes.values()))  # each group begins with the program that does not communicate
        for title, size in sizes.items():
            beyond = [f"{size.text - least.text:,}", f"{size.data + size.bss - least.data - least.bss:,}"]
            text_of[group + title] = size.text
            rows.append([group + title, f"{size.text:,}", f"{size.data + size.bss:,}", *beyond])
    rows += [[title, text, ram, "", ""] for title, text, ram in OTHERS]
    head = ["program", "text", "data and bss", "text beyond none", "data and bss beyond none"]
    xrce = text_of["EPG, xrce"] - text_of["EPG, none"]
    console = text_of["EPG, xrce and console"] - text_of["EPG, xrce"]
    notes = [
        f"Aims: xrce at most 27,000 bytes beyond none: {verdict(xrce, 27_000)}; "
        f"the console at most 20,000 bytes beyond xrce: {verdict(console, 20_000)}.",
        "Same board, bare metal, model and encoders; all run from RAM here. Topics only: `parameters: false`, "
        "`diagnostics: 0 s`. The program with eProsima's client has JIWY's four topics of values, without enabling, "
        "reset, time stamps and checks of received frames.",
        "[1] <https://micro.ros.org/docs/concepts/middleware/Micro_XRCE-DDS/>: flash and RAM of the application.",
    ]
    return Table("Text of JIWY beside other programs, bytes", head, rows, notes)


if __name__ == "__main__":
    main()
