# SPDX-License-Identifier: Apache-2.0
"""RELbot, a robot with two driven wheels: position controller of the wheels, and plant.

Both are continuous-time models integrated with Runge-Kutta 4.
"""

from __future__ import annotations

from writer.model import Definition, define

_CONTROL = r"""
inputs
    PosLeft {rad}
    PosRight {rad}
    SetPosLeft {rad}
    SetPosRight {rad}
outputs
    LogLeft {rad}
    LogRight {rad}
    SteerLeft
    SteerRight
parameters
    @PID_Left@
    @PID_Right@
states
    PID_Left\pdstate : PID_Left\pdrate
    PID_Left\pistate : PID_Left\pirate
    PID_Right\pdstate : PID_Right\pdrate
    PID_Right\pistate : PID_Right\pirate
static
dynamic
    @dynamic@
output
    SteerLeft = PID_Left\output
    SteerRight = PID_Right\output
    LogLeft = PosLeft
    LogRight = PosRight
"""

_PARAMETERS = r"""@\kp = 2.0 {}
    @\tauD = 0.04 {s}
    @\beta = 0.3 {}
    @\tauI = 4.0 {s}
    @\limit = 1.0 {}
"""

# The integrator stops while the output is limited and the error would increase it further.
_DYNAMIC = r"""@\error = SetPos$ - Pos$
    @\pdout = @\pdstate + @\kp * @\error / @\beta
    @\pdrate = (@\kp * @\error - @\pdout) / (@\beta * @\tauD)
    @\sum = @\pistate + @\pdout
    @\output = if @\sum > @\limit then @\limit else (if @\sum < -@\limit then -@\limit else @\sum end) end
    @\windup = @\sum > @\limit and @\pdout > 0 or @\sum < -@\limit and @\pdout < 0
    @\pirate = if @\windup then 0 else @\pdout / @\tauI end
"""

_PLANT = r"""
inputs
    duty_left
    duty_right
outputs
    angle_left {rad}
    angle_right {rad}
    heading {rad}
    position_x {m}
    position_y {m}
parameters
    Supply\voltage = 12.0 {V}
    Drive\zone = 0.021 {}
    Motor\k = 0.0246 {N.m/A}
    Motor\R = 2.14 {ohm}
    Motor\J = 3.5e-6 {kg.m2}
    Motor\d = 3.333e-6 {N.m.s/rad}
    Gear\i = 0.06417777777777778 {}
    Wheel\radius = 0.0505 {m}
    Wheel\d = 0.008 {N.m.s/rad}
    Body\half_track = 0.104 {m}
    Body\mass = 1.288 {kg}
    Body\J = 0.013 {kg.m2}
states
    Left\angle : Left\speed
    Right\angle : Right\speed
    Body\sum : Body\sum_rate
    Body\difference : Body\difference_rate
    Body\heading : Body\turn
    Body\x : Body\vx
    Body\y : Body\vy
static
    Wheel\J = Motor\J / (Gear\i * Gear\i)
    Body\sum_J = Wheel\J + Body\mass * Wheel\radius * Wheel\radius / 2
    Body\difference_J = Wheel\J
        + Body\J * Wheel\radius * Wheel\radius / (2 * Body\half_track * Body\half_track)
dynamic
    Left\speed = (Body\sum - Body\difference) / 2
    Right\speed = (Body\sum + Body\difference) / 2
    @wheels@
    Body\sum_rate = (Left\torque + Right\torque) / Body\sum_J
    Body\difference_rate = (Right\torque - Left\torque) / Body\difference_J
    Body\turn = Wheel\radius * Body\difference / (2 * Body\half_track)
    Body\forward = Wheel\radius * Body\sum / 2
    Body\vx = Body\forward * cos (Body\heading)
    Body\vy = Body\forward * sin (Body\heading)
output
    angle_left = Left\angle
    angle_right = Right\angle
    heading = Body\heading
    position_x = Body\x
    position_y = Body\y
"""

_WHEEL = r"""@\drive = if duty_$ > Drive\zone then duty_$ - Drive\zone
        else (if duty_$ < -Drive\zone then duty_$ + Drive\zone else 0 end) end
    @\omega = @\speed / Gear\i
    @\current = (Supply\voltage * @\drive - Motor\k * @\omega) / Motor\R
    @\torque = (Motor\k * @\current - Motor\d * @\omega) / Gear\i - Wheel\d * @\speed
"""


def control() -> Definition:
    text = _CONTROL.replace("@PID_Left@", _PARAMETERS.replace("@", "PID_Left"))
    text = text.replace("@PID_Right@", _PARAMETERS.replace("@", "PID_Right"))
    wheels = "    ".join(_DYNAMIC.replace("@", f"PID_{side}").replace("$", side) for side in ("Left", "Right"))
    return define("RELbot_Control", "RungeKutta4", "0.002", "20.0", text.replace("@dynamic@", wheels))


def plant() -> Definition:
    wheels = "    ".join(_WHEEL.replace("@", side).replace("$", side.lower()) for side in ("Left", "Right"))
    return define("RELbot_Plant", "RungeKutta4", "0.0001", "20.0", _PLANT.replace("@wheels@", wheels))
