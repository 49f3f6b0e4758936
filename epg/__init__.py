# SPDX-License-Identifier: Apache-2.0
"""EPG turns a controller modelled in 20-sim into firmware that is a ROS 2 node.

The data pass four layers, none of which prints, exits or keeps global state:

load
    Reads the files: ``epg.generator.documents`` (YAML with positions, and its schemas), ``epg.generator.models``
    (20-sim exports and other models), ``epg.generator.catalog`` (the folders below ``targets/``).
``epg.generator.check``
    Merges the ``.tcf`` files that extend each other and checks names, units and schemas.
``epg.generator.resolve``
    Makes an :class:`~epg.generator.resolve.application.Application`: every wire has a type, every pin and peripheral is
    assigned.
``epg.generator.emit``
    Makes C, CMake and JSON text of the application, and writes only the files that changed.

docs/architecture.md lists all parts of the package, and which part may import which.
``epg.cli`` is the only caller that prints or exits.
"""

__version__ = "0.1.0"
