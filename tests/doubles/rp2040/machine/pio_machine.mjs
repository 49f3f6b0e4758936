// SPDX-License-Identifier: Apache-2.0
// One PIO state machine (data sheet of the RP2040, 3.4 and 3.5), exact to the cycle.
//
// run() executes many cycles at once and skips those in which nothing can change.  If the registers and FIFOs of a
// state machine return to earlier values while its inputs are constant, the state machine repeats itself.

const FIFO_DEPTH = 4;
const RESTLESS = 256; // number of instructions after which the search for a loop starts again

class Fifo {
    constructor() {
        this.words = new Uint32Array(2 * FIFO_DEPTH);
        this.depth = FIFO_DEPTH;
        this.first = 0;
        this.count = 0;
    }

    resize(depth) {
        this.depth = depth;
        this.first = this.count = 0;
    }

    push(word) {
        this.words[(this.first + this.count) & 7] = word;
        this.count++;
    }

    pull() {
        const word = this.words[this.first];
        this.first = (this.first + 1) & 7;
        this.count--;
        return word;
    }
}

export class StateMachine {
    constructor(block, index) {
        this.block = block;
        this.index = index;
        this.rx = new Fifo();
        this.tx = new Fifo();
        this.mark = { pc: -1, time: 0, x: 0, y: 0, isr: 0, isrCount: 0, osr: 0, osrCount: 0, rx: 0, tx: 0, acc: 0 };
        this.reset();
    }

    reset() {
        this.enabled = false;
        this.time = 0; // cycle of the next instruction
        this.pc = 0;
        this.x = this.y = 0; // unsigned, as all registers here
        this.isr = this.osr = 0;
        this.isrCount = 0;
        this.osrCount = 32;
        this.forced = -1; // instruction to execute instead of the next one, or -1
        this.stalled = false;
        this.fraction = 0;
        this.writeClockDivider(1 << 16);
        this.writeExecControl(0x1f << 12);
        this.writeShiftControl(3 << 18);
        this.writePinControl(5 << 26);
        this.rx.resize(FIFO_DEPTH);
        this.tx.resize(FIFO_DEPTH);
    }

    writeClockDivider(value) {
        this.clockDivider = value >>> 0;
        const whole = value >>> 16 || 65536;
        this.period = whole * 256 + ((value >>> 8) & 0xff); // in 1/256 cycle
    }

    writeExecControl(value) {
        this.execControl = (value & 0x7fffff9f) >>> 0;
        this.statusLevel = value & 0xf;
        this.statusOfRx = (value & 0x10) !== 0;
        this.wrapBottom = (value >>> 7) & 0x1f;
        this.wrapTop = (value >>> 12) & 0x1f;
        this.jumpPin = (value >>> 24) & 0x1f;
        this.sideDirections = (value & (1 << 29)) !== 0;
        this.sideOptional = (value & (1 << 30)) !== 0;
    }

    writeShiftControl(value) {
        const joins = value >>> 30;
        if (this.shiftControl === undefined || joins !== this.shiftControl >>> 30) {
            this.rx.resize(joins & 2 ? 8 : joins & 1 ? 0 : FIFO_DEPTH);
            this.tx.resize(joins & 1 ? 8 : joins & 2 ? 0 : FIFO_DEPTH);
        }
        this.shiftControl = value >>> 0;
        this.autopush = (value & (1 << 16)) !== 0;
        this.autopull = (value & (1 << 17)) !== 0;
        this.inRight = (value & (1 << 18)) !== 0;
        this.outRight = (value & (1 << 19)) !== 0;
        this.pushThreshold = (value >>> 20) & 0x1f || 32;
        this.pullThreshold = (value >>> 25) & 0x1f || 32;
    }

