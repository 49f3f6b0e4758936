# SPDX-License-Identifier: Apache-2.0
"""The code that masks interrupts, in the images of all boards and platforms.

BASEPRI cannot mask the tick.  PRIMASK and FAULTMASK can: only the kernel's code sets them, around a few instructions.
"""

from __future__ import annotations

import re
import subprocess
from collections import defaultdict

from tests.platforms.firmware.builds import PROCESSORS

from .board import BOARDS, image

FUNCTION = re.compile(r"^[0-9a-f]+ <(.+)>:$")
MASKS = re.compile(r"\b(cpsid|cpsie|msr)\s+(.*)$")
LONGEST = 3
"""Instructions between `cpsid i` and `cpsie i`: the kernel's write to BASEPRI with barriers, erratum 837070."""


def masked(program: tuple[str, str]) -> dict[str, list[int]]:
    """Functions that mask all interrupts, with the number of instructions in each stretch; -1: its end is elsewhere."""
    command = [PROCESSORS[BOARDS[program[0]]].tool("objdump"), "-d", "--no-show-raw-insn", str(image(*program))]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found: dict[str, list[int]] = defaultdict(list)
    function, count = "", None
    for line in text.splitlines():
        if begins := FUNCTION.match(line):
            if count is not None:
                found[function].append(-1)
            function, count = begins.group(1), None
        elif "\t" in line:
            sets = MASKS.search(line)
            if sets and sets.group(1) == "cpsid":
                count = 0
            elif sets and sets.group(1) == "cpsie" and count is not None:
                found[function].append(count)
                count = None
            elif sets and sets.group(1) == "msr" and re.match("(PRIMASK|FAULTMASK)", sets.group(2)):
                found[function].append(-1)
            elif count is not None:
                count += 1
    assert "epg_one_core_on_tick" in text
    return dict(found)


def test_only_the_kernel_masks_all_interrupts(program: tuple[str, str]) -> None:
    found = masked(program)
    (mistake,) = found.pop("mask_all_interrupts")  # of the program
    assert not 0 <= mistake <= LONGEST
    assert all(0 <= length <= LONGEST for lengths in found.values() for length in lengths), found
    kernel = re.compile("[pvx]?(Port|Task|Queue|Timer|List)|prv|ulTask|uxTask|[vx]Task|xTimer")
    others = {name for name in found if not kernel.match(name)}
    assert others <= {"run"}, "EPG's task, which contains the kernel's portDISABLE_INTERRUPTS()"
    if program != ("mps2_an500", "freertos"):  # the port for Cortex-M7 r0p1
        assert found == {}
    else:
        assert "vPortEnterCritical" in found and "xPortPendSVHandler" in found
