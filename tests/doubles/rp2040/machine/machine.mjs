// SPDX-License-Identifier: Apache-2.0
// An RP2040 with processors, PIO blocks, PWM slices and timers that are synchronous to the cycle.
//
//   const machine = new Machine({ rom });
//   machine.load(readElf('program.elf'));
//   machine.run(125_000);                     // a millisecond at 125 MHz
//
// Each core has its own time.  The core that is behind runs next, unless another event is due earlier.  An instruction
// accesses memory in its first cycle.
import { CycleClock } from './clock.mjs';
import { Core, Fault, replicate } from './core.mjs';
import { Launch } from './launch.mjs';
import { BusControl, FlashCache, MemoryBus } from './memory_bus.mjs';
import { BasePeripheral, IRQ, RP2040 } from './package.mjs';
import { Pads } from './pads.mjs';
import { PioBlock } from './pio.mjs';
import { Pwm } from './pwm.mjs';
import { PowerOn, Registers, Resets } from './resets.mjs';
import { RingOscillator } from './ring_oscillator.mjs';
import { Sio } from './sio.mjs';
import { Timer } from './timer.mjs';
import { Uart } from './uart.mjs';
import { UsbDevice } from './usb_device.mjs';
import { UsbHost } from './usb_host.mjs';
import { Watchdog, WatchdogMemory } from './watchdog.mjs';

const FLASH = 0x10000000;
const SRAM = 0x20000000;
const SRAM_END = 0x20042000;
const BOOT2_COPY = 0x20041f00;
const BOOT2_SIZE = 256;
const ROM_END = 0x4000;
// appears four times, every 4 kB: its aliases do not set or clear bits (raspberrypi/pico-feedback 75)
const DPRAM = 0x50100000;
const XIP_SRAM = 0x15000000;
const XIP_SRAM_SIZE = 16 * 1024;

const SSI_ENABLE = 0x08;
const CHIP_ID_B2 = 0x20002927;

// Data sheet of the RP2040, 2.8.1.1, and pico-bootrom: scratch 4 to 7 request a jump instead of a boot from flash.
const BOOT_MAGIC = 0xb007c0d3;

export class Machine {
    /**
     * `rom`: image of the boot ROM.  `clock`: of clk_sys in Hz, from the first cycle on.  `flashSize` in bytes.
     * `usb`: options of UsbHost.  `bootCycles`: from reset to the first instruction of the image's second stage.
     * `waitStates`: memory takes time: the flash has its cache, and the cores wait for each other.
     * `flashTimes`: microseconds of erasing a sector of flash and of programming a page, if not the typical ones.
     */
    constructor({
        rom, romSymbols = new Map(), clock = 125e6, flashSize = 2 << 20, usb = {}, bootCycles = 0, waitStates = false,
        flashTimes,
    }) {
        this.clock = new CycleClock(clock);
        this.rom = rom;
        this.flashSize = flashSize;
        this.bootCycles = bootCycles;
        this.waitStates = waitStates;
        this.withoutFlash = [false, false]; // cores that must not access flash
        this.external = new Int8Array(30).fill(-1);
        this.watchdogMemory = new WatchdogMemory();
        this.noise = { state: 1 };
        this.symbols = new Map();
        this.faults = [];
        this.resets = [];
        this.stopReason = null;
        this.pendingReset = null;
        this.probes = [null, null]; // per core: functions by address, called before the instruction there
        this.onPin = []; // (pin, level, enabled)
        this.onPwmTaken = []; // (slice)
        this.onPwmWrap = []; // (slice)
        this.onException = []; // (core, number, entered)
        this.onReset = []; // (cause)
        this.onFlashWrite = []; // (offset, size, value): erased words, programmed bytes
        if (flashTimes !== undefined) {
            const view = new DataView(rom.buffer, rom.byteOffset);
            flashTimes.forEach((time, n) => view.setUint32(romSymbols.get('rom_flash_times_us').address + 4 * n, time, true));
        }
        this.usbBootAddress = romSymbols.get('rom_reset_usb_boot')?.address ?? -1;
        this.usbOptions = usb;
        this.uartData = () => {}; // (byte, number)
        this.uartOutside = [0, 1].map(() => ({ baud: 115200, queue: [] })); // the devices on the UARTs
        this.flashOff = false;
        this.build(null);
        this.usbHost = new UsbHost(this, usb);
        this.usb.host = this.usbHost;
    }

    // Construction and reset -------------------------------------------------------------------------------------------