    writePinControl(value) {
        this.pinControl = value >>> 0;
        this.outBase = value & 0x1f;
        this.setBase = (value >>> 5) & 0x1f;
        this.sideBase = (value >>> 10) & 0x1f;
        this.inBase = (value >>> 15) & 0x1f;
        this.outCount = (value >>> 20) & 0x3f;
        this.setCount = (value >>> 26) & 7;
        this.sideCount = (value >>> 29) & 7;
    }

    /**
     * SM_RESTART clears shift counters, ISR, delay, stall and forced instruction, but not X, Y, OSR or the program
     * counter.
     */
    restart() {
        this.isr = this.isrCount = 0;
        this.osrCount = 32;
        this.forced = -1;
        this.stalled = false;
    }

    /** A write to SMx_INSTR. */
    force(instruction) {
        if (this.enabled) {
            this.forced = instruction;
            this.stalled = false;
            this.mark.pc = -1;
            return;
        }
        const { time } = this;
        this.forced = instruction;
        this.execute();
        this.time = time;
    }

    enable(on, cycle) {
        if (on && !this.enabled) {
            this.time = Math.max(cycle, this.time);
            this.mark.pc = -1;
        }
        this.enabled = on;
    }

    /** Executes all instructions that begin before cycle `end`. */
    run(end) {
        const { mark } = this;
        mark.pc = -1; // inputs may have changed
        let count = 0;
        while (this.time < end) {
            if (this.pc === mark.pc && this.forced < 0 && !this.stalled) {
                if (this.unchanged()) {
                    const length = this.time - mark.time;
                    this.time += Math.floor((end - this.time - 1) / length) * length;
                    mark.pc = -2; // search for at most one more round
                } else {
                    this.setMark();
                    count = 0;
                }
            } else if (mark.pc !== -2 && (mark.pc < 0 || ++count > RESTLESS)) {
                this.setMark();
                count = 0;
            }
            this.execute();
            if (this.stalled && !this.block.shared) { // only an event from outside can end this stall
                this.time = this.stallUntil(end);
            }
        }
    }

    stallUntil(end) {
        if (this.time >= end) {
            return this.time;
        }
        if (this.period === 256) {
            return end;
        }
        while (this.time < end) {
            this.advance(1);
        }
        return this.time;
    }

    setMark() {
        const { mark } = this;
        mark.pc = this.forced < 0 && !this.stalled ? this.pc : -1;
        mark.time = this.time;
        mark.x = this.x;
        mark.y = this.y;
        mark.isr = this.isr;
        mark.isrCount = this.isrCount;
        mark.osr = this.osr;
        mark.osrCount = this.osrCount;
        mark.rx = this.rx.count;
        mark.tx = this.tx.count;
        mark.acc = this.fraction;
    }

    unchanged() {
        const { mark } = this;
        return mark.x === this.x && mark.y === this.y && mark.isr === this.isr && mark.isrCount === this.isrCount &&
            mark.osr === this.osr && mark.osrCount === this.osrCount && mark.rx === this.rx.count &&
            mark.tx === this.tx.count && mark.acc === this.fraction;
    }

    advance(ticks) {
        if (this.period === 256) {
            this.time += ticks;
            return;
        }
        const sum = this.fraction + ticks * this.period;
        this.time += sum >>> 8;
        this.fraction = sum & 0xff;
    }

