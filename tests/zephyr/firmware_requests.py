# SPDX-License-Identifier: Apache-2.0
"""The requests to `firmware` (enum request of its src/main.c)."""

READ, FETCH, PRESET, WATCH, SUSPEND, RESUME, SKIPPED, POKE = range(1, 9)

EIO, EHOSTDOWN = 5, 117
"""Error numbers of newlib and of Zephyr's own C library."""
