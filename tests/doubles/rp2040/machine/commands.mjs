// SPDX-License-Identifier: Apache-2.0
// The commands of the driver.  Each method takes the parameters of a command and returns the answer.
import { readFileSync } from 'node:fs';
import { Encoder, ConstantSpeed, RandomWalk, ScheduledMotion } from './encoder.mjs';
import { readElf, readUf2 } from './elf.mjs';
import { Machine } from './machine.mjs';
import { JIWY, Motor } from './motor.mjs';
import { Random } from './usb_host.mjs';

const LOG_LIMIT = 2_000_000;

function need(value, name) {
    if (value === undefined || value === null) {
        throw new Error(`the parameter ${name} is missing`);
    }
    return value;
}

export class Commands {
    constructor() {
        this.machine = null;
        this.encoders = new Map();
        this.motions = new Map();
        this.motors = new Map();
        this.logs = { pins: [], pwm: [], exceptions: [], writes: [], flash: [] };
        this.spans = new Map(); // name -> recorded spans
        this.received = new Map(); // number of a USB serial port, uart0 or uart1 -> bytes
        this.awaited = {};
    }

    // Images and time --------------------------------------------------------------------------------------------------

    /**
     * {image, rom?, boot_rom?, clock?, flash_size?, flash_times?, boot_cycles?, wait_states?, usb?}; `rom` is an ELF file,
     * `boot_rom` a binary.  `flash_times`: microseconds [of erasing a sector, of programming a page].
     */
    load({
        image, rom, boot_rom: bootRom, clock, flash_size: flashSize, boot_cycles: bootCycles,
        wait_states: waitStates, flash_times: flashTimes, usb = {},
    }) {
        const [bytes, romSymbols] = bootRom ? [pad(readFileSync(bootRom)), new Map()] : romFromElf(need(rom, 'rom'));
        const { clock_error: clockError, packet_delay: delay, ...others } = usb;
        const packetDelay = delay === undefined ? undefined : (random) => delay[0] + random.next() * (delay[1] - delay[0]);
        const machine = new Machine({
            rom: bytes, romSymbols, clock, flashSize, bootCycles, waitStates, flashTimes,
            usb: { clockError, packetDelay, ...others },
        });
        this.machine = machine;
        machine.usbHost.onData = (data, port) => this.receive(data, port);
        machine.uartData = (byte, number) => this.receive([byte], `uart${number}`);
        if (machine.usbBootAddress >= 0) {
            for (const core of [0, 1]) {
                machine.probe(core, machine.usbBootAddress, () => machine.stop('usb boot'));
            }
        }
        machine.load(need(image, 'image').endsWith('.uf2') ? readUf2(image) : readElf(image));
        return { symbols: machine.symbols.size };
    }

    receive(data, port) {
        const bytes = this.bytesOf(port);
        for (const byte of data) {
            bytes.push(byte);
        }
        if (this.awaited.port === port && data.length > 0) {
            if (this.awaited.data) {
                this.machine.stop('data');
            } else if (this.awaited.text !== undefined && this.hasSaid(port, this.awaited.text)) {
                this.machine.stop('text');
            }
        }
    }

    /** The bytes that arrived over serial port `port` and that no command has taken yet. */
    bytesOf(port) {
        if (!this.received.has(port)) {
            this.received.set(port, []);
        }
        return this.received.get(port);
    }

    hasSaid(port, text) {
        return Buffer.from(this.bytesOf(port)).toString('latin1').includes(text);
    }

    /**
     * Runs {cycles} more or up to cycle {until}.  Stops earlier at one of these: {text}, when the output of serial port
     * {port} (default 0, the first) contains it; {data}, when that port has any output; {at}, before the instruction at
     * a symbol or address (of {core}, by default of either); {configured}, when USB is configured.
     */
    run({ cycles, until, text, data = false, port = 0, at, core, configured }) {
        const { machine } = this;
        const end = until ?? machine.clock.now + need(cycles, 'cycles');
        this.awaited = { text, data, port };
        this.watched = at === undefined ? null : machine.address(at);
        if (this.watched !== null) {
            this.probeStop(this.watched, core);
        }
        if (data ? this.bytesOf(port).length > 0 : text !== undefined && this.hasSaid(port, text)) {
            return this.state();
        }
        if (configured) {
            this.runUntilConfigured(end);
        } else {
            machine.run(end);
        }
        this.awaited = {};
        this.watched = null;
        machine.settle();
        return this.state();
    }

