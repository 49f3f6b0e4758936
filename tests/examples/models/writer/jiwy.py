# SPDX-License-Identifier: Apache-2.0
"""JIWY, a camera with a pan and a tilt axis: controller and plant.

The numbers are those published for the laboratory's robots.  ``examples/jiwy/README.md`` lists their sources, and the
two numbers that EPG has chosen (winding resistance, Coulomb friction).
"""

from __future__ import annotations

from writer.model import Definition, define

# Per axis.  The modes are 0 approach, 1 release, 2 reset, 3 settle, 4 control, 5 failed.
_AXIS_CONTROL = {
    "parameters": r"""
    @\Homing\duty = DUTY {}
    @\Homing\band = BAND {rad}
    @\Homing\standstill = 0.2 {s}
    @\Homing\margin = 0.1 {rad}
    @\Homing\wrong = 0.25 {rad}
    @\Homing\pulse = 0.005 {s}
    @\Homing\settle = 0.2 {s}
    @\Homing\limit = 6.0 {s}
    @\Reference\speed = 1.0 {rad/s}
    @\PID\kp = KP {}
    @\PID\tauD = 0.05 {s}
    @\PID\beta = 0.17 {}
    @\PID\tauI = TAUI {s}
    @\Limiter\minimum = -0.99 {}
    @\Limiter\maximum = 0.99 {}
""",
    "states": r"""
    @\Homing\mode_previous : @\Homing\mode
    @\Homing\elapsed_previous : @\Homing\elapsed
    @\Homing\phase_previous : @\Homing\phase
    @\Homing\origin_previous : @\Homing\origin
    @\Homing\mark_previous : @\Homing\mark
    @\Homing\still_previous : @\Homing\still
    @\Reference\output_previous : @\Reference\output
    @\Reference\following_previous : @\Reference\following
    @\PID\error_previous : @\PID\error
    @\PID\uD_previous : @\PID\uD
    @\PID\uI_previous : @\PID\uI
""",
    "static": r"""
    @\PID\factor = 1 / (sampletime + @\PID\tauD * @\PID\beta)
    @\Reference\step = @\Reference\speed * sampletime
""",
    # Position since the start of the present motion; time within a narrow band; the next mode; duty
    "dynamic": r"""
    @\Homing\first = @\Homing\elapsed_previous < 1.5 * sampletime
    @\Homing\from = if @\Homing\first then position_$ else @\Homing\origin_previous end
    @\Homing\moved = position_$ - @\Homing\from
    @\Homing\left = @\Homing\first or abs (position_$ - @\Homing\mark_previous) > @\Homing\band
    @\Homing\quiet = if @\Homing\left then 0 else @\Homing\still_previous + sampletime end
    @\Homing\standing = @\Homing\quiet >= @\Homing\standstill
    @\Homing\late = @\Homing\elapsed_previous >= @\Homing\limit
    @\Homing\approach = if @\Homing\late or @\Homing\moved > @\Homing\wrong then 5
        else (if not @\Homing\standing then 0 else (if @\Homing\moved < -@\Homing\margin then 2 else 1 end) end) end
    @\Homing\release = if @\Homing\late or @\Homing\moved < -@\Homing\wrong then 5
        else (if @\Homing\moved > @\Homing\margin then 0 else 1 end) end
    @\Homing\reset = if @\Homing\phase_previous >= @\Homing\pulse then 3 else 2 end
    @\Homing\rest = if @\Homing\phase_previous < @\Homing\settle then 3
        else (if abs (position_$) > @\Homing\margin then 5 else 4 end) end
    @\Homing\mode = if @\Homing\mode_previous == 0 then @\Homing\approach
        else (if @\Homing\mode_previous == 1 then @\Homing\release
        else (if @\Homing\mode_previous == 2 then @\Homing\reset
        else (if @\Homing\mode_previous == 3 then @\Homing\rest else @\Homing\mode_previous end) end) end) end
    @\Homing\changed = @\Homing\mode <> @\Homing\mode_previous
    @\Homing\elapsed = if @\Homing\mode < 2 then @\Homing\elapsed_previous + sampletime
        else @\Homing\elapsed_previous end
    @\Homing\phase = if @\Homing\changed then 0 else @\Homing\phase_previous + sampletime end
    @\Homing\origin = if @\Homing\changed then position_$ else @\Homing\from end
    @\Homing\mark = if @\Homing\changed or @\Homing\left then position_$ else @\Homing\mark_previous end
    @\Homing\still = if @\Homing\changed then 0 else @\Homing\quiet end
    @\Homing\output = if @\Homing\mode == 0 then -@\Homing\duty
        else (if @\Homing\mode == 1 then @\Homing\duty else 0 end) end
    @\control = @\Homing\mode == 4
    @\Reference\distance = setpoint_$ - @\Reference\output_previous
    @\Reference\following = @\control and (@\Reference\following_previous > 0
        or abs (@\Reference\distance) <= @\Reference\step)
    @\Reference\towards = if @\Reference\distance > 0 then @\Reference\output_previous + @\Reference\step
        else @\Reference\output_previous - @\Reference\step end
    @\Reference\output = if not @\control then position_$
        else (if @\Reference\following then setpoint_$ else @\Reference\towards end) end
    @\PID\error = @\Reference\output - position_$
    @\PID\uD = if not @\control then @\PID\kp * @\PID\error
        else @\PID\factor * (@\PID\tauD * @\PID\uD_previous * @\PID\beta
        + @\PID\tauD * @\PID\kp * (@\PID\error - @\PID\error_previous) + sampletime * @\PID\kp * @\PID\error) end
    @\PID\integral = @\PID\uI_previous + sampletime * @\PID\uD / @\PID\tauI
    @\PID\sum = @\PID\integral + @\PID\uD
    @\PID\windup = @\PID\sum > @\Limiter\maximum and @\PID\uD > 0 or @\PID\sum < @\Limiter\minimum and @\PID\uD < 0
    @\PID\uI = if not @\control then 0 else (if @\PID\windup then @\PID\uI_previous else @\PID\integral end) end
    @\PID\output = @\PID\uI + @\PID\uD
    @\Limiter\output = if @\PID\output < @\Limiter\minimum then @\Limiter\minimum
        else (if @\PID\output > @\Limiter\maximum then @\Limiter\maximum else @\PID\output end) end
""",
    "output": r"""
    encoder_reset_$ = if @\Homing\mode == 2 then 1 else 0 end
    pwm_$ = if @\control then @\Limiter\output else @\Homing\output end
    $_logging = position_$
""",
}