    /** The instruction that begins now. */
    execute() {
        const forced = this.forced >= 0;
        const instruction = forced ? this.forced : this.block.instructions[this.pc];
        this.forced = -1;
        const field = (instruction >>> 8) & 0x1f;
        if (this.sideCount !== 0 && !this.stalled) {
            this.sideSet(field);
        }
        const argument = instruction & 0xff;
        let jumped = false;
        let done = true;
        switch (instruction >>> 13) {
            case 0:
                jumped = this.condition(argument >>> 5);
                if (jumped) {
                    this.pc = argument & 0x1f;
                }
                break;
            case 1:
                done = this.wait(argument);
                break;
            case 2:
                done = this.shiftIn(argument);
                break;
            case 3:
                done = this.shiftOut(argument);
                jumped = done && argument >>> 5 === 5;
                break;
            case 4:
                done = argument & 0x80 ? this.pullWord(argument) : this.pushWord(argument);
                break;
            case 5:
                this.move(argument);
                jumped = argument >>> 5 === 5;
                break;
            case 6:
                done = this.interrupt(argument);
                break;
            default:
                this.set(argument);
        }
        this.stalled = !done;
        if (!done) {
            if (forced) {
                this.forced = instruction;
            }
            this.advance(1);
            return;
        }
        if (!jumped && !forced) {
            this.pc = this.pc === this.wrapTop ? this.wrapBottom : (this.pc + 1) & 0x1f;
        }
        this.advance(1 + (this.forced >= 0 ? 0 : field & ((1 << (5 - this.sideCount)) - 1)));
    }

    sideSet(field) {
        let bits = field >>> (5 - this.sideCount);
        let count = this.sideCount;
        if (this.sideOptional) {
            if (!(field & 0x10)) {
                return;
            }
            count--;
            bits &= (1 << count) - 1;
        }
        this.block.output(this.sideDirections, this.sideBase, count, bits, this.time);
    }

    condition(code) {
        switch (code) {
            case 0:
                return true;
            case 1:
                return this.x === 0;
            case 2: {
                const taken = this.x !== 0;
                this.x = (this.x - 1) >>> 0;
                return taken;
            }
            case 3:
                return this.y === 0;
            case 4: {
                const taken = this.y !== 0;
                this.y = (this.y - 1) >>> 0;
                return taken;
            }
            case 5:
                return this.x !== this.y;
            case 6:
                return ((this.block.pins >>> this.jumpPin) & 1) === 1;
            default:
                return this.osrCount < this.pullThreshold;
        }
    }

    flag(index) {
        return index & 0x10 ? (index & 4) | ((index + this.index) & 3) : index & 7;
    }

    wait(argument) {
        const wanted = argument >>> 7;
        const index = argument & 0x1f;
        switch ((argument >>> 5) & 3) {
            case 0:
                return ((this.block.pins >>> index) & 1) === wanted;
            case 1:
                return ((this.block.pins >>> ((index + this.inBase) & 31)) & 1) === wanted;
            case 2: {
                const bit = 1 << this.flag(index);
                if (((this.block.flags & bit) !== 0 ? 1 : 0) !== wanted) {
                    return false;
                }
                if (wanted) {
                    this.block.setFlags(this.block.flags & ~bit);
                }
                return true;
            }
            default:
                return true;
        }
    }

    source(code) {
        switch (code) {
            case 0: {
                const { pins } = this.block;
                const { inBase } = this;
                return inBase === 0 ? pins : ((pins >>> inBase) | (pins << (32 - inBase))) >>> 0;
            }
            case 1:
                return this.x;
            case 2:
                return this.y;
            case 5:
                return (this.statusOfRx ? this.rx.count : this.tx.count) < this.statusLevel ? 0xffffffff : 0;
            case 6:
                return this.isr;
            case 7:
                return this.osr;
            default:
                return 0;
        }
    }

    shiftIn(argument) {
        if (this.stalled) { // the bits are shifted in; the word waits for space in the FIFO
            return this.autopushNow();
        }
        const bits = argument & 0x1f || 32;
        const data = this.source(argument >>> 5);
        if (bits === 32) {
            this.isr = data;
        } else {
            const low = data & ((1 << bits) - 1);
            this.isr = this.inRight ? ((this.isr >>> bits) | (low << (32 - bits))) >>> 0
                : ((this.isr << bits) | low) >>> 0;
        }
        this.isrCount = Math.min(32, this.isrCount + bits);
        return this.autopush && this.isrCount >= this.pushThreshold ? this.autopushNow() : true;
    }

    autopushNow() {
        if (this.rx.count >= this.rx.depth) {
            this.block.debug |= 1 << this.index; // RXSTALL
            return false;
        }
        this.rx.push(this.isr);
        this.isr = this.isrCount = 0;
        this.block.fifoChanged();
        return true;
    }

