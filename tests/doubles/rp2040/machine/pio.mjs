// SPDX-License-Identifier: Apache-2.0
// A PIO block (data sheet of the RP2040, 3), synchronous to the processors to the cycle.
//
// A block whose state machines are visible outside only through its registers runs late: it is brought up to date when
// a processor reads it, and the changes of its inputs are applied at the cycles at which they happened.  A block that
// drives pins, raises interrupts or shares flags runs cycle by cycle.
import { BasePeripheral } from './package.mjs';
import { StateMachine } from './pio_machine.mjs';

const SYNCHRONISER = 2; // cycles from pad to state machine (3.5.6.3)
const LATE_INPUTS = 4096; // number of input changes after which the block is brought up to date

export class PioBlock extends BasePeripheral {
    constructor(machine, chip, index, firstInterrupt) {
        super(chip, `PIO${index}`);
        this.machine = machine;
        this.index = index;
        this.firstInterrupt = firstInterrupt;
        this.time = 0; // all cycles before this one are executed
        this.instructions = new Uint32Array(32);
        this.pins = 0; // as the state machines see them
        this.inputCycles = [];
        this.inputWords = [];
        this.inputHead = 0;
        this.pinValues = 0; // names that the package's pins read
        this.pinDirections = 0;
        this.machines = []; // the package searches this for state machines that wait for a pin
        this.shared = false; // true if state machines share flags, or are visible outside
        this.forced = false; // lockstep on request
        this.units = [0, 1, 2, 3].map((unit) => new StateMachine(this, unit));
        this.reset();
    }

    reset() {
        this.instructions.fill(0);
        this.flags = 0;
        this.debug = 0;
        this.bypass = 0;
        this.enables = [0, 0]; // of the two interrupt lines
        this.forces = [0, 0];
        this.pinValues = this.pinDirections = 0;
        this.units.forEach((unit) => unit.reset());
        this.lockstep = false;
        this.update();
    }

    // Time ---------------------------------------------------------------------------------------------------------

    inputsChanged() {
        const now = this.machine.clock.now;
        const { inputs } = this.machine.pads;
        const last = this.inputCycles.length - 1;
        const cycle = now + (this.bypass ? 0 : SYNCHRONISER);
        if (last >= this.inputHead && this.inputCycles[last] >= cycle) {
            this.inputWords[last] = inputs;
            return;
        }
        this.inputCycles.push(cycle);
        this.inputWords.push(inputs);
        if (this.inputCycles.length - this.inputHead > LATE_INPUTS) {
            this.advance(now);
        }
    }

    /** Executes all cycles before `end`. */
    advance(end) {
        while (this.time < end) {
            const change = this.inputHead < this.inputCycles.length ? this.inputCycles[this.inputHead] : Infinity;
            if (change <= this.time) {
                this.pins = this.inputWords[this.inputHead++];
                continue;
            }
            this.runUnits(change < end ? change : end);
        }
        if (this.inputHead === this.inputCycles.length && this.inputHead > 0) {
            this.inputCycles.length = this.inputWords.length = this.inputHead = 0;
        }
    }

    runUnits(end) {
        if (this.lockstep) {
            const [a, b, c, d] = this.units;
            for (let cycle = this.time; cycle < end; cycle++) {
                this.time = cycle;
                for (const unit of [a, b, c, d]) {
                    if (unit.enabled && unit.time <= cycle) {
                        unit.execute();
                    }
                }
            }
        } else {
            for (const unit of this.units) {
                if (unit.enabled && unit.time < end) {
                    unit.run(end);
                }
            }
        }
        this.time = end;
    }

    /** Decides how the block runs: late, if its state machines are visible only through registers. */
    analyse() {
        const running = this.units.some((unit) => unit.enabled);
        let outputs = this.enables[0] !== 0 || this.enables[1] !== 0 || this.units.some((unit) => unit.sideCount > 0);
        let waits = false;
        for (const instruction of this.instructions) {
            const target = (instruction >>> 5) & 7;
            switch (instruction >>> 13) {
                case 1:
                    waits ||= (target & 3) === 2;
                    break;
                case 3:
                    outputs ||= target === 0 || target === 4 || target === 7;
                    break;
                case 5:
                    outputs ||= target === 0 || target === 4;
                    break;
                case 6:
                    waits ||= (instruction & 0x20) !== 0;
                    break;
                case 7:
                    outputs ||= target === 0 || target === 4;
                    break;
                default:
            }
        }
        this.shared = running && (outputs || waits);
        this.lockstep = this.shared || (running && this.forced);
        this.machine.lockstepChanged();
    }

    // Effects of state machines on the block ------------------------------------------------------------------------

    output(directions, base, count, data, cycle) {
        let mask = count >= 32 ? 0xffffffff : (1 << count) - 1;
        mask = base === 0 ? mask : (mask << base) | (mask >>> (32 - base));
        const bits = base === 0 ? data : (data << base) | (data >>> (32 - base));
        const name = directions ? 'pinDirections' : 'pinValues';
        const changed = (this[name] ^ bits) & mask & 0x3fffffff;
        if (changed) {
            this[name] ^= changed;
            this.machine.pioOutput(changed, cycle);
        }
    }

    setFlags(flags) {
        this.flags = flags & 0xff;
        this.update();
    }

    fifoChanged() {
        if (this.enables[0] !== 0 || this.enables[1] !== 0) {
            this.update();
        }
    }

