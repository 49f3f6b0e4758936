// SPDX-License-Identifier: Apache-2.0
// The eight PWM slices (data sheet of the RP2040, 4.5), free-running, exact to the cycle.
//
// Compare values and TOP are double-buffered: a new value takes effect when the counter wraps, which `taken` reports.
// The modes in which channel B is an input are not simulated.
import { BasePeripheral, IRQ } from './package.mjs';

const SLICES = 8;
const CSR_ENABLE = 1;
const CSR_PHASE_CORRECT = 2;
const CSR_INVERT_A = 4;
const CSR_INVERT_B = 8;
const CSR_MODE = 0x30;

class Slice {
    constructor(pwm, index) {
        this.pwm = pwm;
        this.clock = pwm.clock;
        this.index = index;
        this.wrapAlarm = this.clock.createAlarm(() => this.wrap());
        this.levelAlarm = this.clock.createAlarm(() => this.updateLevels());
        this.reset();
    }

    reset() {
        this.csr = 0;
        this.divider = 16; // unit 1/16
        this.written = { a: 0, b: 0, top: 0xffff };
        this.a = this.b = 0; // the levels in effect
        this.top = 0xffff;
        this.held = 0; // counts into the period, while stopped
        this.start = 0; // start of the period, in 1/16 cycle
        this.wrapAlarm.cancel();
        this.levelAlarm.cancel();
        this.setLevels(0);
    }

    get running() {
        return (this.csr & CSR_ENABLE) !== 0;
    }

    /** Counts in one period: up only, or up and down. */
    get length() {
        return this.csr & CSR_PHASE_CORRECT ? 2 * (this.top + 1) : this.top + 1;
    }

    /** Number of counts since the start of the period. */
    get position() {
        return this.running ? Math.floor((this.clock.now * 16 - this.start) / this.divider) : this.held;
    }

    get counter() {
        return this.fold(this.position) & 0xffff;
    }

    fold(position) {
        return this.csr & CSR_PHASE_CORRECT && position > this.top ? 2 * this.top + 1 - position : position;
    }

    cycleOf(position) {
        return Math.ceil((this.start + position * this.divider) / 16);
    }

    read(offset) {
        switch (offset) {
            case 0x00:
                return this.csr;
            case 0x04:
                return this.divider;
            case 0x08:
                return this.counter;
            case 0x0c:
                return ((this.written.b << 16) | this.written.a) >>> 0;
            default:
                return this.written.top;
        }
    }

    write(offset, value) {
        switch (offset) {
            case 0x00:
                this.writeControl(value);
                return;
            case 0x04: {
                const { position } = this;
                this.divider = value & 0xfff || 16 * 256;
                this.moveTo(position);
                return;
            }
            case 0x08:
                this.moveTo(value & 0xffff);
                return;
            case 0x0c:
                this.written.a = value & 0xffff;
                this.written.b = value >>> 16;
                break;
            default:
                this.written.top = value & 0xffff;
        }
        if (!this.running) {
            this.take();
        }
    }

    writeControl(value) {
        if (value & CSR_MODE) {
            throw new Error(`PWM slice ${this.index}: channel B as an input is not simulated`);
        }
        const position = this.position + (value & 0x80 ? 1 : 0) - (value & 0x40 ? 1 : 0);
        this.csr = value & 0x3f;
        this.moveTo(position);
    }

    /** Changes the enable bits of several slices in the same cycle. */
    enable(on) {
        const { position } = this;
        this.csr = on ? this.csr | CSR_ENABLE : this.csr & ~CSR_ENABLE;
        this.moveTo(position);
    }

    moveTo(position) {
        this.held = position;
        this.start = this.clock.now * 16 - position * this.divider;
        if (this.running) {
            this.scheduleWrap();
        } else {
            this.wrapAlarm.cancel();
            this.take();
        }
        this.updateLevels();
    }

    scheduleWrap() {
        const { length, position } = this;
        this.wrapAlarm.at(this.cycleOf(position < length ? length : 0x10000)); // a counter beyond TOP runs up to 0xffff
    }