    shiftOut(argument) {
        if (this.autopull && this.osrCount >= this.pullThreshold) {
            if (this.tx.count === 0) {
                this.block.debug |= 1 << (24 + this.index); // TXSTALL
                return false;
            }
            this.osr = this.tx.pull();
            this.osrCount = 0;
            this.block.fifoChanged();
        }
        const bits = argument & 0x1f || 32;
        let data;
        if (bits === 32) {
            data = this.osr;
            this.osr = 0;
        } else if (this.outRight) {
            data = this.osr & ((1 << bits) - 1);
            this.osr >>>= bits;
        } else {
            data = this.osr >>> (32 - bits);
            this.osr = (this.osr << bits) >>> 0;
        }
        this.osrCount = Math.min(32, this.osrCount + bits);
        switch (argument >>> 5) {
            case 5:
                this.pc = data & 0x1f;
                break;
            case 6:
                this.isr = data;
                this.isrCount = bits;
                break;
            case 7:
                this.forced = data & 0xffff;
                break;
            default:
                this.put(argument >>> 5, this.outBase, this.outCount, data);
        }
        return true;
    }

    /** Writes to a destination that OUT and SET share. */
    put(destination, base, count, data) {
        switch (destination) {
            case 0:
            case 4:
                this.block.output(destination === 4, base, count, data, this.time);
                break;
            case 1:
                this.x = data;
                break;
            case 2:
                this.y = data;
                break;
            default:
        }
    }

    pushWord(argument) {
        if (argument & 0x40 && this.isrCount < this.pushThreshold) {
            return true;
        }
        if (this.rx.count >= this.rx.depth) {
            this.block.debug |= 1 << this.index;
            if (argument & 0x20) {
                return false;
            }
        } else {
            this.rx.push(this.isr);
            this.block.fifoChanged();
        }
        this.isr = this.isrCount = 0;
        return true;
    }

    pullWord(argument) {
        if (argument & 0x40 && this.osrCount < this.pullThreshold) {
            return true;
        }
        if (this.tx.count === 0) {
            if (argument & 0x20) {
                this.block.debug |= 1 << (24 + this.index);
                return false;
            }
            this.osr = this.x;
        } else {
            this.osr = this.tx.pull();
            this.block.fifoChanged();
        }
        this.osrCount = 0;
        return true;
    }

    move(argument) {
        let data = this.source(argument & 7);
        const operation = (argument >>> 3) & 3;
        if (operation === 1) {
            data = ~data >>> 0;
        } else if (operation === 2) {
            data = reverse(data);
        }
        switch (argument >>> 5) {
            case 0:
                this.block.output(false, this.outBase, this.outCount, data, this.time);
                break;
            case 1:
                this.x = data;
                break;
            case 2:
                this.y = data;
                break;
            case 4:
                this.forced = data & 0xffff;
                break;
            case 5:
                this.pc = data & 0x1f;
                break;
            case 6:
                this.isr = data;
                this.isrCount = 0;
                break;
            case 7:
                this.osr = data;
                this.osrCount = 0;
                break;
            default:
        }
    }

    interrupt(argument) {
        const bit = 1 << this.flag(argument & 0x1f);
        if (argument & 0x40) {
            this.block.setFlags(this.block.flags & ~bit);
            return true;
        }
        if (!this.stalled) {
            this.block.setFlags(this.block.flags | bit);
            return !(argument & 0x20);
        }
        return (this.block.flags & bit) === 0;
    }

    set(argument) {
        this.put(argument >>> 5, this.setBase, this.setCount, argument & 0x1f);
    }
}

function reverse(word) {
    let result = 0;
    for (let bit = 0; bit < 32; bit++) {
        result = (result << 1) | ((word >>> bit) & 1);
    }
    return result >>> 0;
}
