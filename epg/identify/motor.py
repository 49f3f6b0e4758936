# SPDX-License-Identifier: Apache-2.0
"""A motor of first order with Coulomb friction, solved exactly.

The speed w follows ``tau dw/dt + w = gain (duty - friction sign(w))``.  A motor at rest stays at rest while
\\|duty\\| <= friction.  The duty is constant between its changes, so each piece has a solution in closed form:
``w(t) = v + (w(0) - v) exp(-t / tau)`` with ``v = gain (duty - friction sign(w))``, until w reaches 0.

All values are proportional to the gain, if the first speed is.  Therefore this module computes with a gain of 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

FEW = 6
"""A piece with fewer samples is computed without numpy, which has a fixed cost per call."""


def travel(
    time: Any, changes: Sequence[float], duties: Sequence[float], tau: float, friction: float, speed: float
) -> Any:
    """The positions at ``time`` of a motor with gain 1 that begins at 0 with ``speed``, as an array of numpy.

    ``duties[i]`` acts from ``changes[i]`` on, and the first one before, too.  ``time`` increases; its first value is
    the begin.
    """
    import numpy as np

    result = np.empty(len(time))
    begin, position = float(time[0]), 0.0
    # The samples of each piece: those before its end.
    ends = [*changes[1:], math.inf]
    stops = [*np.searchsorted(time, changes[1:], side="left").tolist(), len(time)]
    done = 0
    for end, stop, duty in zip(ends, stops, duties, strict=True):
        last = min(end, float(time[-1]))
        while begin < last or done < stop:
            sign = math.copysign(1.0, speed) if speed else math.copysign(1.0, duty)
            final = 0.0 if speed == 0.0 and abs(duty) <= friction else duty - friction * sign
            until, rests = last, False
            if speed * final < 0.0:
                reversal = begin + tau * math.log1p(-speed / final)
                if reversal <= last:
                    until, rests = reversal, True
            upto = stop if not rests else done + int(np.searchsorted(time[done:stop], until, side="left"))
            count = upto - done
            if count > FEW:
                elapsed = time[done:upto] - begin
                part = final * elapsed
                part -= (speed - final) * tau * np.expm1(-elapsed / tau)
                result[done:upto] = position + part
            else:
                for at in range(done, upto):
                    result[at] = position + _moved(float(time[at]) - begin, speed, final, tau)
            done = upto
            length = until - begin
            position += _moved(length, speed, final, tau)
            speed = 0.0 if rests else final + (speed - final) * math.exp(-length / tau)
            begin = until
            if begin >= last and not rests:
                break
    return result


def _moved(elapsed: float, speed: float, final: float, tau: float) -> float:
    return final * elapsed - (speed - final) * tau * math.expm1(-elapsed / tau)
