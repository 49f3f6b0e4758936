# SPDX-License-Identifier: Apache-2.0
"""Runs host executables in closed loop with a simulated plant: scenarios, setpoints, tracking errors and plots.

>>> from epg.simulate import simulate, format_table             # doctest: +SKIP
>>> result = simulate(Path("build/jiwy_host"), Path("tracking.yaml"), Path("results"))  # doctest: +SKIP
>>> print(format_table(result))                                 # doctest: +SKIP

This package only runs host executables.  It does not import the layers that make them.
"""

from epg.simulate.load_scenario import load_scenario
from epg.simulate.result import Result
from epg.simulate.run import simulate
from epg.simulate.table import format_table

__all__ = ["Result", "format_table", "load_scenario", "simulate"]