    runUntilConfigured(end) {
        const { machine } = this;
        while (machine.clock.now < end && !(machine.usbHost.isOpen)) {
            machine.run(Math.min(end, machine.clock.now + 12_500));
        }
        machine.stopReason = machine.usbHost.state === 'configured' ? 'configured' : null;
    }

    probeStop(address, core) {
        this.stopProbes ??= new Set();
        for (const number of core === undefined ? [0, 1] : [core]) {
            const key = `${number}:${address}`;
            if (!this.stopProbes.has(key)) {
                this.stopProbes.add(key);
                let stoppedAt = -1;
                this.machine.probe(number, address, (at) => {
                    if (this.watched === address && stoppedAt !== at.time) {
                        stoppedAt = at.time;
                        this.machine.stop('at');
                    }
                });
            }
        }
    }

    state() {
        const { machine } = this;
        return {
            cycle: machine.clock.now,
            reason: machine.stopReason ?? 'end',
            usb: machine.usbHost.state,
            clk_sys: machine.chip.clkSys,
            faults: machine.faults.length,
            resets: machine.resets,
            cores: machine.cores.map((core) => ({
                running: core.running, waiting: core.waiting, locked_up: core.lockedUp, pc: core.PC >>> 0,
                sp: core.SP >>> 0, exception: core.IPSR, instructions: core.instructions,
            })),
        };
    }

    faults() {
        return this.machine.faults;
    }

    /** A reset from outside the chip, as by the RUN pin. */
    reset() {
        this.machine.reset('run pin');
        return null;
    }

    /** Switches the supply off and on; flash keeps its contents. */
    cut_power() {
        this.machine.cutPower();
        return null;
    }

    /** {scratch, reason}: the registers that survive a watchdog reset. */
    watchdog() {
        const { reason, scratch } = this.machine.watchdogMemory;
        return { reason, scratch: [...scratch] };
    }

    // Memory -------------------------------------------------------------------------------------------------------------

    symbol({ name }) {
        const symbol = this.machine.symbols.get(need(name, 'name'));
        return symbol ?? null;
    }

    symbols({ contains = '' }) {
        const found = [...this.machine.symbols].filter(([name]) => name.includes(contains));
        return Object.fromEntries(found.map(([name, { address, size }]) => [name, { address, size }]));
    }

    /** {at: symbol or address, offset?, length} -> hex */
    read({ at, offset = 0, length }) {
        const size = length ?? this.machine.symbols.get(at)?.size;
        return Buffer.from(this.machine.readMemory(this.machine.address(at) + offset, need(size, 'length'))).toString('hex');
    }

    write({ at, offset = 0, hex }) {
        this.machine.writeMemory(this.machine.address(at) + offset, Buffer.from(need(hex, 'hex'), 'hex'));
        return null;
    }

    /**
     * Executes single instructions: each of {runs} has {code: hex, registers: [r0 ... r12, sp], flags: NZCV, once} and
     * gives [registers, flags, cycles, fault or null].  Writes the code to {at}, and destroys the state of core 0.
     */
    execute({ at, runs }) {
        const { machine } = this;
        const [core] = machine.cores;
        return runs.map(({ code, registers, flags, once }) => {
            const bytes = Buffer.from(code, 'hex');
            machine.writeMemory(at, bytes);
            registers.forEach((value, n) => {
                core.registers[n] = value;
            });
            core.APSR = flags << 28;
            core.PC = at;
            core.IPSR = 0;
            core.currentMode = 0;
            core.waiting = false;
            const faults = machine.faults.length;
            const start = core.time;
            machine.clock.now = start;
            let steps = once ? 1 : 1000;
            while (steps-- > 0 && core.PC < at + bytes.length && core.PC >= at && machine.faults.length === faults) {
                core.step();
            }
            const fault = machine.faults.length > faults ? machine.faults.pop().cause : null;
            return [[...core.registers.subarray(0, 14)], core.APSR >>> 28, core.time - start, fault];
        });
    }

