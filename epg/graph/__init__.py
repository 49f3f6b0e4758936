# SPDX-License-Identifier: Apache-2.0
"""Pictures of a target, as SVG: the application, the schedule of a control cycle, the wiring of the board.

The same target gives the same bytes.  Pictures follow the reader's light or dark mode, their text can be selected, and
their description says in words what they show.
"""
