# SPDX-License-Identifier: Apache-2.0
"""Draws pictures of a target as SVG: the application, the schedule of a control cycle, the wiring of the board.

The same target gives the same bytes.  Pictures follow the light or dark mode of the browser.  Their text can be
selected.  Each picture has a description in words, for users who cannot see it.
"""