    /** The value of a peripheral's register, as core 0 would read it. */
    read_register({ address }) {
        return this.machine.cores[0].readUint32(address) >>> 0;
    }

    /** Writes a register of a peripheral, or one of its SET, CLR and XOR aliases. */
    write_register({ address, value }) {
        this.machine.cores[0].writeUint32(address, value);
        return null;
    }

    /** Runs the PIO blocks cycle by cycle from now on, even where nothing outside could see the difference. */
    pio_lockstep() {
        for (const block of this.machine.pio) {
            block.forced = true;
            block.analyse();
        }
        return null;
    }

    /** The state of state machine {machine} of PIO {block}; {set: {x, y}} changes registers without an address. */
    pio({ block, machine: number, set = {} }) {
        this.machine.settle();
        const unit = this.machine.pio[block].units[number];
        for (const [name, value] of Object.entries(set)) {
            if (name !== 'x' && name !== 'y') {
                throw new Error(`${name} is not x or y`);
            }
            unit[name] = value >>> 0;
        }
        const { enabled, pc, x, y, stalled } = unit;
        return { enabled, pc, x, y, stalled, received: unit.rx.count };
    }

    /** Records writes to {at, length}: [cycle, core, address, size, value, pc]. */
    watch_memory({ at, length }) {
        const { machine } = this;
        const low = machine.address(at);
        const high = low + (length ?? machine.symbols.get(at)?.size ?? 4);
        const install = () => machine.cores.forEach((core) => core.watchWrites(low, high, (user, address, size, value) => {
            this.record('writes', [user.time, user.number, address, size, value, user.opcodePC]);
        }));
        install();
        machine.onReset.push(install);
        return null;
    }

    /**
     * Logs every write to flash under `flash`: [cycle, offset, bytes (4: erased, 1: programmed), value].  With
     * {stop_after}, run() stops once after that many writes, with the reason `flash`.
     */
    watch_flash({ stop_after: stopAfter = Infinity }) {
        const { machine } = this;
        this.flashWritesLeft = stopAfter;
        if (!this.flashIsWatched) {
            this.flashIsWatched = true;
            machine.onFlashWrite.push((offset, size, value) => {
                this.record('flash', [machine.clock.now, offset, size, value]);
                if (--this.flashWritesLeft === 0) {
                    machine.stop('flash');
                }
            });
        }
        return null;
    }

    record(log, entry) {
        if (this.logs[log].length >= LOG_LIMIT) {
            throw new Error(`the log ${log} has ${LOG_LIMIT} entries: take them earlier`);
        }
        this.logs[log].push(entry);
    }

    /** Takes the entries of a log (pins, pwm, exceptions, writes, flash). */
    take({ log }) {
        const entries = this.logs[log];
        if (entries === undefined) {
            throw new Error(`there is no log ${log}`);
        }
        this.logs[log] = [];
        return entries;
    }

    // Pins and PWM -------------------------------------------------------------------------------------------------------

    /** Drives a pin from outside: {pin, level}.  Level null stops driving it. */
    drive({ pin, level }) {
        this.machine.pads.drive(need(pin, 'pin'), level === null ? -1 : level);
        return null;
    }

    pin({ pin }) {
        return this.machine.pads.state(pin);
    }

    /** Records the edges of {pins}: [cycle, pin, level, driven by the chip]. */
    watch_pins({ pins }) {
        const watched = new Set(pins);
        this.machine.onPin.push((pin, level, enabled) => {
            if (watched.has(pin)) {
                this.record('pins', [this.machine.clock.now, pin, level, enabled]);
            }
        });
        return null;
    }

