# SPDX-License-Identifier: Apache-2.0
"""The command line: the only part of EPG that prints or exits.

One module per subcommand, each with ``add_arguments(parser)`` and ``run(arguments, diagnostics) -> int | None``.
Mistakes of the user are collected in ``diagnostics`` and printed at the end, all of them.
"""
