# SPDX-License-Identifier: Apache-2.0
"""EPG turns a controller modelled in 20-sim into firmware that is a ROS 2 node.

The package has four layers, each of which imports only from those above it in this list, and none of which
prints, exits or keeps global state:

``epg.load``
    Files as their authors wrote them: YAML with positions, 20-sim exports, the folders below ``targets/``.
``epg.check``
    JSON Schema, names, units, the merge of ``.tcf`` files that extend each other.
``epg.resolve``
    One :class:`~epg.resolve.application.Application`: every wire typed, every pin and peripheral assigned.
``epg.emit``
    The application as C, CMake and JSON text, and the writer that touches only what changed.

``epg.cli`` is the only caller that prints or exits.
"""

__version__ = "0.1.0"
