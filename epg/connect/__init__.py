# SPDX-License-Identifier: Apache-2.0
"""``epg connect``: the user connects model ports with components, in a page of the browser or in a terminal.

The project's files are the only source of truth.  The page and the terminal show the same messages as the command
line.  A change edits a port in the bindings, or ``extends`` in the ``.tcf``.  It is part of a draft until the user
saves it.  The page and the terminal keep no data: both show the state of one :class:`~epg.connect.session.Session`.
"""
