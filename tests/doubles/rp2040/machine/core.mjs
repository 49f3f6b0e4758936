// SPDX-License-Identifier: Apache-2.0
// One Cortex-M0+: the package executes the instructions; exceptions, faults, sleep and the bus follow the architecture.
//
// Differences from the package: exceptions take time; an interrupt stays pending when its line falls; PRIMASK blocks
// interrupts but lets them end WFI; WFE waits for an event of its own core; faults (unaligned access, no device,
// undefined instruction, BKPT without debugger) escalate to HardFault and lockup; NVIC, SysTick and SIO are per core.
import { CortexM0Core } from './package.mjs';
import { PrivateBus } from './private_bus.mjs';

// Cortex-M0+ Technical Reference Manual, 3.2 and 5.2: 15 cycles from the interrupt to the first instruction of its
// handler, for memory without wait states.  The return takes 12 cycles in addition to the BX or POP.
const EXCEPTION_ENTRY = 15;
const EXCEPTION_RETURN = 12;

const HARD_FAULT = 3;
const SVCALL = 11;
const PENDSV = 14;
const SYSTICK = 15;
const EXTERNAL = 16;
const LOWEST = 4; // lower than every priority that software can set
const WFE = 0xbf20;
const OWN_OPERATIONS = 0b11111100; // of the opcodes 0100000xxx: LSLS, LSRS, ASRS, ADCS, SBCS, RORS

const SRAM_SIZE = 264 * 1024;
const ROM_SIZE = 16 * 1024;
const FLASH_MASK = 0xffffff;

/** A fault of the running instruction. */
export class Fault {
    constructor(cause, address) {
        this.cause = cause;
        this.address = address >>> 0;
    }
}

export class Core extends CortexM0Core {
    constructor(machine, chip, number) {
        super(chip);
        this.machine = machine;
        this.number = number;
        this.time = 0; // cycle at which the next instruction starts
        this.extra = 0; // additional cycles of the running instruction
        this.running = false; // false in reset, and while the boot ROM waits for a launch
        this.lockedUp = false;
        this.waitsForEvent = false;
        this.instructions = 0;
        this.activeInterrupts = 0;
        this.interruptLines = 0;
        this.opcodePC = 0;
        this.sram8 = chip.sram;
        this.sram16 = new Uint16Array(chip.sram.buffer);
        this.sram32 = new Uint32Array(chip.sram.buffer);
        this.flash16 = chip.flash16;
        this.flash32 = new Uint32Array(chip.flash.buffer);
        this.flashSize = machine.flashSize;
        this.rom32 = chip.bootrom;
        this.rom16 = new Uint16Array(chip.bootrom.buffer);
        this.rom8 = new Uint8Array(chip.bootrom.buffer);
        this.onFlash = null; // (core, address) of each access to flash, fetches included
        this.bus = null; // MemoryBus, if memory takes time
        this.accesses = 0; // of the running instruction
        this.fetched = -1; // the word of the last fetch: an instruction of 16 bits needs none if it is in this word
        this.watches = []; // watched writes to RAM: {low, high, call(core, address, size, value)}
        this.forbidden = []; // ranges [low, high) that the MPU protects
        this.writeLow = 0; // bounds that include all ranges of both lists
        this.writeHigh = 0;
        this.privateBus = new PrivateBus(this, chip, machine.clock);
    }

    /** Starts at `entry` with all state cleared. */
    start(entry, stack, vectors) {
        this.registers.fill(0);
        this.VTOR = vectors;
        this.PM = false;
        this.IPSR = 0;
        this.SPSEL = 0;
        this.nPRIV = false;
        this.currentMode = 0;
        this.pendingInterrupts = this.interruptLines;
        this.enabledInterrupts = 0;
        this.activeInterrupts = 0;
        this.interruptPriorities = [0xffffffff, 0, 0, 0];
        this.pendingPendSV = this.pendingSVCall = this.pendingSystick = false;
        this.SHPR2 = this.SHPR3 = 0;
        this.waiting = this.lockedUp = this.eventRegistered = false;
        this.interruptsUpdated = false;
        this.privateBus.reset();
        this.SP = stack;
        this.bankedSP = 0;
        this.PC = entry & ~1;
        this.time = this.machine.clock.now;
        this.running = true;
    }