    get raw() {
        let bits = (this.flags & 0xf) << 8;
        this.units.forEach((unit, n) => {
            bits |= (unit.rx.count > 0 ? 1 << n : 0) | (unit.tx.count < unit.tx.depth ? 0x10 << n : 0);
        });
        return bits;
    }

    status(line) {
        return (this.raw & this.enables[line]) | this.forces[line];
    }

    update() {
        this.machine.setInterrupt(this.firstInterrupt, this.status(0) !== 0);
        this.machine.setInterrupt(this.firstInterrupt + 1, this.status(1) !== 0);
    }

    // Registers ------------------------------------------------------------------------------------------------------

    readUint32(offset) {
        this.advance(this.machine.clock.now);
        if (offset >= 0xc8 && offset < 0x128) {
            return this.readUnit(this.units[Math.floor((offset - 0xc8) / 0x18)], (offset - 0xc8) % 0x18);
        }
        if (offset >= 0x20 && offset < 0x30) {
            return this.readFifo((offset - 0x20) >> 2);
        }
        switch (offset) {
            case 0x00:
                return this.bits((unit) => unit.enabled);
            case 0x04:
                return this.bits((unit) => unit.rx.count >= unit.rx.depth) |
                    (this.bits((unit) => unit.rx.count === 0) << 8) |
                    (this.bits((unit) => unit.tx.count >= unit.tx.depth) << 16) |
                    (this.bits((unit) => unit.tx.count === 0) << 24);
            case 0x08:
                return this.debug;
            case 0x0c:
                return this.units.reduce((bits, unit, n) => bits | ((unit.tx.count | (unit.rx.count << 4)) << (8 * n)), 0);
            case 0x30:
                return this.flags;
            case 0x38:
                return this.bypass;
            case 0x3c:
                return this.pinValues;
            case 0x40:
                return this.pinDirections;
            case 0x44:
                return 0x00200404;
            case 0x128:
                return this.raw;
            case 0x12c:
            case 0x138:
                return this.enables[offset === 0x138 ? 1 : 0];
            case 0x130:
            case 0x13c:
                return this.forces[offset === 0x13c ? 1 : 0];
            case 0x134:
            case 0x140:
                return this.status(offset === 0x140 ? 1 : 0);
            default:
                return 0;
        }
    }

    writeUint32(offset, value) {
        const { now } = this.machine.clock;
        this.advance(now);
        if (offset >= 0xc8 && offset < 0x128) {
            this.writeUnit(this.units[Math.floor((offset - 0xc8) / 0x18)], (offset - 0xc8) % 0x18, value);
            this.analyse();
            return;
        }
        if (offset >= 0x48 && offset < 0xc8) {
            this.instructions[(offset - 0x48) >> 2] = value & 0xffff;
            this.analyse();
            return;
        }
        if (offset >= 0x10 && offset < 0x20) {
            this.writeFifo((offset - 0x10) >> 2, value);
            return;
        }
        switch (offset) {
            case 0x00:
                this.units.forEach((unit, n) => {
                    if (value & (1 << (4 + n))) {
                        unit.restart();
                    }
                    if (value & (1 << (8 + n))) {
                        unit.fraction = 0;
                    }
                    unit.enable((value & (1 << n)) !== 0, now + 1);
                });
                this.analyse();
                return;
            case 0x08:
                this.debug &= ~this.rawWriteValue;
                return;
            case 0x30:
                this.setFlags(this.flags & ~this.rawWriteValue);
                return;
            case 0x34:
                this.setFlags(this.flags | this.rawWriteValue);
                return;
            case 0x38:
                this.bypass = value;
                return;
            case 0x12c:
            case 0x138:
                this.enables[offset === 0x138 ? 1 : 0] = value & 0xfff;
                break;
            case 0x130:
            case 0x13c:
                this.forces[offset === 0x13c ? 1 : 0] = value & 0xfff;
                break;
            default:
                return;
        }
        this.analyse();
        this.update();
    }

    bits(test) {
        return this.units.reduce((bits, unit, n) => bits | (test(unit) ? 1 << n : 0), 0);
    }

    readFifo(n) {
        const { rx } = this.units[n];
        if (rx.count === 0) {
            this.debug |= 1 << (8 + n); // RXUNDER
            return 0;
        }
        const word = rx.pull();
        this.units[n].mark.pc = -1;
        this.fifoChanged();
        return word;
    }

    writeFifo(n, value) {
        const { tx } = this.units[n];
        if (tx.count >= tx.depth) {
            this.debug |= 1 << (16 + n); // TXOVER
            return;
        }
        tx.push(value);
        this.fifoChanged();
    }

    readUnit(unit, offset) {
        switch (offset) {
            case 0x00:
                return unit.clockDivider;
            case 0x04:
                return (unit.execControl | (unit.stalled ? 0x80000000 : 0)) >>> 0;
            case 0x08:
                return unit.shiftControl;
            case 0x0c:
                return unit.pc;
            case 0x10:
                return this.instructions[unit.pc];
            default:
                return unit.pinControl;
        }
    }

    writeUnit(unit, offset, value) {
        switch (offset) {
            case 0x00:
                unit.writeClockDivider(value);
                break;
            case 0x04:
                unit.writeExecControl(value);
                break;
            case 0x08:
                unit.writeShiftControl(value);
                break;
            case 0x10:
                unit.force(value & 0xffff);
                break;
            case 0x14:
                unit.writePinControl(value);
                break;
            default:
        }
    }
}
