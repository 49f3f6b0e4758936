# SPDX-License-Identifier: Apache-2.0
"""``epg connect``: the user connects model ports with components, in a page of the browser or in a terminal.

The project's files are the only source of truth.  The page and the terminal show the same messages as the command
line.  A change edits one line of the bindings, or ``extends`` in the ``.tcf``.  It is part of a draft until the user
saves it.  The page and the terminal have no data of their own: both show the state of one
:class:`~epg.connect.session.Session`.
"""