    stop() {
        this.running = false;
        this.privateBus.reset();
    }

    get runnable() {
        return this.running && !this.waiting;
    }

    /** Executes one instruction, or enters an exception.  Advances `time`. */
    step() {
        if (this.interruptsUpdated && this.takeException()) {
            return;
        }
        const pc = this.PC & ~1;
        this.opcodePC = pc;
        this.accesses = 0;
        try {
            if (pc >>> 28 > 2) {
                throw new Fault('execution of memory that is not executable', pc);
            }
            const opcode = this.fetch(pc);
            if ((opcode & 0xfe00) === 0x4000 && OWN_OPERATIONS & (1 << ((opcode >> 6) & 7))) {
                this.operate(opcode);
            } else {
                this.time += this.executeInstruction();
                if ((opcode & 0xf700) === 0xb500) {
                    this.time += 1; // the package does not count LR in PUSH and PC in POP
                }
            }
        } catch (fault) {
            if (!(fault instanceof Fault)) {
                throw fault;
            }
            this.time += 1;
            this.hardFault(fault, pc);
        }
        this.instructions++;
        if (this.extra !== 0) {
            this.time += this.extra;
            this.extra = 0;
        }
        if (this.waiting) {
            this.waitsForEvent = this.fetch(pc) === WFE;
            this.interruptsUpdated = true; // an interrupt that is already pending ends the sleep
            this.wake(this.time);
        }
    }

    /** Shifts by a register, ADCS and SBCS: the package computes carry and overflow wrongly for some operands. */
    operate(opcode) {
        const { registers } = this;
        this.readUint16(this.opcodePC); // as the package does for the other instructions
        const value = registers[opcode & 7];
        const by = registers[(opcode >> 3) & 7] & 0xff;
        let result = value;
        const operation = (opcode >> 6) & 7;
        if (operation === 5 || operation === 6) { // subtraction adds the complement
            const other = operation === 5 ? registers[(opcode >> 3) & 7] : ~registers[(opcode >> 3) & 7] >>> 0;
            const sum = value + other + (this.C ? 1 : 0);
            result = sum >>> 0;
            this.C = sum > 0xffffffff;
            this.V = ((value ^ result) & (other ^ result)) < 0;
        } else if (by !== 0) {
            switch (operation) {
                case 2:
                    result = by < 32 ? value << by : 0;
                    this.C = by <= 32 && ((value >>> (32 - by)) & 1) === 1;
                    break;
                case 3:
                    result = by < 32 ? value >>> by : 0;
                    this.C = by <= 32 && ((value >>> (by - 1)) & 1) === 1;
                    break;
                case 4:
                    result = (value | 0) >> Math.min(by, 31);
                    this.C = ((value >> Math.min(by - 1, 31)) & 1) === 1;
                    break;
                default:
                    result = (value >>> (by & 31)) | (by & 31 ? value << (32 - (by & 31)) : 0);
                    this.C = result < 0 || result > 0x7fffffff;
            }
        }
        result >>>= 0;
        registers[opcode & 7] = result;
        this.N = result > 0x7fffffff;
        this.Z = result === 0;
        this.PC += 2;
        this.time += 1;
        this.cycles += 1;
    }

    /** Ends WFI or WFE if there is a reason to. */
    wake(cycle) {
        if (!this.waiting || this.lockedUp) {
            return;
        }
        if (this.waitsForEvent && this.eventRegistered) {
            this.eventRegistered = false;
        } else if (!this.interruptsUpdated || this.highestPending(false) === 0) {
            return;
        }
        this.waiting = false;
        if (this.time < cycle) {
            this.time = cycle;
        }
    }

