# SPDX-License-Identifier: Apache-2.0
"""EPG turns a controller modelled in 20-sim into firmware that is a ROS 2 node.

The data pass four layers, none of which prints, exits or keeps global state:

load
    Files as their authors wrote them: ``epg.documents`` (YAML with positions and its schemas), ``epg.models`` (20-sim
    exports and other models), ``epg.catalog`` (the folders below ``targets/``).
``epg.check``
    What a target says: names, units, the merge of ``.tcf`` files that extend each other.
``epg.resolve``
    One :class:`~epg.resolve.application.Application`: every wire typed, every pin and peripheral assigned.
``epg.emit``
    The application as C, CMake and JSON text, and the writer that touches only what changed.

docs/architecture.md lists all parts of the package and which may import which.
``epg.cli`` is the only caller that prints or exits.
"""

__version__ = "0.1.0"
