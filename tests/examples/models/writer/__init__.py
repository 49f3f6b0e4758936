# SPDX-License-Identifier: Apache-2.0
"""Writes the examples' models in the form of 20-sim's exports, from their equations.

20-sim generates such files from a block diagram.  EPG's examples must not contain generated code of others.  This
package therefore has their equations (``jiwy.py``, ``relbot.py``), and writes them in the layout of 20-sim: the
same files, arrays, functions and comments.  After a change of the equations::

    python tests/examples/models/write_models.py

A test compares the files under ``examples/`` with the output of this package.
"""
