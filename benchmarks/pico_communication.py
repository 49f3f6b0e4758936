# SPDX-License-Identifier: Apache-2.0
"""Measures the memory of communication on a Pico: size of JIWY's images by middleware, and the stack that is used.

Each of the four targets is built without middleware, with the console, with xrce, and with xrce and the console, which
is the predefined choice.  The stack is measured in RP2040 images in EPG's emulator, with an agent and a user at the
other ends.
"""

from __future__ import annotations

import re
from pathlib import Path

from measure import need
from report import Table, arguments, command_line, show

from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js
from tests.platforms.pico.images import freertos_kernel, images, ram_of, size_of
from tests.platforms.pico.xrce.agent import BoardAgent

MIDDLEWARES = {
    "none": "none",
    "console": "console",
    "xrce": "xrce",
    "xrce_console": "xrce and console",
}
TARGETS = {
    ("pico", "bare_metal"): "Pico, bare metal",
    ("pico", "freertos"): "Pico, FreeRTOS",
    ("pico2", "bare_metal"): "Pico 2, bare metal",
    ("pico2", "freertos"): "Pico 2, FreeRTOS",
}
RAM = {"pico": 264 * 1024, "pico2": 520 * 1024}
"""Bytes of SRAM."""
COMMANDS = ("help", "ports", "stats", "get", "watch", "capture 1")


def main() -> None:
    options = arguments(__doc__, targets=len(TARGETS))
    need(pico_sdk, arm_gcc, node, rp2040js, freertos_kernel)
    chosen = list(TARGETS)[: options.targets]
    rows = [row(*target, middleware) for target in chosen for middleware in MIDDLEWARES]
    head = ["image", "middleware", "flash", "RAM", "of RAM", "stack used", "stack"]
    notes = [
        "Bytes. Executables that run from flash; code and constants of the control cycle are in both. RAM includes "
        "the reserved stacks and heap. Stack: that of the communication side; used: at most, in two simulated "
        "seconds on RP2040."
    ]
    table = Table("Size of JIWY's images by middleware", head, rows, notes)
    show("pico_communication", [table], options.write, command_line("pico_communication"))


def firmware(board: str, platform: str, middleware: str) -> Path:
    return images(board, platform, "jiwy_firmware", middleware=middleware) / "jiwy_firmware.elf"


def row(board: str, platform: str, middleware: str) -> list[str]:
    elf = firmware(board, platform, middleware)
    size = size_of(elf)
    ram = ram_of(elf)
    used, reserved = stack(platform, middleware) if board == "pico" and "console" in middleware else ("", "")
    name = TARGETS[board, platform]
    numbers = [str(size.text + size.data), str(ram), f"{100 * ram / RAM[board]:.0f} %"]
    return [name, MIDDLEWARES[middleware], *numbers, used, reserved]


def stack(platform: str, middleware: str) -> tuple[str, str]:
    """Bytes of stack that are used and reserved, as the firmware itself reports them."""
    elf = firmware("pico", platform, middleware)
    with Emulator(elf, usb={"seed": 3, "open": middleware == "console"}) as pico:
        pico.run(milliseconds=50)
        if middleware == "console":
            return on_the_console(pico, 0, lambda milliseconds: pico.run(milliseconds=milliseconds))
        with BoardAgent(pico) as agent:
            agent.wait_for("rt/pan_publisher")
            pico.call("usb_open", port=1)
            return on_the_console(pico, 1, agent.run)


def on_the_console(pico: Emulator, port: int, run: object) -> tuple[str, str]:
    assert callable(run)
    for command in COMMANDS:
        pico.send(command + "\n", port=port)
        run(200)
    run(800)
    pico.receive(port=port)
    pico.send("\nstats\n", port=port)
    run(100)
    found = dict(re.findall(r"communication_stack_(\w+)=(\d+)", pico.receive(port=port)))
    return found["used"], found["size"]


if __name__ == "__main__":
    main()