    /** An event: from SEV of either core, or from an exception. */
    signalEvent() {
        this.eventRegistered = true;
        this.wake(this.machine.clock.now);
    }

    // Exceptions ---------------------------------------------------------------------------------------------------

    setInterrupt(irq, level) {
        const bit = 1 << irq;
        if (level) {
            if (!(this.interruptLines & bit)) {
                this.interruptLines |= bit;
                this.pend(bit);
            }
        } else {
            this.interruptLines &= ~bit;
        }
    }

    pend(bits) {
        this.pendingInterrupts |= bits;
        this.interruptsUpdated = true;
        if (this.waiting) {
            if (this.privateBus.sendEventOnPend) {
                this.eventRegistered = true;
            }
            this.wake(this.machine.clock.now);
        }
    }

    executionPriority(masked) {
        const active = this.IPSR === 0 ? LOWEST : this.exceptionPriority(this.IPSR);
        return masked && this.PM ? Math.min(active, 0) : active;
    }

    /** The number of the exception that would be taken; 0 if there is none.  `masked`: respect PRIMASK. */
    highestPending(masked) {
        const current = this.executionPriority(masked);
        const interrupts = this.pendingInterrupts & this.enabledInterrupts;
        for (let priority = 0; priority < current; priority++) {
            if (this.pendingSVCall && this.svCallPriority === priority) {
                return SVCALL;
            }
            if (this.pendingPendSV && this.pendSVPriority === priority) {
                return PENDSV;
            }
            if (this.pendingSystick && this.systickPriority === priority) {
                return SYSTICK;
            }
            const level = interrupts & this.interruptPriorities[priority];
            if (level !== 0) {
                return EXTERNAL + 31 - Math.clz32(level & -level);
            }
        }
        return 0;
    }

    takeException() {
        const number = this.highestPending(true);
        if (this.pendingSVCall && this.svCallPriority >= this.executionPriority(true)) {
            this.pendingSVCall = false;
            this.hardFault(new Fault('SVC at a priority that is too high', this.PC), this.PC & ~1);
            return true;
        }
        if (number === 0) {
            this.interruptsUpdated = false;
            return false;
        }
        if (number === SVCALL) {
            this.pendingSVCall = false;
        } else if (number === PENDSV) {
            this.pendingPendSV = false;
        } else if (number === SYSTICK) {
            this.pendingSystick = false;
        } else {
            const bit = 1 << (number - EXTERNAL);
            this.pendingInterrupts &= ~bit;
            this.activeInterrupts |= bit;
        }
        this.enter(number);
        return true;
    }

    enter(number) {
        this.extra = 0;
        try {
            this.exceptionEntry(number);
            this.PC &= ~1;
        } catch (fault) {
            if (!(fault instanceof Fault)) {
                throw fault;
            }
            if (number === HARD_FAULT) {
                this.lockUp(fault);
                return;
            }
            this.hardFault(fault, this.PC & ~1);
        }
        this.time += EXCEPTION_ENTRY + this.extra;
        this.extra = 0;
        this.machine.exceptionTaken(this, number);
    }

    exceptionReturn(value) {
        const from = this.IPSR;
        super.exceptionReturn(value);
        this.extra += EXCEPTION_RETURN;
        if (from >= EXTERNAL) {
            const bit = 1 << (from - EXTERNAL);
            this.activeInterrupts &= ~bit;
            // the line is still high: the interrupt becomes pending again
            this.pendingInterrupts |= this.interruptLines & bit;
        }
        this.machine.exceptionLeft(this, from);
    }

    hardFault(fault, pc) {
        this.machine.faults.push({
            core: this.number, cycle: this.time, pc, cause: fault.cause, address: fault.address, lockup: false,
        });
        if (this.IPSR === HARD_FAULT) {
            this.lockUp(fault);
            return;
        }
        this.PC = pc;
        this.waiting = false;
        this.enter(HARD_FAULT);
    }