    /**
     * Records the values of {slices} when they take effect: [cycle, slice, a, b, top, wrap], where `wrap` is the number
     * of the wrap.  With {wraps}, records every wrap of these slices.
     */
    watch_pwm({ slices, wraps = false }) {
        const watched = new Set(slices);
        const numbers = new Map();
        const entry = (slice, number) => [this.machine.clock.now, slice.index, slice.a, slice.b, slice.top, number];
        this.machine.onPwmTaken.push((slice) => {
            if (watched.has(slice.index) && !wraps) {
                this.record('pwm', entry(slice, numbers.get(slice.index) ?? 0));
            }
        });
        this.machine.onPwmWrap.push((slice) => {
            if (watched.has(slice.index)) {
                const number = (numbers.get(slice.index) ?? 0) + 1;
                numbers.set(slice.index, number);
                if (wraps) {
                    this.record('pwm', entry(slice, number));
                }
            }
        });
        return null;
    }

    pwm({ slice }) {
        const { a, b, top, divider, running, counter } = this.machine.pwm.slices[slice];
        return { a, b, top, divider: divider / 16, running, counter };
    }

    /** Records entries and exits of exceptions {numbers} (16 + interrupt): [cycle, core, number, entered]. */
    watch_exceptions({ numbers }) {
        const watched = new Set(numbers);
        this.machine.onException.push((core, number, entered) => {
            if (watched.has(number)) {
                this.record('exceptions', [core.time, core.number, number, entered]);
            }
        });
        return null;
    }

    // Spans of code ------------------------------------------------------------------------------------------------------

    /**
     * Watches the code of {core} from {from} up to {to} (symbols or addresses; `to: "return"` is the return of the
     * function `from`) under {name}.  Records the cycles and instructions of each passage, its accesses to flash, and
     * the number of different lines of the flash cache (8 bytes) that these accesses used.  With {register}, a passage
     * also has the value of this register at its begin, such as an argument of the function.
     */
    watch_span({ name, core, from, to, register }) {
        const { machine } = this;
        const span = { open: null, passages: [], flash: [], flashTotal: 0, lines: new Set() };
        this.spans.set(need(name, 'name'), span);
        const close = (at) => {
            if (span.open !== null) {
                const { cycle, instructions, values } = span.open;
                span.passages.push([cycle, at.time - cycle, at.instructions - instructions, ...values]);
                span.open = null;
                this.recordFlash(at);
            }
        };
        const open = (at) => {
            const values = register === undefined ? [] : [at.registers[register] >>> 0];
            span.open = { cycle: at.time, instructions: at.instructions, core: at, values };
            this.recordFlash(at);
            if (to === 'return') {
                this.closeAtReturn(at, close);
            }
        };
        machine.probe(core, machine.address(from), open);
        if (to !== 'return') {
            machine.probe(core, machine.address(to), close);
        }
        return null;
    }

    /** From now on, each access of {core} to flash is a fault; with {forbidden} false, no longer. */
    forbid_flash({ core, forbidden = true }) {
        this.machine.forbidFlash(need(core, 'core'), forbidden);
        return null;
    }

    /** Accesses to flash and hits of its cache, cycles of a transfer, and cycles that each core waited for the other. */
    memory() {
        const { flashCache, memoryBus } = this.machine;
        const { accesses, hits, transfer } = flashCache;
        return { accesses, hits, transfer, waits: memoryBus === null ? [0, 0] : memoryBus.waits };
    }

    /** An access of a core to flash counts in every span that is open on that core, also in nested ones. */
    recordFlash(core) {
        const spans = [...this.spans.values()].filter((span) => span.open?.core === core);
        this.machine.hookFlash(core, spans.length === 0 ? null : (user, address) => {
            for (const span of spans) {
                span.flashTotal++;
                span.lines.add(address >>> 3);
                if (span.flash.length < 1000) {
                    span.flash.push([user.time, user.opcodePC, address]);
                }
            }
        });
    }

