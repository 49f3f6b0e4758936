# SPDX-License-Identifier: Apache-2.0
"""A motor of first order with Coulomb friction, solved exactly.

The speed w follows ``tau dw/dt + w = gain (duty - friction sign(w))``.  A motor at rest stays at rest while
\\|duty\\| <= friction.  The duty is constant between its changes, so each piece has a solution in closed form:
``w(t) = v + (w(0) - v) exp(-t / tau)`` with ``v = gain (duty - friction sign(w))``, until w reaches 0.

All values are proportional to the gain, if the first speed is.  Therefore this module computes with a gain of 1.
"""

from __future__ import annotations

import math
from bisect import bisect_left
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

    # Lists, because single values of an array are slow.
    times: list[float] = time.tolist()
    result = [0.0] * len(times)
    exp = math.exp
    begin, position, done, end_of_all = times[0], 0.0, 0, times[-1]
    stops = [*np.searchsorted(time, changes[1:], side="left").tolist(), len(times)]
    for end, stop, duty in zip([*changes[1:], math.inf], stops, duties, strict=True):
        last = end if end < end_of_all else end_of_all
        while begin < last or done < stop:
            # The final speed of this piece, and its end: that of the duty, or the time at which the motor stops.
            if speed:
                final = duty - math.copysign(friction, speed)
            else:
                final = 0.0 if abs(duty) <= friction else duty - math.copysign(friction, duty)
            until, upto, rests = last, stop, False
            if speed * final < 0.0:
                reversal = begin + tau * math.log1p(-speed / final)
                if reversal <= last:
                    until, upto, rests = reversal, bisect_left(times, reversal, done, stop), True
            slip = (speed - final) * tau
            if upto - done > FEW:
                elapsed = time[done:upto] - begin
                result[done:upto] = (position + final * elapsed - slip * np.expm1(-elapsed / tau)).tolist()
            else:
                for at in range(done, upto):
                    length = times[at] - begin
                    result[at] = position + final * length + slip * (1.0 - exp(-length / tau))
            done = upto
            length = until - begin
            decay = exp(-length / tau)
            position += final * length + slip * (1.0 - decay)
            speed = 0.0 if rests else final + (speed - final) * decay
            begin = until
            if begin >= last and not rests:
                break
    return np.array(result)
