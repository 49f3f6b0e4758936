// SPDX-License-Identifier: Apache-2.0
// The microsecond timer and its four alarms (data sheet of the RP2040, 4.6), exact to the cycle.
import { BasePeripheral, IRQ } from './package.mjs';

const WORD = 2 ** 32;

export class Timer extends BasePeripheral {
    constructor(machine, chip) {
        super(chip, 'TIMER');
        this.machine = machine;
        this.clock = machine.clock;
        this.perMicrosecond = machine.clock.frequency / 1e6;
        this.alarms = [0, 1, 2, 3].map((n) => this.clock.createAlarm(() => this.fire(n)));
        this.reset();
    }

    reset() {
        this.origin = this.clock.now; // the cycle at which the time was 0
        this.stopped = null; // the time while paused
        this.latched = 0;
        this.written = 0;
        this.targets = [0, 0, 0, 0];
        this.armed = this.raw = this.enabled = this.forced = 0;
        this.alarms.forEach((alarm) => alarm.cancel());
        this.update();
    }

    get micros() {
        return this.stopped ?? Math.floor((this.clock.now - this.origin) / this.perMicrosecond);
    }

    set micros(value) {
        this.origin = this.clock.now - value * this.perMicrosecond;
        if (this.stopped !== null) {
            this.stopped = value;
        }
        this.rearm();
    }

    readUint32(offset) {
        switch (offset) {
            case 0x08:
                return this.latched;
            case 0x0c: {
                const { micros } = this;
                this.latched = Math.floor(micros / WORD);
                return micros % WORD;
            }
            case 0x10:
            case 0x14:
            case 0x18:
            case 0x1c:
                return this.targets[(offset - 0x10) >> 2];
            case 0x20:
                return this.armed;
            case 0x24:
                return Math.floor(this.micros / WORD);
            case 0x28:
                return this.micros % WORD;
            case 0x2c:
                return 7;
            case 0x30:
                return this.stopped === null ? 0 : 1;
            case 0x34:
                return this.raw;
            case 0x38:
                return this.enabled;
            case 0x3c:
                return this.forced;
            case 0x40:
                return (this.raw & this.enabled) | this.forced;
            default:
                return 0;
        }
    }

    writeUint32(offset, value) {
        switch (offset) {
            case 0x00:
                this.micros = (value >>> 0) * WORD + this.written;
                return;
            case 0x04:
                this.written = value >>> 0;
                return;
            case 0x10:
            case 0x14:
            case 0x18:
            case 0x1c: {
                const n = (offset - 0x10) >> 2;
                this.targets[n] = value >>> 0;
                this.armed |= 1 << n;
                this.rearm();
                return;
            }
            case 0x20:
                this.armed &= ~this.rawWriteValue;
                this.rearm();
                return;
            case 0x30:
                this.stopped = value & 1 ? this.micros : null;
                this.rearm();
                return;
            case 0x34:
                this.raw &= ~this.rawWriteValue;
                break;
            case 0x38:
                this.enabled = value & 15;
                break;
            case 0x3c:
                this.forced = value & 15;
                break;
            default:
                return;
        }
        this.update();
    }

    /** An enabled alarm fires when the low word of the time equals its target. */
    rearm() {
        const now = this.micros;
        this.alarms.forEach((alarm, n) => {
            alarm.cancel();
            if (this.armed & (1 << n) && this.stopped === null) {
                const wait = (this.targets[n] - now) >>> 0 || WORD;
                alarm.at(Math.ceil(this.origin + (now + wait) * this.perMicrosecond));
            }
        });
    }

    fire(n) {
        this.armed &= ~(1 << n);
        this.raw |= 1 << n;
        this.update();
    }

    update() {
        const status = (this.raw & this.enabled) | this.forced;
        for (let n = 0; n < 4; n++) {
            this.machine.setInterrupt(IRQ.TIMER_0 + n, (status & (1 << n)) !== 0);
        }
    }
}