    closeAtReturn(core, close) {
        const address = core.LR & ~1;
        const stack = core.SP;
        if (core.LR >>> 28 === 0xf) { // an interrupt's handler: it ends with the exception
            const number = core.IPSR;
            const listener = (at, left, entered) => {
                if (at === core && left === number && !entered) {
                    this.machine.onException.splice(this.machine.onException.indexOf(listener), 1);
                    close(at);
                }
            };
            this.machine.onException.push(listener);
            return;
        }
        const key = `${core.number}:${address}`;
        this.returns ??= new Map();
        const known = this.returns.get(key);
        if (known !== undefined) {
            known.stack = stack;
            known.close = close;
            return;
        }
        const entry = { stack, close };
        this.returns.set(key, entry);
        this.machine.probe(core.number, address, (at) => {
            if (entry.close !== null && at.SP === entry.stack) {
                entry.close(at);
                entry.close = null;
            }
        });
    }

    /** Takes {passages: [[cycle, cycles, instructions, register?]], flash: [[cycle, pc, address]], flash_total, flash_lines}. */
    span({ name }) {
        const span = this.spans.get(name);
        if (span === undefined) {
            throw new Error(`there is no span ${name}`);
        }
        const { passages, flash, flashTotal, lines } = span;
        span.passages = [];
        span.flash = [];
        span.flashTotal = 0;
        span.lines = new Set();
        return { passages, flash, flash_total: flashTotal, flash_lines: lines.size };
    }

    // USB ----------------------------------------------------------------------------------------------------------------

    /** Gives the host {text} or {hex} to send to serial port {port}: now, or at the cycle {at}. */
    usb_send({ text, hex, port = 0, at }) {
        const bytes = hex === undefined ? Buffer.from(need(text, 'text'), 'utf8') : Buffer.from(hex, 'hex');
        const { clock, usbHost } = this.machine;
        if (at === undefined) {
            usbHost.send(bytes, port);
        } else {
            clock.createAlarm(() => usbHost.send(bytes, port), true).at(at);
        }
        return null;
    }

    /** Takes the bytes that arrived over serial port {port}, as hex. */
    usb_receive({ port = 0 }) {
        const hex = Buffer.from(this.bytesOf(port)).toString('hex');
        this.received.set(port, []);
        return hex;
    }

    /** Floods serial port {port} with packets: {text} repeated, or characters by {seed}.  {on: false} stops it. */
    usb_flood({ on = true, text, seed = 1, port = 0 }) {
        const random = new Random(seed);
        let at = 0;
        const bytes = text === undefined ? null : Buffer.from(text, 'utf8');
        const make = (length) => Array.from({ length }, () =>
            bytes === null ? 32 + Math.floor(random.next() * 95) : bytes[at++ % bytes.length]);
        this.machine.usbHost.setFlood(on ? make : null, port);
        return null;
    }

    usb_open({ open = true, port = 0 }) {
        this.machine.usbHost.setLine(open, port);
        return null;
    }

    usb_attach() {
        this.machine.usbHost.attach();
        return null;
    }

    usb_detach() {
        this.machine.usbHost.detach();
        return null;
    }

    usb_bus_reset() {
        this.machine.usbHost.busReset();
        return null;
    }

    usb() {
        const { state, serial, ports, resetInterface, isOpen, device } = this.machine.usbHost;
        const id = device === null ? null : [device[8] | (device[9] << 8), device[10] | (device[11] << 8)];
        const described = ports.map(({ comm, in: input, out, dtr }) => ({ comm, in: input, out, dtr }));
        return { state, serial, ports: described, reset_interface: resetInterface, dtr: isOpen, id };
    }

    /**
     * Reads a descriptor with request {kind, number, index}: hex, or null if the device does not have it.  Takes time.
     */
    usb_descriptor({ kind, number = 0, index = 0, type = 0x80, request = 6 }) {
        const { machine } = this;
        const value = (need(kind, 'kind') << 8) | number;
        let answer;
        machine.usbHost.controlIn(type, request, value, index, 512, (data) => {
            answer = data;
        });
        for (let turn = 0; turn < 1000 && answer === undefined; turn++) {
            machine.run(machine.clock.now + 12_500);
        }
        machine.settle();
        if (answer === undefined) {
            throw new Error('the device does not answer');
        }
        return answer === null ? null : Buffer.from(answer).toString('hex');
    }

