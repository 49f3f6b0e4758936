# SPDX-License-Identifier: Apache-2.0
"""The command line, which is the only part of EPG that prints or exits.

Each subcommand is one module with ``add_arguments(parser)`` and ``run(arguments, diagnostics) -> int | None``.  It
collects the user's mistakes in ``diagnostics``; ``main.py`` prints all of them at the end.
"""