    build(before) {
        const chip = new RP2040(this.clock);
        if (before !== null) {
            Object.assign(chip, {
                flash: before.flash, flash16: before.flash16, flashView: before.flashView,
                sram: before.sram, sramView: before.sramView,
            });
        }
        chip.bootrom.set(new Uint32Array(this.rom.slice().buffer));
        this.chip = chip;
        this.pio = [];
        this.cores = [];
        this.cores = [new Core(this, chip, 0), new Core(this, chip, 1)];
        chip.core = this.cores[0];
        chip.setInterrupt = (irq, level) => this.setInterrupt(irq, level);
        chip.onBreak = () => {
            throw new Fault('breakpoint or undefined instruction', this.current.opcodePC);
        };
        chip.logger = this.logger();
        chip.updateClkSys = () => { // clk_sys of this machine has its frequency from the start
            chip.clkSys = chip.clocks.sysFreq || chip.clkSys;
        };
        this.launch = new Launch(this);
        this.sio = chip.sio = new Sio(this, chip);
        this.pwm = chip.pwm = new Pwm(this, chip);
        this.pio = chip.pio = [];
        this.lockstepBlocks = [];
        this.pads = new Pads(this, chip);
        this.pio.push(new PioBlock(this, chip, 0, IRQ.PIO0_IRQ0), new PioBlock(this, chip, 1, IRQ.PIO1_IRQ0));
        this.timer = new Timer(this, chip);
        this.uarts = chip.uart = [new Uart(this, chip, 0), new Uart(this, chip, 1)];
        this.uarts.forEach((uart) => {
            uart.onData = (byte, number) => this.uartData(byte, number);
        });
        this.usb = chip.usbCtrl = new UsbDevice(this, chip);
        this.usb.host = this.usbHost ?? null;
        this.xipSram = new Uint32Array(XIP_SRAM_SIZE / 4);
        this.flashCache = new FlashCache(chip, chip.peripherals[0x18000]);
        this.busControl = new BusControl(chip, 'BUSCTRL');
        this.memoryBus = this.waitStates ? new MemoryBus(this.flashCache, this.busControl) : null;
        this.cores.forEach((core) => {
            core.bus = this.memoryBus;
            this.hookFlash(core, null);
        });
        Object.assign(chip.peripherals, {
            0x14000: this.flashCache,
            0x40000: new Registers(chip, 'SYSINFO', { 0: CHIP_ID_B2, 4: 2, 0x40: 0x7f000000 }),
            0x4000c: new Resets(this, chip),
            0x40010: new PowerOn(this, chip),
            0x40030: this.busControl,
            0x40018: new Registers(chip, 'IO_QSPI'),
            0x40050: this.pwm,
            0x40054: this.timer,
            0x40058: new Watchdog(this, chip, this.watchdogMemory),
            0x40060: new RingOscillator(chip, this.noise),
            0x40064: new Registers(chip, 'VREG_AND_CHIP_RESET', { 0: 0x1000, 8: before === null ? 0x100 : 0 }),
            0x40034: this.uarts[0],
            0x40038: this.uarts[1],
            0x50110: this.usb,
            0x50200: this.pio[0],
            0x50300: this.pio[1],
        });
        this.wrapFlashInterface(chip.peripherals[0x18000]);
        this.pads.reset(true, true);
        this.current = this.cores[0];
    }

    logger() {
        return {
            debug() {},
            error() {},
            info: (_, message) => {
                if (message === 'SEV') {
                    this.cores[0].signalEvent();
                    this.cores[1].signalEvent();
                }
            },
            warn: (_, message) => {
                if (message.startsWith('Warning: Instruction')) {
                    throw new Fault('undefined instruction', this.current.opcodePC);
                }
            },
        };
    }

    /**
     * While the SSI is disabled or in command mode, a read of flash gives random data on the chip; here it is a fault.
     */
    wrapFlashInterface(ssi) {
        const write = ssi.writeUint32.bind(ssi);
        ssi.writeUint32 = (offset, value) => {
            write(offset, value);
            if (offset === SSI_ENABLE) {
                this.flashOff = (value & 1) === 0;
                this.cores.forEach((core) => this.hookFlash(core, core.recorder ?? null));
            }
        };
    }

    /** `recorder(core, address)` is called for each access of the core to flash. */
    hookFlash(core, recorder) {
        core.recorder = recorder;
        if (this.withoutFlash[core.number]) {
            core.onFlash = (user, address) => {
                recorder?.(user, address);
                throw new Fault('access to flash by a core that must not have any', address);
            };
        } else {
            core.onFlash = !this.flashOff ? recorder : (user, address) => {
                if (user.opcodePC >= ROM_END) {
                    throw new Fault('flash is not readable now', address);
                }
            };
        }
    }

