// SPDX-License-Identifier: Apache-2.0
// Resets of peripherals and of core 1 by software (data sheet of the RP2040, 2.13 and 2.14), and registers that behave
// as plain memory in this emulator.
import { BasePeripheral } from './package.mjs';

const ALL_PERIPHERALS = 0x1ffffff;
const PSM_BLOCKS = 0x1ffff;
const PSM_CORE1 = 1 << 16;

// Bits of RESETS (table 203).
const IO_BANK0 = 1 << 5;
const PADS_BANK0 = 1 << 8;
const PIO0 = 1 << 10;
const PIO1 = 1 << 11;
const PWM = 1 << 14;
const TIMER = 1 << 21;
const UART0 = 1 << 22;
const UART1 = 1 << 23;
const USB = 1 << 24;

/** The peripherals that are held in reset.  When the chip starts, these are all of them. */
export class Resets extends BasePeripheral {
    constructor(machine, chip) {
        super(chip, 'RESETS');
        this.machine = machine;
        this.held = ALL_PERIPHERALS;
        this.watchdogSelect = 0;
    }

    readUint32(offset) {
        switch (offset) {
            case 0:
                return this.held;
            case 4:
                return this.watchdogSelect;
            default:
                return ~this.held & ALL_PERIPHERALS;
        }
    }

    writeUint32(offset, value) {
        if (offset === 4) {
            this.watchdogSelect = value & ALL_PERIPHERALS;
            return;
        }
        if (offset !== 0) {
            return;
        }
        const { machine } = this;
        const asserted = value & ~this.held;
        this.held = value & ALL_PERIPHERALS;
        if (asserted & (IO_BANK0 | PADS_BANK0)) {
            machine.pads.reset((asserted & IO_BANK0) !== 0, (asserted & PADS_BANK0) !== 0);
        }
        if (asserted & PIO0) {
            machine.pio[0].reset();
        }
        if (asserted & PIO1) {
            machine.pio[1].reset();
        }
        if (asserted & PWM) {
            machine.pwm.reset();
        }
        if (asserted & TIMER) {
            machine.timer.reset();
        }
        if (asserted & UART0) {
            machine.uarts[0].reset();
        }
        if (asserted & UART1) {
            machine.uarts[1].reset();
        }
        if (asserted & USB) {
            machine.usb.reset();
        }
    }
}

/** The power-on state machine.  Software uses it to reset core 1. */
export class PowerOn extends BasePeripheral {
    constructor(machine, chip) {
        super(chip, 'PSM');
        this.machine = machine;
        this.on = this.off = this.watchdogSelect = 0;
    }

    readUint32(offset) {
        switch (offset) {
            case 0:
                return this.on;
            case 4:
                return this.off;
            case 8:
                return this.watchdogSelect;
            default:
                return PSM_BLOCKS & ~this.off;
        }
    }

    writeUint32(offset, value) {
        const before = this.off;
        switch (offset) {
            case 0:
                this.on = value & PSM_BLOCKS;
                break;
            case 4:
                this.off = value & PSM_BLOCKS;
                break;
            case 8:
                this.watchdogSelect = value & PSM_BLOCKS;
                break;
            default:
        }
        if (this.off & PSM_CORE1 && !(before & PSM_CORE1)) {
            this.machine.launch.hold();
        } else if (before & PSM_CORE1 && !(this.off & PSM_CORE1)) {
            this.machine.launch.begin();
        }
    }
}

/** Registers that keep the value that was written. */
export class Registers extends BasePeripheral {
    constructor(chip, name, values = {}) {
        super(chip, name);
        this.values = new Map(Object.entries(values).map(([offset, value]) => [Number(offset), value]));
    }

    readUint32(offset) {
        return this.values.get(offset) ?? 0;
    }

    writeUint32(offset, value) {
        this.values.set(offset, value >>> 0);
    }
}
