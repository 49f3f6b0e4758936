# SPDX-License-Identifier: Apache-2.0
"""Checks the parts of a target, each of them alone: its configuration, the bindings, and the names in a model.

``configuration.py`` is the main module.  Its :func:`~epg.generator.check.configuration.check_configuration` merges the
``.tcf`` files (``merge.py``), compares each component with the schema of its kind (``compose.py``), and calls the
modules that check one subject each, such as ``names.py`` and ``communication.py``.  ``bindings.py`` reads a bindings
file.

The results are data whose names, types and ranges are right.  Whether the parts fit together is the task of
``epg.generator.resolve``.
"""
