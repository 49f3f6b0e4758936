// SPDX-License-Identifier: Apache-2.0
// The private peripherals of each Cortex-M0+: NVIC, SysTick, MPU and system control (data sheet of the RP2040, 2.4.8).
import { Mpu } from './mpu.mjs';

const SYST_CSR = 0x010;
const SYST_RVR = 0x014;
const SYST_CVR = 0x018;
const SYST_CALIB = 0x01c;
const NVIC_ISER = 0x100;
const NVIC_ICER = 0x180;
const NVIC_ISPR = 0x200;
const NVIC_ICPR = 0x280;
const NVIC_IPR0 = 0x400;
const NVIC_IPR7 = 0x41c;
const CPUID = 0xd00;
const ICSR = 0xd04;
const VTOR = 0xd08;
const AIRCR = 0xd0c;
const SCR = 0xd10;
const CCR = 0xd14;
const SHPR2 = 0xd1c;
const SHPR3 = 0xd20;
const SHCSR = 0xd24;
const MPU_FIRST = 0xd90;
const MPU_LAST = 0xda0;

const SEVONPEND = 1 << 4;
const SYSRESETREQ = 1 << 2;

/** Counts down from RVR to 0: its period is RVR + 1 cycles (Armv6-M Architecture Reference Manual, B3.3). */
class SysTick {
    constructor(core, clock) {
        this.core = core;
        this.clock = clock;
        this.alarm = clock.createAlarm(() => this.reachZero());
        this.reset();
    }

    reset() {
        this.alarm.cancel();
        this.enabled = false;
        this.interrupt = false;
        this.processorClock = false;
        this.countFlag = false;
        this.reload = 0;
        this.held = 0; // the value while stopped
        this.zeroAt = 0; // the cycle at which a running counter reaches 0
    }

    /** Cycles for one count: the reference is the 1 us tick (2.4.8 of the data sheet, SYST_CALIB). */
    get scale() {
        return this.processorClock ? 1 : this.clock.frequency / 1e6;
    }

    get value() {
        if (!this.enabled) {
            return this.held;
        }
        const left = Math.floor((this.zeroAt - this.clock.now) / this.scale);
        return left < 0 ? 0 : left & 0xffffff;
    }

    runFrom(value) {
        // After 0, the next count loads RVR: the first count of the period.
        const counts = value === 0 ? this.reload + 1 : value;
        this.zeroAt = this.clock.now + counts * this.scale;
        if (this.reload === 0 && value === 0) {
            this.alarm.cancel();
        } else {
            this.alarm.at(this.zeroAt);
        }
    }

    reachZero() {
        this.countFlag = true;
        if (this.interrupt) {
            this.core.pendingSystick = true;
            this.core.pend(0);
        }
        if (this.reload === 0) {
            this.held = 0;
        } else {
            this.zeroAt += (this.reload + 1) * this.scale;
            this.alarm.at(this.zeroAt);
        }
    }

    readControl() {
        const value = (this.countFlag ? 1 << 16 : 0) | (this.processorClock ? 4 : 0) | (this.interrupt ? 2 : 0) |
            (this.enabled ? 1 : 0);
        this.countFlag = false;
        return value;
    }

    writeControl(value) {
        const at = this.value;
        this.processorClock = (value & 4) !== 0;
        this.interrupt = (value & 2) !== 0;
        this.enabled = (value & 1) !== 0;
        if (this.enabled) {
            this.runFrom(at);
        } else {
            this.alarm.cancel();
            this.held = at;
        }
    }

    clearValue() {
        this.countFlag = false;
        this.held = 0;
        if (this.enabled) {
            this.runFrom(0);
        }
    }
}

export class PrivateBus {
    constructor(core, chip, clock) {
        this.core = core;
        this.chip = chip;
        this.sysTick = new SysTick(core, clock);
        this.mpu = new Mpu((ranges) => core.forbidWrites(ranges));
        this.systemControl = 0;
    }

    reset() {
        this.sysTick.reset();
        this.mpu.reset();
        this.systemControl = 0;
    }

    get sendEventOnPend() {
        return (this.systemControl & SEVONPEND) !== 0;
    }

