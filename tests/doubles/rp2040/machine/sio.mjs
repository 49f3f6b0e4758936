// SPDX-License-Identifier: Apache-2.0
// The single-cycle I/O block (data sheet of the RP2040, 2.3.1) of both cores: GPIO, mailboxes, spinlocks, dividers.
import { IRQ, RPSIO } from './package.mjs';

const GPIO_MASK = 0x3fffffff;
const MAILBOX_DEPTH = 8;

/** The divider of one core.  Results are ready at once; the chip needs 8 cycles, for which the SDK waits. */
class Divider {
    constructor() {
        this.dividend = 0;
        this.divisor = 0;
        this.quotient = 0;
        this.remainder = 0;
        this.dirty = false;
    }

    write(offset, value) {
        const signed = (offset & 8) !== 0;
        switch (offset) {
            case 0x60:
            case 0x68:
                this.dividend = value;
                break;
            case 0x64:
            case 0x6c:
                this.divisor = value;
                break;
            case 0x70:
                this.quotient = value;
                this.dirty = true;
                return;
            case 0x74:
                this.remainder = value;
                this.dirty = true;
                return;
            default:
                return;
        }
        this.dirty = true;
        this.divide(signed);
    }

    divide(signed) {
        const p = signed ? this.dividend | 0 : this.dividend >>> 0;
        const q = signed ? this.divisor | 0 : this.divisor >>> 0;
        if (q === 0) { // 2.3.1.5: the largest quotient of the right sign; the remainder is the dividend
            this.quotient = signed && p < 0 ? 1 : 0xffffffff;
            this.remainder = p >>> 0;
        } else {
            this.quotient = Math.trunc(p / q) >>> 0;
            this.remainder = (p % q) >>> 0;
        }
    }

    read(offset) {
        switch (offset) {
            case 0x60:
            case 0x68:
                return this.dividend;
            case 0x64:
            case 0x6c:
                return this.divisor;
            case 0x70:
                this.dirty = false;
                return this.quotient;
            case 0x74:
                return this.remainder;
            default:
                return this.dirty ? 3 : 1;
        }
    }
}

export class Sio {
    constructor(machine, chip) {
        this.machine = machine;
        this.chip = chip;
        this.gpioValue = 0;
        this.gpioOutputEnable = 0;
        this.spinlocks = 0;
        this.mailboxes = [[], []]; // the words that core 0 and core 1 will read
        this.mailboxErrors = [0, 0]; // ROE and WOF
        this.dividers = [new Divider(), new Divider()];
        this.interpolators = [new RPSIO(chip), new RPSIO(chip)];
    }

    read(core, offset) {
        if (offset >= 0x100) {
            return this.claimSpinlock((offset >> 2) & 31);
        }
        if (offset >= 0x80) {
            return this.interpolators[core].readUint32(offset);
        }
        if (offset >= 0x60 && offset < 0x80) {
            return this.dividers[core].read(offset);
        }
        switch (offset) {
            case 0x00:
                return core;
            case 0x04:
                return this.machine.pads.inputs;
            case 0x08:
                return 0x2; // QSPI pins: chip select is high, BOOTSEL is not pressed
            case 0x10:
                return this.gpioValue;
            case 0x20:
                return this.gpioOutputEnable;
            case 0x50:
                return this.mailboxStatus(core);
            case 0x58:
                return this.readMailbox(core);
            case 0x5c:
                return this.spinlocks;
            default:
                return 0;
        }
    }

    write(core, offset, value) {
        if (offset >= 0x100) {
            this.spinlocks &= ~(1 << ((offset >> 2) & 31));
        } else if (offset >= 0x80) {
            this.interpolators[core].writeUint32(offset, value);
        } else if (offset >= 0x60) {
            this.dividers[core].write(offset, value);
        } else if (offset >= 0x10 && offset < 0x30) {
            this.writePins(offset, value & GPIO_MASK);
        } else if (offset === 0x50) {
            this.mailboxErrors[core] &= ~(value & 0xc);
            this.updateMailboxInterrupt(core);
        } else if (offset === 0x54) {
            this.writeMailbox(core, value);
        }
    }

    writePins(offset, value) {
        const name = offset < 0x20 ? 'gpioValue' : 'gpioOutputEnable';
        const before = this[name];
        switch (offset & 0xc) {
            case 0x0:
                this[name] = value;
                break;
            case 0x4:
                this[name] |= value;
                break;
            case 0x8:
                this[name] &= ~value;
                break;
            default:
                this[name] ^= value;
        }
        this.machine.pads.refreshMask(before ^ this[name]);
    }

    claimSpinlock(number) {
        const bit = 1 << number;
        if (this.spinlocks & bit) {
            return 0;
        }
        this.spinlocks |= bit;
        return bit >>> 0;
    }

    mailboxStatus(core) {
        return (this.mailboxes[core].length > 0 ? 1 : 0) | (this.mailboxes[1 - core].length < MAILBOX_DEPTH ? 2 : 0) |
            this.mailboxErrors[core];
    }

    readMailbox(core) {
        const box = this.mailboxes[core];
        if (box.length === 0) {
            this.mailboxErrors[core] |= 8;
            this.updateMailboxInterrupt(core);
            return 0;
        }
        const word = box.shift();
        this.updateMailboxInterrupt(core);
        return word;
    }

    writeMailbox(core, value) {
        const box = this.mailboxes[1 - core];
        if (box.length >= MAILBOX_DEPTH) {
            this.mailboxErrors[core] |= 4;
            this.updateMailboxInterrupt(core);
            return;
        }
        box.push(value >>> 0);
        if (core === 0 && this.machine.launch.receive()) {
            return;
        }
        this.updateMailboxInterrupt(1 - core);
    }

    updateMailboxInterrupt(core) {
        const level = this.mailboxes[core].length > 0 || this.mailboxErrors[core] !== 0;
        this.machine.cores[core].setInterrupt(core === 0 ? IRQ.SIO_PROC0 : IRQ.SIO_PROC1, level);
    }
}
