// SPDX-License-Identifier: Apache-2.0
// The time that memory takes: the cache of the flash, and the cores' contention for SRAM, flash and the APB.
//
// All methods return the cycles for which an access waits, beyond those of an access without wait states.
import { BasePeripheral } from './package.mjs';

// Registers of the cache (data sheet of the RP2040, 2.6.3.6).
const CTRL = 0x00;
const FLUSH = 0x04;
const STAT = 0x08;
const HITS = 0x0c;
const ACCESSES = 0x10;
const ENABLE = 1;
const FLUSHED_AND_FIFO_EMPTY = 3;

// Registers of the SSI (data sheet of the RP2040, 4.10.13).
const SSI_CTRLR0 = 0x00;
const SSI_BAUDR = 0x14;
const SSI_SPI_CTRLR0 = 0xf4;
const INSTRUCTION_BITS = [0, 4, 8, 16];

// 16 kB in two ways.  A line has 8 bytes, of which each half is filled by a transfer of 32 bits when it is first read:
// the SSI has one size of transfers (a designer of the chip in raspberrypi/pico-feedback, issue 307).
const WAYS = 2;
const SETS = 1024;
const HALVES = 2;

// Cycles of a transfer beyond those of its clock edges: the bridge to the SSI, and the start of the transfer.  The data
// sheet does not state them.  With 8, a read of a word that is not in the cache takes 50 cycles at a divider of 2, the
// 400 ns that oberon-rtk.org has measured at 125 MHz (description/flash-memory).
const OVERHEAD = 8;

/** The flash with its cache: its registers, and the time of an access. */
export class FlashCache extends BasePeripheral {
    constructor(chip, ssi) {
        super(chip, 'XIP_CTRL');
        this.ssi = ssi;
        this.enabled = true;
        this.hits = 0;
        this.accesses = 0;
        this.busyUntil = 0; // of the transfer that runs
        this.tags = new Int32Array(SETS * WAYS);
        this.valid = new Uint8Array(SETS * WAYS); // a bit for each half of the line
        this.older = new Uint8Array(SETS); // the way that was not used last
        this.flush();
    }

    flush() {
        this.tags.fill(-1);
        this.valid.fill(0);
    }

    /** The cycles of a transfer of 32 bits with the present settings of the SSI. */
    get transfer() {
        const frame = this.ssi.readUint32(SSI_CTRLR0);
        const xip = this.ssi.readUint32(SSI_SPI_CTRLR0);
        const lanes = 1 << ((frame >>> 21) & 3);
        const kind = xip & 3; // 0: instruction and address on one lane; 1: the instruction only; 2: none of them
        const instruction = INSTRUCTION_BITS[(xip >>> 8) & 3] / (kind === 2 ? lanes : 1);
        const address = (((xip >>> 2) & 15) * 4) / (kind === 0 ? 1 : lanes);
        const wait = (xip >>> 11) & 31;
        return (instruction + address + wait + 32 / lanes) * this.ssi.readUint32(SSI_BAUDR) + OVERHEAD;
    }

    /** An access to `address` at `cycle`. */
    access(address, cycle) {
        this.accesses++;
        const waits = Math.max(this.busyUntil - cycle, 0);
        const window = (address >>> 24) & 3;
        const offset = address & 0xffffff;
        const set = (offset >>> 3) % SETS;
        const tag = offset >>> 13;
        const half = 1 << ((offset >>> 2) % HALVES);
        let way = -1;
        for (let n = set * WAYS; n < (set + 1) * WAYS; n++) {
            if (this.tags[n] === tag) {
                way = n;
            }
        }
        if (this.enabled && window < 2 && way >= 0 && this.valid[way] & half) {
            this.hits++;
            this.older[set] = 1 - (way - set * WAYS);
            return waits;
        }
        if (this.enabled && window % 2 === 0) {
            if (way < 0) {
                way = set * WAYS + this.older[set];
                this.tags[way] = tag;
                this.valid[way] = 0;
            }
            this.valid[way] |= half;
            this.older[set] = 1 - (way - set * WAYS);
        }
        const time = this.transfer;
        this.busyUntil = cycle + waits + time;
        return waits + time;
    }

