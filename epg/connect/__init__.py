# SPDX-License-Identifier: Apache-2.0
"""``epg connect``: model ports and components are connected in a page of the browser, or in a terminal.

The files stay the truth: everything shown is what the command line would say of them, everything changed is a line of
the bindings (or ``extends`` of the ``.tcf``), kept as a draft until it is saved.  Page and terminal hold nothing of
their own: both show the state of one :class:`~epg.connect.session.Session`.
"""