    readUint32(offset) {
        const { core } = this;
        if (offset >= NVIC_IPR0 && offset <= NVIC_IPR7) {
            return this.readPriorities((offset - NVIC_IPR0) & ~3);
        }
        if (offset >= MPU_FIRST && offset <= MPU_LAST) {
            return this.mpu.read(offset);
        }
        switch (offset) {
            case SYST_CSR:
                return this.sysTick.readControl();
            case SYST_RVR:
                return this.sysTick.reload;
            case SYST_CVR:
                return this.sysTick.value;
            case SYST_CALIB:
                return 0xc0000000; // no reference clock for calibration
            case NVIC_ISER:
            case NVIC_ICER:
                return core.enabledInterrupts >>> 0;
            case NVIC_ISPR:
            case NVIC_ICPR:
                return core.pendingInterrupts >>> 0;
            case CPUID:
                return 0x410cc601;
            case ICSR: {
                const pending = core.highestPending(false);
                return ((core.pendingPendSV ? 1 << 28 : 0) | (core.pendingSystick ? 1 << 26 : 0) |
                    (core.pendingInterrupts !== 0 ? 1 << 22 : 0) | (pending << 12) | core.IPSR) >>> 0;
            }
            case VTOR:
                return core.VTOR;
            case AIRCR:
                return 0xfa050000;
            case SCR:
                return this.systemControl;
            case CCR:
                return 0x208; // STKALIGN and UNALIGN_TRP, which are always 1
            case SHPR2:
                return core.SHPR2;
            case SHPR3:
                return core.SHPR3;
            case SHCSR:
                return core.pendingSVCall ? 1 << 15 : 0;
            default:
                return 0;
        }
    }

    writeUint32(offset, value) {
        const { core, sysTick } = this;
        if (offset >= NVIC_IPR0 && offset <= NVIC_IPR7) {
            this.writePriorities((offset - NVIC_IPR0) & ~3, value);
            return;
        }
        if (offset >= MPU_FIRST && offset <= MPU_LAST) {
            this.mpu.write(offset, value);
            return;
        }
        switch (offset) {
            case SYST_CSR:
                sysTick.writeControl(value);
                return;
            case SYST_RVR:
                sysTick.reload = value & 0xffffff;
                return;
            case SYST_CVR:
                sysTick.clearValue();
                return;
            case NVIC_ISER:
                core.enabledInterrupts |= value;
                core.pend(0);
                return;
            case NVIC_ICER:
                core.enabledInterrupts &= ~value;
                return;
            case NVIC_ISPR:
                core.pend(value);
                return;
            case NVIC_ICPR: // an interrupt whose line is high becomes pending again at once
                core.pendingInterrupts &= ~(value & ~(core.interruptLines & ~core.activeInterrupts));
                return;
            case ICSR:
                if (value & (1 << 28)) {
                    core.pendingPendSV = true;
                }
                if (value & (1 << 27)) {
                    core.pendingPendSV = false;
                }
                if (value & (1 << 26)) {
                    core.pendingSystick = true;
                }
                if (value & (1 << 25)) {
                    core.pendingSystick = false;
                }
                core.pend(0);
                return;
            case VTOR:
                core.VTOR = value & 0xffffff00;
                return;
            case AIRCR:
                if (value >>> 16 === 0x5fa && value & SYSRESETREQ) {
                    core.machine.requestReset('processor');
                }
                return;
            case SCR:
                this.systemControl = value & 0x16;
                return;
            case SHPR2:
                core.SHPR2 = value & 0xc0000000;
                core.interruptsUpdated = true;
                return;
            case SHPR3:
                core.SHPR3 = value & 0xc0c00000;
                core.interruptsUpdated = true;
        }
    }

    readPriorities(first) {
        let result = 0;
        for (let byte = 0; byte < 4; byte++) {
            const priority = this.core.interruptPriorities.findIndex((set) => set & (1 << (first + byte)));
            result |= (priority & 3) << (8 * byte + 6);
        }
        return result >>> 0;
    }

    writePriorities(first, value) {
        const { core } = this;
        for (let byte = 0; byte < 4; byte++) {
            const bit = 1 << (first + byte);
            const priority = (value >>> (8 * byte + 6)) & 3;
            for (let level = 0; level < 4; level++) {
                core.interruptPriorities[level] &= ~bit;
            }
            core.interruptPriorities[priority] |= bit;
        }
        core.interruptsUpdated = true;
    }
}