    readUint32(offset) {
        switch (offset) {
            case CTRL:
                return this.enabled ? 3 : 2; // invalid memory accesses fault
            case STAT:
                return FLUSHED_AND_FIFO_EMPTY;
            case HITS:
                return Math.min(this.hits, 0xffffffff);
            case ACCESSES:
                return Math.min(this.accesses, 0xffffffff);
            default:
                return 0;
        }
    }

    writeUint32(offset, value) {
        if (offset === CTRL) {
            this.enabled = (value & ENABLE) !== 0;
        } else if (offset === FLUSH && value & 1) {
            this.flush();
        } else if (offset === HITS) {
            this.hits = 0;
        } else if (offset === ACCESSES) {
            this.accesses = 0;
        }
    }
}

const PRIORITY = 0x00; // registers of BUSCTRL (data sheet of the RP2040, 2.1.5.2)
const PRIORITY_ACK = 0x04;
const PRIORITY_BITS = [0, 4]; // of the cores

/** Which core goes first. */
export class BusControl extends BasePeripheral {
    priority = 0;

    /** True if `core` goes first where both cores want the same bank in the same cycle. */
    goesFirst(core) {
        return ((this.priority >> PRIORITY_BITS[core]) & 1) > ((this.priority >> PRIORITY_BITS[1 - core]) & 1);
    }

    readUint32(offset) {
        return offset === PRIORITY ? this.priority : offset === PRIORITY_ACK ? 1 : 0;
    }

    writeUint32(offset, value) {
        if (offset === PRIORITY) {
            this.priority = value & 0x1111;
        }
    }
}

const STRIPED = 256 * 1024;
const BANKS = 6;
const KEPT = 16; // cycles: longer than the accesses of one instruction
const APB_READ = 3;
const APB_WRITE = 4;

/** The buses between the cores and the memories.  A core that comes second in a cycle, or has less priority, waits. */
export class MemoryBus {
    constructor(cache, control) {
        this.cache = cache;
        this.control = control;
        this.cycles = new Float64Array(BANKS * KEPT).fill(-1);
        this.owners = new Uint8Array(BANKS * KEPT);
        this.apbUntil = 0;
        this.apbOwner = 0;
        this.waits = [0, 0]; // of each core, for the other one
        this.debts = [0, 0]; // cycles that a core still has to wait because the other one came first by its priority
    }

    /** An access to SRAM.  Words of the first 256 kB lie in four banks in turn (data sheet of the RP2040, 2.6.2). */
    sram(core, offset, cycle) {
        const bank = offset < STRIPED ? (offset >>> 2) & 3 : 4 + ((offset - STRIPED) >>> 12);
        const first = this.control.goesFirst(core);
        let at = cycle + this.debts[core];
        this.debts[core] = 0;
        for (;;) {
            const slot = bank * KEPT + (at % KEPT);
            const taken = this.cycles[slot] === at && this.owners[slot] !== core;
            if (!taken || first) {
                this.debts[1 - core] += taken ? 1 : 0; // its access is over already: the next one waits
                this.cycles[slot] = at;
                this.owners[slot] = core;
                break;
            }
            at++;
        }
        this.waits[core] += at - cycle;
        return at - cycle;
    }

    /** An access to a device behind the bridge to the APB, which does one access after the other. */
    apb(core, write, cycle) {
        const waits = this.apbOwner === core ? 0 : Math.max(this.apbUntil - cycle, 0);
        this.apbOwner = core;
        this.apbUntil = cycle + waits + (write ? APB_WRITE : APB_READ);
        this.waits[core] += waits;
        return waits;
    }
}