    /** From now on, each access of a core to flash is a fault, also after a reset; or no longer. */
    forbidFlash(number, forbidden) {
        this.withoutFlash[number] = forbidden;
        const core = this.cores[number];
        this.hookFlash(core, core.recorder ?? null);
    }

    load(image) {
        this.symbols = image.symbols;
        let inFlash = false;
        for (const { address, data } of image.segments) {
            if (address >= FLASH && address < FLASH + this.flashSize) {
                this.chip.flash.set(data, address - FLASH);
                inFlash = true;
            } else if (address >= SRAM && address + data.length <= SRAM_END) {
                this.chip.sram.set(data, address - SRAM);
            } else {
                throw new Error(`the image has data for 0x${address.toString(16)}, which is neither flash nor SRAM`);
            }
        }
        this.entry = inFlash ? null : image.entry;
        this.boot();
    }

    /** Does what the boot ROM does before it jumps to the image. */
    boot() {
        const [core] = this.cores;
        const { scratch } = this.watchdogMemory;
        if (scratch[4] === BOOT_MAGIC && (scratch[5] ^ -BOOT_MAGIC) >>> 0 === scratch[7]) {
            scratch[4] = 0;
            core.start(scratch[7], scratch[6], 0);
        } else if (this.entry !== null) {
            core.start(this.entry, SRAM_END, 0);
        } else {
            this.chip.sram.set(this.chip.flash.subarray(0, BOOT2_SIZE), BOOT2_COPY - SRAM);
            core.start(BOOT2_COPY, BOOT2_COPY, 0); // its stack is below its code
        }
        core.time += this.bootCycles;
    }

    /** Resets the chip after the running instruction. */
    requestReset(cause) {
        this.pendingReset = cause;
    }

    /** The supply is switched off and on: after that, the contents of SRAM are random. */
    cutPower() {
        for (let at = 0, noise = 0x2545f491; at < this.chip.sram.length; at++) {
            noise = Math.imul(noise, 1664525) + 1013904223 | 0; // Numerical Recipes, 7.1
            this.chip.sram[at] = noise >>> 24;
        }
        this.reset('power');
    }

    reset(cause) {
        this.pendingReset = null;
        if (!cause.startsWith('watchdog')) {
            this.watchdogMemory.reason = 0;
            this.watchdogMemory.scratch.fill(0);
        }
        this.resets.push({ cause, cycle: this.clock.now });
        const { chip } = this;
        this.clock.forgetChip();
        this.flashOff = false;
        this.build(chip);
        this.onReset.forEach((call) => call(cause));
        this.usbHost.deviceReplaced();
        this.boot();
    }

    // Running ----------------------------------------------------------------------------------------------------------

    /** Runs until cycle `end`, or until something calls stop(). */
    run(end) {
        this.stopReason = null;
        const { clock } = this;
        while (this.stopReason === null) {
            const [a, b] = this.cores;
            const first = a.running && !a.waiting;
            const second = b.running && !b.waiting;
            const core = first ? (second && b.time < a.time ? b : a) : second ? b : null;
            const time = core === null ? Infinity : core.time;
            const event = clock.first === null ? Infinity : clock.first.cycle;
            if (this.lockstepBlocks.length > 0 && !this.advanceLockstep(Math.min(time, event, end))) {
                continue; // an event has woken a core
            }
            if (event <= time && event < end) {
                clock.fireNext();
            } else if (time >= end) {
                clock.now = end;
                return;
            } else {
                clock.now = time;
                this.current = core;
                const probes = this.probes[core.number];
                if (probes !== null) {
                    probes.get(core.PC & ~1)?.(core);
                    if (this.stopReason !== null) {
                        return;
                    }
                }
                core.step();
            }
            if (this.pendingReset !== null) {
                this.reset(this.pendingReset);
            }
        }
    }

    stop(reason) {
        this.stopReason = reason;
    }

    advanceLockstep(target) {
        const { clock, lockstepBlocks } = this;
        let cycle = Infinity;
        for (const block of lockstepBlocks) {
            cycle = Math.min(cycle, block.time);
        }
        while (cycle < target) {
            clock.now = Math.max(clock.now, cycle);
            const asleep = this.cores.map((core) => core.waiting);
            cycle++;
            for (const block of lockstepBlocks) {
                block.advance(cycle);
            }
            if (this.cores.some((core, n) => asleep[n] && !core.waiting)) {
                return false;
            }
        }
        return true;
    }

    lockstepChanged() {
        this.lockstepBlocks = this.pio.filter((block) => block.lockstep);
    }

    /** Brings everything that runs late up to the present cycle. */
    settle() {
        this.pio.forEach((block) => block.advance(this.clock.now));
    }

