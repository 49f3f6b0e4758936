// SPDX-License-Identifier: Apache-2.0
// The watchdog (data sheet of the RP2040, 4.7): its counter, the cause of the last reset, eight words that survive it.
import { BasePeripheral } from './package.mjs';

const REASON_TIMER = 1;
const REASON_FORCE = 2;

/** The registers that a reset by the watchdog does not clear. */
export class WatchdogMemory {
    constructor() {
        this.reason = 0;
        this.scratch = new Uint32Array(8);
    }
}

export class Watchdog extends BasePeripheral {
    constructor(machine, chip, memory) {
        super(chip, 'WATCHDOG');
        this.machine = machine;
        this.clock = machine.clock;
        this.memory = memory;
        this.control = 0x07000000;
        this.tick = 0;
        this.left = 0; // remaining counts, while stopped
        this.endsAt = 0; // the cycle at which a running counter reaches 0
        this.alarm = this.clock.createAlarm(() => this.trigger(REASON_TIMER));
    }

    /** Cycles per count.  Erratum RP2040-E1: the watchdog counts twice per microsecond. */
    get scale() {
        return this.clock.frequency / 2e6;
    }

    get running() {
        return (this.control & 0x40000000) !== 0 && (this.tick & 0x200) !== 0;
    }

    get count() {
        return this.running ? Math.max(0, Math.ceil((this.endsAt - this.clock.now) / this.scale)) : this.left;
    }

    readUint32(offset) {
        if (offset >= 0x0c && offset <= 0x28) {
            return this.memory.scratch[(offset - 0x0c) >> 2];
        }
        switch (offset) {
            case 0x00:
                return (this.control | this.count) >>> 0;
            case 0x08:
                return this.memory.reason;
            case 0x2c:
                return this.tick | (this.tick & 0x200 ? 0x400 : 0);
            default:
                return 0;
        }
    }

    writeUint32(offset, value) {
        if (offset >= 0x0c && offset <= 0x28) {
            this.memory.scratch[(offset - 0x0c) >> 2] = value;
            return;
        }
        const at = this.count;
        switch (offset) {
            case 0x00:
                this.control = value & 0x47000000;
                this.runFrom(at);
                if (value & 0x80000000) {
                    this.trigger(REASON_FORCE);
                }
                return;
            case 0x04:
                this.runFrom(value & 0xffffff);
                return;
            case 0x2c:
                this.tick = value & 0x3ff;
                this.runFrom(at);
        }
    }

    runFrom(count) {
        this.left = count;
        this.alarm.cancel();
        if (this.running) {
            this.endsAt = this.clock.now + count * this.scale;
            this.alarm.at(this.endsAt);
        }
    }

    trigger(reason) {
        this.memory.reason = reason;
        this.machine.requestReset(reason === REASON_TIMER ? 'watchdog' : 'watchdog forced');
    }
}
