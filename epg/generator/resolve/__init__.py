# SPDX-License-Identifier: Apache-2.0
"""Joins model, configuration and bindings to an :class:`~epg.generator.resolve.application.Application`.

``resolve.py`` is the main module.  ``wires.py`` and ``conversion.py`` connect ports, ``topics.py`` numbers the values
of messages.

The assignment of hardware is a search: ``claims.py`` lists what the components need, ``pins.py`` checks their pins and
finds the possible places, ``search.py`` chooses a place for each claim, ``divider.py`` computes dividers, and
``conflict.py`` explains why there is no solution.  ``allocation.py`` does this for all claims of a target.

``matching.py`` proposes bindings by the names, types and units of ports; ``fitting.py`` compares types and units.
``unused.py`` warns of components that nothing uses.
"""