_AXIS_PLANT = {
    "parameters": r"""
    @\start = START {rad}
    @\Motor\k = K {N.m/A}
    @\Motor\R = 12.0 {ohm}
    @\Motor\J = JM {kg.m2}
    @\Motor\d = DM {N.m.s/rad}
    @\Motor\coulomb = COULOMB {N.m}
    @\Motor\creep = 0.2 {rad/s}
    @\Gear\i = 0.05263157894736842 {}
    @\Belt\i = BELT {}
    @\Camera\J = JC {kg.m2}
    @\Camera\d = DC {N.m.s/rad}
    @\Stop\lower = 0.0 {rad}
    @\Stop\upper = UPPER {rad}
    @\Stop\k = 100.0 {N.m/rad}
    @\Stop\d = 0.2 {N.m.s/rad}
""",
    "states": r"""
    @\Motor\omega : @\Motor\acceleration
    @\Camera\travel : @\Camera\speed
""",
    "static": r"""
    @\i = @\Gear\i * @\Belt\i
    @\J = @\Motor\J + @\i * @\i * @\Camera\J
    @\d = @\Motor\d + @\i * @\i * @\Camera\d
""",
    "dynamic": r"""
    @\Camera\speed = @\i * @\Motor\omega
    @\Camera\angle = @\start + @\Camera\travel
    @\Motor\current = (Supply\voltage * duty_$ - @\Motor\k * @\Motor\omega) / @\Motor\R
    @\Motor\slip = @\Motor\omega / @\Motor\creep
    @\Motor\friction = if @\Motor\slip > 1 then @\Motor\coulomb
        else (if @\Motor\slip < -1 then -@\Motor\coulomb else @\Motor\coulomb * @\Motor\slip end) end
    @\Stop\below = @\Stop\k * (@\Stop\lower - @\Camera\angle) - @\Stop\d * @\Camera\speed
    @\Stop\above = @\Stop\k * (@\Camera\angle - @\Stop\upper) + @\Stop\d * @\Camera\speed
    @\Stop\torque = if @\Camera\angle < @\Stop\lower and @\Stop\below > 0 then @\Stop\below
        else (if @\Camera\angle > @\Stop\upper and @\Stop\above > 0 then -@\Stop\above else 0 end) end
    @\Motor\acceleration = (@\Motor\k * @\Motor\current - @\d * @\Motor\omega - @\Motor\friction
        + @\i * @\Stop\torque) / @\J
""",
    "output": r"""
    angle_$ = @\Camera\angle
""",
}

