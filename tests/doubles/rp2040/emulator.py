# SPDX-License-Identifier: Apache-2.0
"""The RP2040 emulator, driven from Python.  docs/emulator.md states what it emulates and what is exact.

>>> # with Emulator(elf) as pico:
>>> #     pico.run_until_text("ready", milliseconds=500)
>>> #     pico.send("stats\\n")
>>> #     pico.run(milliseconds=10)
>>> #     pico.word("overruns")
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

from tests.doubles.toolchain import Missing, node, rp2040js, stand_in_rom, stock_rom

HERE = Path(__file__).resolve().parent

__all__ = ["CYCLES_PER_MILLISECOND", "Emulator", "EmulatorError", "Missing"]

CLOCK = 125_000_000
CYCLES_PER_MILLISECOND = CLOCK // 1000


class EmulatorError(Exception):
    """The emulator refused a command, or has ended."""


class Emulator:
    """One RP2040 with an image.  Commands are those of ``machine/commands.mjs``; times are cycles at 125 MHz."""

    def __init__(self, image: Path, *, stock: bool = False, **options: Any) -> None:
        """Loads ``image`` (ELF or UF2) and stops before its first instruction.

        ``stock``: use the boot ROM that ``EPG_RP2040_BOOTROM`` names, instead of EPG's replacement for it.  ``options``
        are those of the command ``load``: ``usb={"seed": 3, "phase": 120, "clock_error": 500}``, ``boot_cycles``,
        ``flash_size``, ``flash_times``, ``clock`` (clk_sys in Hz, if the image sets another frequency than 125 MHz).
        """
        environment = {**os.environ, "EPG_RP2040JS": str(rp2040js())}
        self._process = subprocess.Popen(
            [node(), str(HERE / "machine" / "driver.mjs")],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8", env=environment,
        )  # fmt: skip
        self._number = 0
        self._text = ""
        self.cycle = 0
        if stock:
            rom = stock_rom()
            if rom is None:
                raise Missing("EPG_RP2040_BOOTROM does not name a dump of the RP2040's boot ROM")
            options["boot_rom"] = str(rom)
        else:
            options["rom"] = str(stand_in_rom())
        self.call("load", image=str(image), **options)

    def __enter__(self) -> Emulator:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the emulator."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.close()
        self._process.wait(timeout=10)
        self._process.stdout.close()

    def call(self, command: str, **parameters: Any) -> Any:
        """Sends one command to the driver and returns its result."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._number += 1
        message = {"id": self._number, "call": command, "with": parameters}
        self._process.stdin.write(json.dumps(message) + "\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line:
            raise EmulatorError(f"the emulator has ended during {command}")
        answer = json.loads(line)
        if "error" in answer:
            raise EmulatorError(f"{command}: {answer['error']}\n{answer.get('trace', '')}")
        return answer["result"]

    # Time -------------------------------------------------------------------------------------------------------------

    def run(self, *, cycles: int = 0, milliseconds: float = 0, **stops: Any) -> dict[str, Any]:
        """Runs for this time or until one of ``stops`` (text, data, at, configured: see commands.mjs).

        Returns the state.
        """
        state: dict[str, Any] = self.call("run", cycles=cycles + round(milliseconds * CYCLES_PER_MILLISECOND), **stops)
        self.cycle = state["cycle"]
        return state

    def run_until_text(self, text: str, *, milliseconds: float = 1000, port: int = 0) -> str:
        """Runs until a serial port has printed ``text``; returns everything it printed since the last call."""
        state = self.run(milliseconds=milliseconds, text=text, port=port)
        said = self.receive(port=port)
        if state["reason"] != "text" and text not in said:
            raise EmulatorError(f"no {text!r} within {milliseconds} ms, but {said!r}; {state}; {self.call('faults')}")
        return said

    def run_until(self, place: str | int, *, milliseconds: float = 1000, core: int | None = None) -> dict[str, Any]:
        """Runs until a core is about to execute the code at a symbol or address."""
        stops = {} if core is None else {"core": core}
        state = self.run(milliseconds=milliseconds, at=place, **stops)
        if state["reason"] != "at":
            raise EmulatorError(f"{place} was not reached within {milliseconds} ms; {state}; {self.call('faults')}")
        return state

    # Serial port ------------------------------------------------------------------------------------------------------

    def send(self, text: str | bytes, *, port: int = 0, at: int | None = None) -> None:
        """Gives the USB host text that it sends to a serial port of the device: now, or at the cycle ``at``."""
        data = text.encode() if isinstance(text, str) else text
        self.call("usb_send", hex=data.hex(), port=port, **({} if at is None else {"at": at}))

    def receive(self, *, port: int = 0) -> str:
        """Takes the text that the firmware printed.  Bytes that are not UTF-8 become replacement characters."""
        return self.receive_bytes(port=port).decode(errors="replace")

    def receive_bytes(self, *, port: int = 0) -> bytes:
        """Takes the bytes that the firmware sent, for a protocol that is not text."""
        return bytes.fromhex(self.call("usb_receive", port=port))

    # Memory -----------------------------------------------------------------------------------------------------------

    def read(self, place: str | int, length: int | None = None, *, offset: int = 0) -> bytes:
        """The memory at a symbol (by default the whole symbol) or address."""
        parameters = {} if length is None else {"length": length}
        return bytes.fromhex(self.call("read", at=place, offset=offset, **parameters))

    def word(self, place: str | int, *, offset: int = 0, signed: bool = False, size: int = 4) -> int:
        """The integer at a symbol or address."""
        return int.from_bytes(self.read(place, size, offset=offset), "little", signed=signed)

    def write_word(self, place: str | int, value: int, *, offset: int = 0, size: int = 4) -> None:
        """Changes an integer in RAM."""
        data = (value % (1 << (8 * size))).to_bytes(size, "little")
        self.call("write", at=place, offset=offset, hex=data.hex())
