# SPDX-License-Identifier: Apache-2.0
"""Closed-loop runs on the host platform: scenarios, setpoints, tracking errors and plots.

>>> from epg.simulate import simulate, format_table             # doctest: +SKIP
>>> result = simulate(Path("build/jiwy_host"), Path("tracking.yaml"), Path("results"))  # doctest: +SKIP
>>> print(format_table(result))                                 # doctest: +SKIP

This package calls host executables and stands beside the four layers that make them: it may use all of them, and
none uses it.
"""

from epg.simulate.load_scenario import load_scenario
from epg.simulate.result import Result
from epg.simulate.run import simulate
from epg.simulate.table import format_table

__all__ = ["Result", "format_table", "load_scenario", "simulate"]