_CONTROL_VALUES = {
    "Pan": {"DUTY": "0.05", "BAND": "0.02", "KP": "2.6", "TAUI": "9.0"},
    "Tilt": {"DUTY": "0.06", "BAND": "0.02", "KP": "1.6", "TAUI": "10.5"},
}

# Coulomb friction is 1 % of the stall torque, k * 12 V / 12 ohm.
_PLANT_VALUES = {
    "Pan": {
        "START": "1.2",
        "K": "0.018",
        "JM": "2.06e-7",
        "DM": "1.77e-6",
        "COULOMB": "1.8e-4",
        "BELT": "1.0",
        "JC": "3.0e-4",
        "DC": "2.0e-4",
        "UPPER": "3.141592653589793",
    },
    "Tilt": {
        "START": "0.7",
        "K": "0.00701",
        "JM": "5.28e-8",
        "DM": "4.0e-7",
        "COULOMB": "7.01e-5",
        "BELT": "0.25",
        "JC": "4.5e-5",
        "DC": "1.0e-4",
        "UPPER": "1.5707963267948966",
    },
}


def control() -> Definition:
    ports = """
inputs
    position_pan {rad}
    position_tilt {rad}
    setpoint_pan {rad}
    setpoint_tilt {rad}
outputs
    encoder_reset_pan
    encoder_reset_tilt
    pan_logging {rad}
    pwm_pan
    pwm_tilt
    tilt_logging {rad}
"""
    return define("JIWY_Control", "Discrete", "0.001", "20.0", ports + _axes(_AXIS_CONTROL, _CONTROL_VALUES, ""))


def plant() -> Definition:
    ports = """
inputs
    duty_pan
    duty_tilt
outputs
    angle_pan {rad}
    angle_tilt {rad}
"""
    supply = "    Supply\\voltage = 12.0 {V}\n"
    return define("JIWY_Plant", "RungeKutta4", "0.0001", "20.0", ports + _axes(_AXIS_PLANT, _PLANT_VALUES, supply))


def _axes(sections: dict[str, str], values: dict[str, dict[str, str]], shared: str) -> str:
    """Both axes' copies of each section; ``@`` is replaced by Pan or Tilt, ``$`` by pan or tilt."""
    text = ""
    for section, rows in sections.items():
        text += f"{section}\n" + (shared if section == "parameters" else "")
        for axis, numbers in values.items():
            mine = rows.replace("@", axis).replace("$", axis.lower())
            if section == "parameters":
                for key, number in numbers.items():
                    mine = mine.replace(f"= {key} ", f"= {number} ")
            text += mine.lstrip("\n")
    return text
