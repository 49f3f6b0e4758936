// SPDX-License-Identifier: Apache-2.0
// Incremental encoders outside the chip.  They drive two pins and count the edges that they have made.
import { Random } from './usb_host.mjs';

// Positive counts: A leads B.  Index = count modulo 4; bit 0 is A, bit 1 is B.
const PHASES = [0b00, 0b01, 0b11, 0b10];

export class Encoder {
    constructor(machine, pinA, pinB) {
        this.machine = machine;
        this.pinA = pinA;
        this.pinB = pinB;
        this.count = 0;
        this.dead = false; // a broken encoder: the pins keep their levels
        this.show();
    }

    show() {
        const phase = PHASES[this.count & 3];
        this.machine.pads.drive(this.pinA, phase & 1);
        this.machine.pads.drive(this.pinB, phase >> 1);
    }

    /** Makes one edge. */
    step(direction) {
        this.count += direction;
        if (!this.dead) {
            this.show();
        }
    }
}

/** Edges at given cycles: `edges` are pairs [cycle, direction] in order. */
export class ScheduledMotion {
    constructor(machine, encoder, edges) {
        this.encoder = encoder;
        this.edges = edges;
        this.next = 0;
        this.alarm = machine.clock.createAlarm(() => this.step(), true);
        this.arm();
    }

    arm() {
        if (this.next < this.edges.length) {
            this.alarm.at(this.edges[this.next][0]);
        }
    }

    step() {
        this.encoder.step(this.edges[this.next++][1]);
        this.arm();
    }

    stop() {
        this.alarm.cancel();
    }
}

/**
 * A random walk with reversals.  Edges are `shortest` to `longest` cycles apart; now and then `burst` edges in a row
 * have the shortest distance.  After each edge the direction reverses with the given probability.
 */
export class RandomWalk {
    constructor(machine, encoder, { seed = 1, shortest, longest, reversal = 0.1, burst = 0 }) {
        if (!(shortest >= 1 && longest >= shortest)) {
            throw new Error('a random walk needs 1 <= shortest <= longest');
        }
        this.machine = machine;
        this.encoder = encoder;
        this.random = new Random(seed);
        this.shortest = shortest;
        this.longest = longest;
        this.reversal = reversal;
        this.burst = burst;
        this.fast = 0;
        this.direction = 1;
        this.alarm = machine.clock.createAlarm(() => this.step(), true);
        this.arm();
    }

    arm() {
        let wait = this.shortest;
        if (this.fast > 0) {
            this.fast--;
        } else {
            wait += Math.floor(this.random.next() * (this.longest - this.shortest + 1));
            if (this.burst > 0 && this.random.next() < 0.02) {
                this.fast = this.burst;
            }
        }
        this.alarm.at(this.machine.clock.now + wait);
    }

    step() {
        if (this.random.next() < this.reversal) {
            this.direction = -this.direction;
        }
        this.encoder.step(this.direction);
        this.arm();
    }

    stop() {
        this.alarm.cancel();
    }
}

/** Constant speed: an edge every `interval` cycles, which need not be an integer. */
export class ConstantSpeed {
    constructor(machine, encoder, { interval, direction = 1 }) {
        if (!(interval >= 1)) {
            throw new Error('an interval is at least one cycle');
        }
        this.encoder = encoder;
        this.interval = interval;
        this.direction = direction;
        this.due = machine.clock.now + interval;
        this.alarm = machine.clock.createAlarm(() => this.step(), true);
        this.alarm.at(Math.round(this.due));
    }

    step() {
        this.encoder.step(this.direction);
        this.due += this.interval;
        this.alarm.at(Math.round(this.due));
    }

    stop() {
        this.alarm.cancel();
    }
}
