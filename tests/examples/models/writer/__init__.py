# SPDX-License-Identifier: Apache-2.0
"""Writes the examples' models in the shape of 20-sim's exports, from their equations.

20-sim generates such files from a block diagram.  EPG's examples must not contain generated code of others, so their
equations stand here (``jiwy.py``, ``relbot.py``), and this package writes them out as 20-sim would lay them out: the
same files, arrays, functions and comments.  After a change of the equations::

    python tests/examples/models/write_models.py

A test compares the files under ``examples/`` with what this package writes.
"""