    // Peripherals ------------------------------------------------------------------------------------------------------

    setInterrupt(irq, level) {
        for (const core of this.cores) {
            core.setInterrupt(irq, level);
        }
    }

    readPeripheral(address) {
        const peripheral = this.chip.findPeripheral(address);
        if (peripheral !== undefined) {
            return peripheral.readUint32(address & 0xfff);
        }
        if (address >>> 14 === DPRAM >>> 14) {
            return this.chip.usbDPRAMView.getUint32(address & 0xffc, true);
        }
        if (address - XIP_SRAM >= 0 && address - XIP_SRAM < XIP_SRAM_SIZE) {
            return this.xipSram[(address - XIP_SRAM) >> 2];
        }
        throw new Fault('read of an address where nothing is', address);
    }

    writePeripheral(core, address, value, size) {
        const peripheral = this.chip.findPeripheral(address);
        if (peripheral !== undefined) {
            BasePeripheral.prototype.writeUint32Atomic.call(
                peripheral, address & 0xfff, replicate(value, size), (address & 0x3000) >> 12);
        } else if (address >>> 14 === DPRAM >>> 14) {
            this.writeBufferMemory(address & 0xfff, value, size);
        } else if (address >>> 26 === 4 && core.opcodePC < ROM_END) {
            this.programFlash(address & 0xffffff, value, size);
        } else if (address - XIP_SRAM >= 0 && address - XIP_SRAM < XIP_SRAM_SIZE && size === 4) {
            this.xipSram[(address - XIP_SRAM) >> 2] = value;
        } else if (address >= ROM_END) { // a write to ROM has no effect
            throw new Fault('write to an address where nothing is', address);
        }
    }

    writeBufferMemory(offset, value, size) {
        const { usbDPRAMView: view } = this.chip;
        if (size === 4) {
            view.setUint32(offset, value, true);
        } else if (size === 2) {
            view.setUint16(offset, value & 0xffff, true);
        } else {
            view.setUint8(offset, value & 0xff);
        }
        this.usb.DPRAMUpdated(offset);
    }

    /** EPG's boot ROM writes flash through this: words erase, bytes program (which can only clear bits). */
    programFlash(offset, value, size) {
        if (offset + size > this.flashSize) {
            return;
        }
        if (size === 4) {
            this.chip.flashView.setUint32(offset, value, true);
        } else {
            this.chip.flash[offset] &= value;
        }
        this.onFlashWrite.forEach((call) => call(offset, size, value));
    }

    // Events -----------------------------------------------------------------------------------------------------------

    pinChanged(pin, level, enabled) {
        for (const call of this.onPin) {
            call(pin, level, enabled);
        }
    }

    pioOutput(mask) {
        this.pads.refreshMask(mask);
    }

    pwmTaken(slice) {
        for (const call of this.onPwmTaken) {
            call(slice);
        }
    }

    pwmWrapped(slice) {
        for (const call of this.onPwmWrap) {
            call(slice);
        }
    }

    exceptionTaken(core, number) {
        for (const call of this.onException) {
            call(core, number, true);
        }
    }

    exceptionLeft(core, number) {
        for (const call of this.onException) {
            call(core, number, false);
        }
    }

    // Inspection -------------------------------------------------------------------------------------------------------

    /** Calls `call(core)` before the instruction at `address` of core `number`; several calls may share an address. */
    probe(number, address, call) {
        this.probes[number] ??= new Map();
        const table = this.probes[number];
        const before = table.get(address);
        table.set(address, before === undefined ? call : (core) => {
            before(core);
            call(core);
        });
    }

    address(place) {
        if (typeof place === 'number') {
            return place;
        }
        const symbol = this.symbols.get(place);
        if (symbol === undefined) {
            throw new Error(`the image has no symbol ${place}`);
        }
        return symbol.address;
    }

    readMemory(address, length) {
        const bytes = new Uint8Array(length);
        for (let n = 0; n < length; n++) {
            bytes[n] = this.byteAt(address + n);
        }
        return bytes;
    }

    byteAt(address) {
        if (address >= SRAM && address < SRAM_END) {
            return this.chip.sram[address - SRAM];
        }
        if (address >= FLASH && address < FLASH + this.flashSize) {
            return this.chip.flash[address - FLASH];
        }
        if (address < ROM_END) {
            return this.cores[0].rom8[address];
        }
        throw new Error(`0x${address.toString(16)} is no memory`);
    }

    writeMemory(address, bytes) {
        if (address < SRAM || address + bytes.length > SRAM_END) {
            throw new Error(`0x${address.toString(16)} is no SRAM`);
        }
        this.chip.sram.set(bytes, address - SRAM);
    }
}
