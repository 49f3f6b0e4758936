// SPDX-License-Identifier: Apache-2.0
// A DC motor behind an H-bridge, with gear, inertia, friction and end stops, that turns an encoder.
//
// Between two changes of the bridge's state, the motion is solved exactly (zero-order hold).  At duty d
//
//   J dw/dt = k (V d - k w) / R - b w - c sign(w),    d theta/dt = w
//
// on the motor's shaft, with Coulomb friction c, which also holds a motor at rest.  Duty is the mean of a PWM period
// and changes when a period begins; direction pins act at once.  Each edge of the encoder comes at the instant at which
// the shaft passes it.

const STEP = 1e-4; // s; the longest interval that is solved at once, for the encoder's edges

export const JIWY = {
    pan: {
        constant: 0.018, resistance: 12, supply: 12, inertia: 2.06e-7 + 3.0e-4 / 19 ** 2,
        friction: 1.77e-6 + 2.0e-4 / 19 ** 2, gear: 1 / 19, countsPerRadian: 1112 / Math.PI,
    },
    tilt: {
        constant: 0.00701, resistance: 12, supply: 12, inertia: 5.28e-8 + 4.5e-5 * (0.25 / 19) ** 2,
        friction: 4.0e-7 + 1.0e-4 * (0.25 / 19) ** 2, gear: 0.25 / 19, countsPerRadian: 221 / (Math.PI / 2),
    },
};

export class Motor {
    /**
     * `bridge`: {slice, channel, pinA, pinB} for one PWM output and two direction pins, or {slice, channel, slice2,
     * channel2} for a bridge with two PWM inputs.  `parameters`: see JIWY.  `coulomb` is in N m (1 % of the stall
     * torque), `stops` the [lowest, highest] angle of the load in rad, or null, and `angle` the angle at the start.
     */
    constructor(machine, encoder, bridge, parameters) {
        this.machine = machine;
        this.encoder = encoder;
        this.bridge = bridge;
        const p = parameters;
        this.p = p;
        this.secondsPerCycle = 1 / machine.clock.frequency;
        this.damping = p.friction + p.constant ** 2 / p.resistance;
        this.coulomb = p.coulomb ?? (0.01 * p.constant * p.supply) / p.resistance;
        this.stops = p.stops ?? null;
        this.speed = 0; // of the motor's shaft, rad/s
        this.angle = p.angle ?? 0; // of the load, rad
        this.time = machine.clock.now;
        this.drive = this.readBridge();
        this.offset = Math.floor(this.angle * p.countsPerRadian);
        this.stepAlarm = machine.clock.createAlarm(() => this.step(), true);
        this.edgeAlarm = machine.clock.createAlarm(() => this.edge(), true);
        this.edges = [];
        machine.onPwmTaken.push((slice) => this.watches(slice.index) && this.bridgeChanged());
        machine.onPin.push((pin) => (pin === bridge.pinA || pin === bridge.pinB) && this.bridgeChanged());
        machine.onReset.push(() => this.bridgeChanged());
        this.step();
    }

    watches(slice) {
        return slice === this.bridge.slice || slice === this.bridge.slice2;
    }

    /** The duty, -1 ... 1, and the state of the bridge: it drives, brakes or coasts. */
    readBridge() {
        const { bridge, machine } = this;
        const value = this.dutyOf(bridge.slice, bridge.channel);
        if (bridge.slice2 !== undefined) {
            const other = this.dutyOf(bridge.slice2, bridge.channel2);
            const mode = value === 0 && other === 0 ? 'coast' : 'drive';
            return { duty: value - other, mode };
        }
        const a = (machine.pads.levels >>> bridge.pinA) & 1;
        const b = (machine.pads.levels >>> bridge.pinB) & 1;
        if (a === b) {
            return { duty: 0, mode: a ? 'brake' : 'coast' };
        }
        return { duty: a ? value : -value, mode: 'drive' };
    }