    wrap() {
        const { length, position } = this;
        this.start += (position > length ? 0x10000 : length) * this.divider;
        this.take();
        this.scheduleWrap();
        this.updateLevels();
        this.pwm.wrapped(this);
    }

    take() {
        const { a, b, top } = this.written;
        const changed = a !== this.a || b !== this.b || top !== this.top;
        this.a = a;
        this.b = b;
        this.top = top;
        if (changed) {
            this.pwm.machine.pwmTaken(this);
        }
    }

    updateLevels() {
        const { position } = this;
        const count = this.fold(position);
        const a = count < this.a !== ((this.csr & CSR_INVERT_A) !== 0);
        const b = count < this.b !== ((this.csr & CSR_INVERT_B) !== 0);
        this.setLevels((a ? 1 : 0) | (b ? 2 : 0));
        if (!this.running) {
            this.levelAlarm.cancel();
            return;
        }
        let next = Infinity;
        for (const level of [this.a, this.b]) {
            for (const edge of this.csr & CSR_PHASE_CORRECT ? [level, 2 * (this.top + 1) - level] : [level]) {
                if (edge > position && edge < next && level > 0 && level <= this.top) {
                    next = edge;
                }
            }
        }
        if (next < Infinity) {
            this.levelAlarm.at(this.cycleOf(next));
        } else {
            this.levelAlarm.cancel();
        }
    }

    setLevels(levels) {
        this.pwm.setLevels(this.index, levels);
    }
}

export class Pwm extends BasePeripheral {
    constructor(machine, chip) {
        super(chip, 'PWM');
        this.machine = machine;
        this.clock = machine.clock;
        this.gpioValue = 0;
        this.gpioDirection = 0xffffffff;
        this.raw = this.enabled = this.forced = 0;
        this.slices = Array.from({ length: SLICES }, (_, index) => new Slice(this, index));
    }

    reset() {
        this.slices.forEach((slice) => slice.reset());
        this.raw = this.enabled = this.forced = 0;
        this.updateInterrupt();
    }

    /** Slice = (gpio / 2) mod 8, channel = gpio mod 2 (4.5.2). */
    setLevels(index, levels) {
        const pins = (levels << (2 * index)) | (levels << (2 * index + 16));
        const mask = (3 << (2 * index)) | (3 << (2 * index + 16));
        const changed = (this.gpioValue ^ pins) & mask;
        if (changed) {
            this.gpioValue ^= changed;
            this.machine.pads?.refreshMask(changed & 0x3fffffff);
        }
    }

    wrapped(slice) {
        this.raw |= 1 << slice.index;
        this.machine.pwmWrapped(slice);
        this.updateInterrupt();
    }

    /** Channel B as an input, under the package's name. */
    gpioOnInput() {}

    updateInterrupt() {
        this.machine.setInterrupt(IRQ.PWM_WRAP, ((this.raw & this.enabled) | this.forced) !== 0);
    }

    readUint32(offset) {
        if (offset < 0xa0) {
            return this.slices[Math.floor(offset / 0x14)].read(offset % 0x14);
        }
        switch (offset) {
            case 0xa0:
                return this.slices.reduce((bits, slice) => bits | (slice.running ? 1 << slice.index : 0), 0);
            case 0xa4:
                return this.raw;
            case 0xa8:
                return this.enabled;
            case 0xac:
                return this.forced;
            case 0xb0:
                return (this.raw & this.enabled) | this.forced;
            default:
                return 0;
        }
    }

    writeUint32(offset, value) {
        if (offset < 0xa0) {
            this.slices[Math.floor(offset / 0x14)].write(offset % 0x14, value >>> 0);
            return;
        }
        switch (offset) {
            case 0xa0:
                for (const slice of this.slices) {
                    const on = (value & (1 << slice.index)) !== 0;
                    if (on !== slice.running) {
                        slice.enable(on);
                    }
                }
                return;
            case 0xa4:
                this.raw &= ~this.rawWriteValue;
                break;
            case 0xa8:
                this.enabled = value & 0xff;
                break;
            case 0xac:
                this.forced = value & 0xff;
                break;
            default:
                return;
        }
        this.updateInterrupt();
    }
}
