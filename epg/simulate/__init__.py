# SPDX-License-Identifier: Apache-2.0
"""Runs targets and systems in closed loop with simulated plants: scenarios, setpoints, tracking errors and plots.

>>> from epg.simulate import simulate, format_table             # doctest: +SKIP
>>> result = simulate(Path("build/jiwy_host"), Path("tracking.yaml"), Path("results"))  # doctest: +SKIP
>>> print(format_table(result))                                 # doctest: +SKIP

This package only runs programs.  It does not import the layers that make them.
"""

from epg.simulate.load_scenario import load_scenario
from epg.simulate.result import SimulationResult
from epg.simulate.result_table import format_table
from epg.simulate.run import simulate
from epg.simulate.run_system import SystemResult, simulate_system

__all__ = ["SimulationResult", "SystemResult", "format_table", "load_scenario", "simulate", "simulate_system"]
