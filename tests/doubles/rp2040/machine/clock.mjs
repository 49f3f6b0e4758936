// SPDX-License-Identifier: Apache-2.0
// Simulated time in cycles of clk_sys, and the alarms that are called at a given cycle.

export class Alarm {
    constructor(clock, callback, durable) {
        this.clock = clock;
        this.durable = durable; // survives a reset of the chip
        this.callback = callback;
        this.cycle = 0;
        this.scheduled = false;
        this.next = null;
    }

    /** Calls back at `cycle`, or at once if that has passed; replaces an earlier request. */
    at(cycle) {
        if (this.scheduled) {
            this.cancel();
        }
        this.cycle = cycle > this.clock.now ? cycle : this.clock.now;
        this.scheduled = true;
        this.clock.insert(this);
    }

    cancel() {
        if (this.scheduled) {
            this.scheduled = false;
            this.clock.remove(this);
        }
    }

    /** The same with a delay, under the name that the package uses. */
    schedule(nanoseconds) {
        this.at(this.clock.now + Math.ceil(nanoseconds / this.clock.nanosecondsPerCycle));
    }
}

/** Calls alarms of the same cycle in the order in which they were requested. */
export class CycleClock {
    constructor(frequency) {
        this.frequency = frequency;
        this.nanosecondsPerCycle = 1e9 / frequency;
        this.now = 0;
        this.first = null;
    }

    get nextCycle() {
        return this.first === null ? Infinity : this.first.cycle;
    }

    /** Moves the time to the next alarm and calls it. */
    fireNext() {
        const alarm = this.first;
        this.first = alarm.next;
        alarm.scheduled = false;
        this.now = alarm.cycle;
        alarm.callback();
    }

    /** `durable`: the alarm belongs to something outside the chip, which a reset of the chip does not affect. */
    createAlarm(callback, durable = false) {
        return new Alarm(this, callback, durable);
    }

    /** The chip is reset: cancels the alarms of its peripherals. */
    forgetChip() {
        for (let item = this.first; item !== null; item = item.next) {
            if (!item.durable) {
                item.cancel();
            }
        }
    }

    insert(alarm) {
        let before = null;
        let after = this.first;
        while (after !== null && after.cycle <= alarm.cycle) {
            before = after;
            after = after.next;
        }
        alarm.next = after;
        if (before === null) {
            this.first = alarm;
        } else {
            before.next = alarm;
        }
    }

    remove(alarm) {
        let before = null;
        let item = this.first;
        while (item !== alarm) {
            before = item;
            item = item.next;
        }
        if (before === null) {
            this.first = alarm.next;
        } else {
            before.next = alarm.next;
        }
    }

    // The functions of a clock that the package's peripherals call.
    get nanos() {
        return this.now * this.nanosecondsPerCycle;
    }

    get micros() {
        return this.nanos / 1000;
    }
}