    lockUp(fault) {
        this.lockedUp = true;
        this.waiting = true;
        this.machine.faults.push({
            core: this.number, cycle: this.time, pc: this.PC >>> 0, cause: fault.cause, address: fault.address,
            lockup: true,
        });
    }

    BXWritePC(address) {
        if (this.currentMode === 1 && address >>> 28 === 0xf) {
            this.exceptionReturn(address & 0x0fffffff);
        } else if (address & 1) {
            this.PC = address & ~1;
        } else {
            throw new Fault('branch to ARM code', address);
        }
    }

    // Bus ----------------------------------------------------------------------------------------------------------

    /** The halfword at an address that was executed. */
    fetch(pc) {
        switch (pc >>> 28) {
            case 0:
                return this.rom16[pc >>> 1];
            case 1:
                return this.flash16[(pc & FLASH_MASK) >>> 1];
            default:
                return this.sram16[(pc - 0x20000000) >>> 1];
        }
    }

    /** Waits for an access of the running instruction to SRAM or flash.  The first one is the fetch. */
    waitForMemory(address) {
        const fetch = address - this.opcodePC;
        if (fetch === 0 || fetch === 2) {
            const word = address >>> 2;
            if (word === this.fetched) {
                return;
            }
            this.fetched = word;
        }
        const cycle = this.time + this.extra + this.accesses++;
        const ram = address - 0x20000000;
        this.extra += ram >= 0 ? this.bus.sram(this.number, ram, cycle) : this.bus.cache.access(address, cycle);
    }

    readUint32(address) {
        const a = address >>> 0;
        if (a & 3) {
            throw new Fault('unaligned read', a);
        }
        const ram = a - 0x20000000;
        if (ram >= 0 && ram < SRAM_SIZE) {
            if (this.bus !== null) {
                this.waitForMemory(a);
            }
            return this.sram32[ram >>> 2];
        }
        if (a >>> 26 === 4) {
            return this.flash32[this.flashOffset(a) >>> 2];
        }
        if (a < ROM_SIZE) {
            return this.rom32[a >>> 2];
        }
        return this.readDevice(a) >>> 0;
    }

    readUint16(address) {
        const a = address >>> 0;
        const ram = a - 0x20000000;
        if (ram >= 0 && ram < SRAM_SIZE && !(a & 1)) {
            if (this.bus !== null) {
                this.waitForMemory(a);
            }
            return this.sram16[ram >>> 1];
        }
        if (a & 1) {
            throw new Fault('unaligned read', a);
        }
        if (a >>> 26 === 4) {
            return this.flash16[this.flashOffset(a) >>> 1];
        }
        if (a < ROM_SIZE) {
            return this.rom16[a >>> 1];
        }
        return (this.readDevice(a & ~3) >>> ((a & 2) << 3)) & 0xffff;
    }

    readUint8(address) {
        const a = address >>> 0;
        const ram = a - 0x20000000;
        if (ram >= 0 && ram < SRAM_SIZE) {
            if (this.bus !== null) {
                this.waitForMemory(a);
            }
            return this.sram8[ram];
        }
        if (a >>> 26 === 4) {
            return this.rp2040.flash[this.flashOffset(a)];
        }
        if (a < ROM_SIZE) {
            return this.rom8[a];
        }
        return (this.readDevice(a & ~3) >>> ((a & 3) << 3)) & 0xff;
    }

    writeUint32(address, value) {
        const a = address >>> 0;
        if (a & 3) {
            throw new Fault('unaligned write', a);
        }
        const ram = a - 0x20000000;
        if (ram >= 0 && ram < SRAM_SIZE) {
            if (a < this.writeHigh && a + 4 > this.writeLow) {
                this.checkWrite(a, 4, value >>> 0);
            }
            if (this.bus !== null) {
                this.waitForMemory(a);
            }
            this.sram32[ram >>> 2] = value;
            return;
        }
        this.writeDevice(a, value, 4);
    }