    /** A control transfer without data: {type, request, value, index}, as `picotool reboot -f` sends it. */
    usb_control({ type, request, value = 0, index = 0 }) {
        this.machine.usbHost.controlOut(type, request, value, index, null);
        return null;
    }

    // UARTs --------------------------------------------------------------------------------------------------------------

    /** The device on {uart} sends {hex} at its own {baud}, which it keeps.  {damaged: true}: with wrong stop bits. */
    uart_send({ uart, hex = '', baud, damaged = false }) {
        const device = this.theUart(uart);
        device.outside.baud = baud ?? device.outside.baud;
        for (const byte of Buffer.from(hex, 'hex')) {
            device.outside.queue.push(damaged ? byte | 256 : byte);
        }
        device.awaitNext();
        return { waiting: device.outside.queue.length };
    }

    /** Takes the bytes that {uart} has sent, as hex. */
    uart_receive({ uart }) {
        this.theUart(uart);
        return this.usb_receive({ port: `uart${uart}` });
    }

    uart({ uart }) {
        const { baudRate, enabled, rx, tx, outside } = this.theUart(uart);
        return { baud: baudRate, enabled, receiving: rx.length, sending: tx.length, waiting: outside.queue.length };
    }

    theUart(number) {
        const device = this.machine.uarts[need(number, 'uart')];
        if (device === undefined) {
            throw new Error(`there is no UART ${number}`);
        }
        return device;
    }

    // Encoders and motors --------------------------------------------------------------------------------------------------

    encoder({ name, a, b }) {
        this.encoders.set(need(name, 'name'), new Encoder(this.machine, need(a, 'a'), need(b, 'b')));
        return null;
    }

    theEncoder(name) {
        const encoder = this.encoders.get(name);
        if (encoder === undefined) {
            throw new Error(`there is no encoder ${name}`);
        }
        return encoder;
    }

    /** {name} -> number of edges up minus number of edges down since the start. */
    encoder_count({ name }) {
        return this.theEncoder(name).count;
    }

    /** {name, kind: random | constant | schedule, ...}: see encoder.mjs. */
    move({ name, kind, ...parameters }) {
        const encoder = this.theEncoder(name);
        this.motions.get(name)?.stop();
        const { machine } = this;
        const kinds = {
            random: () => new RandomWalk(machine, encoder, parameters),
            constant: () => new ConstantSpeed(machine, encoder, parameters),
            schedule: () => new ScheduledMotion(machine, encoder, parameters.edges),
            rest: () => ({ stop() {} }),
        };
        if (kinds[kind] === undefined) {
            throw new Error(`there is no motion ${kind}: ${Object.keys(kinds).join(', ')}`);
        }
        this.motions.set(name, kinds[kind]());
        return null;
    }

    /** Breaks or repairs an encoder.  While it is broken, its pins keep their levels. */
    encoder_dead({ name, dead = true }) {
        this.theEncoder(name).dead = dead;
        return null;
    }

    /** {name, encoder, bridge, axis: pan | tilt | parameters, stops, angle, coulomb}: see motor.mjs. */
    motor({ name, encoder, bridge, axis, ...others }) {
        const parameters = { ...(typeof axis === 'string' ? JIWY[axis] : axis), ...others };
        this.motors.set(need(name, 'name'), new Motor(this.machine, this.theEncoder(encoder), bridge, parameters));
        return null;
    }

    motor_state({ name }) {
        const motor = this.motors.get(name);
        if (motor === undefined) {
            throw new Error(`there is no motor ${name}`);
        }
        motor.advance();
        const { speed, angle, drive, encoder } = motor;
        motor.predict();
        return { speed, angle, duty: drive.duty, mode: drive.mode, count: encoder.count };
    }
}

function pad(bytes) {
    const rom = new Uint8Array(16 * 1024);
    rom.set(bytes.subarray(0, rom.length));
    return rom;
}

function romFromElf(path) {
    const { segments, symbols } = readElf(path);
    const rom = new Uint8Array(16 * 1024);
    segments.forEach(({ address, data }) => rom.set(data, address));
    return [rom, symbols];
}