    dutyOf(index, channel) {
        const slice = this.machine.pwm.slices[index];
        const pin = 2 * index + channel;
        const connected = [pin, pin + 16].some((n) => n < 30 && this.machine.pads.state(n).function === 4);
        if (!slice.running || !connected) {
            return 0;
        }
        return Math.min(1, (channel === 0 ? slice.a : slice.b) / (slice.top + 1));
    }

    bridgeChanged() {
        const drive = this.readBridge();
        if (drive.duty !== this.drive.duty || drive.mode !== this.drive.mode) {
            this.advance();
            this.drive = drive;
            this.predict();
        }
    }

    step() {
        this.advance();
        this.predict();
    }

    /** Computes the state at the present cycle. */
    advance() {
        const { now } = this.machine.clock;
        this.move(this, (now - this.time) * this.secondsPerCycle);
        this.time = now;
    }

    /** The acceleration by bridge and damping, as w' = gain - rate w, without friction. */
    get dynamics() {
        const { p, drive } = this;
        const damping = drive.mode === 'coast' ? p.friction : this.damping;
        const torque = (p.constant * p.supply * drive.duty) / p.resistance;
        return { gain: torque / p.inertia, rate: damping / p.inertia, dry: this.coulomb / p.inertia };
    }

    /** Moves `state` (speed, angle) by `duration` with the present state of the bridge. */
    move(state, duration) {
        const { gain, rate, dry } = this.dynamics;
        let left = duration;
        while (left > 0) {
            let direction = Math.sign(state.speed);
            if (direction === 0) {
                if (Math.abs(gain) <= dry || this.againstStop(state, Math.sign(gain))) {
                    return;
                }
                direction = Math.sign(gain);
            }
            const final = (gain - direction * dry) / rate;
            const excess = state.speed - final;
            let span = left;
            if (final * direction < 0) { // the motor comes to rest within the interval
                span = Math.min(span, Math.log(excess / -final) / rate);
            }
            const decay = Math.exp(-rate * span);
            const turned = final * span + (excess * (1 - decay)) / rate;
            state.speed = span < left ? 0 : final + excess * decay;
            state.angle += turned * this.p.gear;
            left -= span;
            this.limit(state);
        }
    }

    againstStop(state, direction) {
        return this.stops !== null && ((direction < 0 && state.angle <= this.stops[0]) ||
            (direction > 0 && state.angle >= this.stops[1]));
    }

    /** At an end stop, the speed becomes 0. */
    limit(state) {
        if (this.stops === null) {
            return;
        }
        if (state.angle < this.stops[0]) {
            state.angle = this.stops[0];
            state.speed = 0;
        } else if (state.angle > this.stops[1]) {
            state.angle = this.stops[1];
            state.speed = 0;
        }
    }

    /** Predicts the encoder's edges in the next interval, if the bridge does not change. */
    predict() {
        const { now, frequency } = this.machine.clock;
        this.stepAlarm.at(now + Math.round(STEP * frequency));
        this.edges = [];
        const end = { speed: this.speed, angle: this.angle };
        this.move(end, STEP);
        const from = this.encoder.count + this.offset;
        const to = Math.floor(end.angle * this.p.countsPerRadian);
        const direction = Math.sign(to - from);
        const start = this.angle * this.p.countsPerRadian;
        const span = end.angle * this.p.countsPerRadian - start;
        for (let count = from; count !== to; count += direction) {
            const line = direction > 0 ? count + 1 : count; // down, the count changes at the line that it began with
            const share = span === 0 ? 0 : Math.min(1, Math.max(0, (line - start) / span));
            this.edges.push([now + Math.round(share * STEP * frequency), direction]);
        }
        this.armEdge();
    }

    armEdge() {
        if (this.edges.length > 0) {
            this.edgeAlarm.at(this.edges[0][0]);
        } else {
            this.edgeAlarm.cancel();
        }
    }

    edge() {
        const [, direction] = this.edges.shift();
        this.encoder.step(direction);
        this.armEdge();
    }
}