    writeUint16(address, value) {
        const a = address >>> 0;
        if (a & 1) {
            throw new Fault('unaligned write', a);
        }
        const ram = a - 0x20000000;
        if (ram >= 0 && ram < SRAM_SIZE) {
            if (a < this.writeHigh && a + 2 > this.writeLow) {
                this.checkWrite(a, 2, value & 0xffff);
            }
            if (this.bus !== null) {
                this.waitForMemory(a);
            }
            this.sram16[ram >>> 1] = value;
            return;
        }
        this.writeDevice(a, value, 2);
    }

    writeUint8(address, value) {
        const a = address >>> 0;
        const ram = a - 0x20000000;
        if (ram >= 0 && ram < SRAM_SIZE) {
            if (a < this.writeHigh && a >= this.writeLow) {
                this.checkWrite(a, 1, value & 0xff);
            }
            if (this.bus !== null) {
                this.waitForMemory(a);
            }
            this.sram8[ram] = value;
            return;
        }
        this.writeDevice(a, value, 1);
    }

    /** Calls `call(core, address, size, value)` for each write to [low, high) in RAM. */
    watchWrites(low, high, call) {
        this.watches.push({ low, high, call });
        this.boundWrites();
    }

    forbidWrites(ranges) {
        this.forbidden = ranges;
        this.boundWrites();
    }

    boundWrites() {
        const ranges = [...this.forbidden, ...this.watches.map(({ low, high }) => [low, high])];
        this.writeLow = Math.min(...ranges.map(([low]) => low));
        this.writeHigh = ranges.length === 0 ? 0 : Math.max(...ranges.map(([, high]) => high));
    }

    checkWrite(address, size, value) {
        const end = address + size;
        const unprotected = this.IPSR === HARD_FAULT && !this.privateBus.mpu.protectsHardFault;
        for (const [low, high] of this.forbidden) {
            if (address < high && end > low && !unprotected) {
                throw new Fault('write that the MPU forbids', address);
            }
        }
        for (const { low, high, call } of this.watches) {
            if (address < high && end > low) {
                call(this, address, size, value);
            }
        }
    }

    /** Offset in the flash.  The four XIP windows (data sheet of the RP2040, 2.6.3.1) show the same contents. */
    flashOffset(address) {
        if (this.onFlash !== null) {
            this.onFlash(this, address);
        }
        if (this.bus !== null) {
            this.waitForMemory(address);
        }
        const offset = address & FLASH_MASK;
        return offset < this.flashSize ? offset : offset % this.flashSize;
    }

    readDevice(a) {
        if (a >>> 28 === 0xd) {
            return this.machine.sio.read(this.number, a & 0xfff);
        }
        if (a >>> 12 === 0xe000e) {
            return this.privateBus.readUint32(a & 0xfff);
        }
        this.waitForDevice(a, false);
        return this.machine.readPeripheral(a);
    }

    writeDevice(a, value, size) {
        if (a >>> 28 === 0xd) {
            this.machine.sio.write(this.number, a & 0xfff, replicate(value, size));
        } else if (a >>> 12 === 0xe000e) {
            this.privateBus.writeUint32(a & 0xfff, value >>> 0);
        } else {
            this.waitForDevice(a, true);
            this.machine.writePeripheral(this, a, value, size);
        }
    }

    waitForDevice(address, write) {
        if (this.bus !== null && address >>> 28 === 4) {
            this.extra += this.bus.apb(this.number, write, this.time + this.extra + this.accesses++);
        }
    }
}

/** A narrow write to a peripheral reaches all byte lanes (data sheet of the RP2040, 2.1.4). */
export function replicate(value, size) {
    if (size === 1) {
        return ((value & 0xff) * 0x01010101) >>> 0;
    }
    return size === 2 ? ((value & 0xffff) * 0x10001) >>> 0 : value >>> 0;
}
