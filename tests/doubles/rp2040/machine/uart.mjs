// SPDX-License-Identifier: Apache-2.0
// A UART and the device connected to it (data sheet of the RP2040, 4.2: Arm's PL011), in whole characters.
//
// The levels of the pins are not simulated: a character is transferred if a pin of this UART has the UART's function.
// The other device sends and samples at its own baud rate.  If the rates differ by more than 4 %,
// characters are damaged.
import { BasePeripheral, IRQ } from './package.mjs';

const FIFO_SIZE = 32;
const FUNCTION_UART = 2;
const PINS = [
    { tx: [0, 12, 16, 28], rx: [1, 13, 17, 29] },
    { tx: [4, 8, 20, 24], rx: [5, 9, 21, 25] },
];
const TOLERANCE = 0.04; // half a bit in ten, minus the uncertainty of sampling

const DR = 0x00;
const FR = 0x18;
const IBRD = 0x24;
const FBRD = 0x28;
const LCR_H = 0x2c;
const CR = 0x30;
const IFLS = 0x34;
const IMSC = 0x38;
const RIS = 0x3c;
const MIS = 0x40;
const ICR = 0x44;
const DMACR = 0x48;

const RECEIVE_BY_DMA = 1; // bit of DMACR
const FRAMING_ERROR = 1 << 8; // bit of an entry of the FIFO
const OVERRUN = 1 << 11;
const RX = 1 << 4; // bit of the interrupt registers
const TX = 1 << 5;
const TIMEOUT = 1 << 6;
const OVERRUN_INTERRUPT = 1 << 10;
const LEVELS = [4, 8, 16, 24, 28]; // IFLS: 1/8, 1/4, 1/2, 3/4, 7/8

export class Uart extends BasePeripheral {
    constructor(machine, chip, number) {
        super(chip, `UART${number}`);
        this.machine = machine;
        this.chip = chip;
        this.number = number;
        this.clock = machine.clock;
        this.sending = this.clock.createAlarm(() => this.sent());
        this.arriving = this.clock.createAlarm(() => this.arrived());
        this.silence = this.clock.createAlarm(() => this.raise(TIMEOUT));
        this.request = [21, 23][number]; // to the DMA, for reception (data sheet, table 120)
        this.onData = () => {}; // (byte, number of the UART)
        this.outside = machine.uartOutside[number]; // {baud, queue}: the bytes that the other device sends
        this.reset();
    }

    reset() {
        this.registers = { [IBRD]: 0, [FBRD]: 0, [LCR_H]: 0, [CR]: 0x300, [IFLS]: 0x12, [IMSC]: 0, [DMACR]: 0 };
        this.divider = 0; // unit 1/64; takes effect at a write to LCR_H
        this.tx = [];
        this.rx = [];
        this.overrun = false;
        this.raw = 0;
        this.sending.cancel();
        this.arriving.cancel();
        this.silence.cancel();
        this.update();
    }

    get enabled() {
        return (this.registers[CR] & 1) !== 0;
    }

    /** The number of cycles in one bit, at the present frequency of clk_peri. */
    get bit() {
        return ((16 * this.divider) / 64) * (this.clock.frequency / this.chip.clkPeri);
    }

    /** The chip calls it when clk_peri has another frequency, which applies from the next character on. */
    clkPeriChanged() {}

    get baudRate() {
        return this.divider === 0 ? 0 : this.clock.frequency / this.bit;
    }

    level(shift) {
        return LEVELS[(this.registers[IFLS] >> shift) & 7] ?? 16;
    }

    connected(direction) {
        return PINS[this.number][direction].some((pin) => this.chip.gpio[pin].functionSelect === FUNCTION_UART);
    }

    readUint32(offset) {
        switch (offset) {
            case DR:
                return this.take();
            case FR:
                return (this.tx.length === 0 && !this.sending.scheduled ? 1 << 7 : 0) |
                    (this.rx.length === FIFO_SIZE ? 1 << 6 : 0) | (this.tx.length === FIFO_SIZE ? 1 << 5 : 0) |
                    (this.rx.length === 0 ? 1 << 4 : 0) | (this.sending.scheduled ? 1 << 3 : 0);
            case RIS:
                return this.raw;
            case MIS:
                return this.raw & this.registers[IMSC];
            default:
                return this.registers[offset] ?? 0;
        }
    }

    writeUint32(offset, value) {
        switch (offset) {
            case DR:
                this.put(value & 0xff);
                break;
            case ICR:
                this.raw &= ~this.rawWriteValue;
                this.update();
                break;
            default:
                if (offset in this.registers) {
                    this.registers[offset] = value;
                }
                if (offset === LCR_H) {
                    this.divider = 64 * this.registers[IBRD] + this.registers[FBRD];
                }
                this.update();
                this.awaitNext();
        }
    }

    raise(interrupts) {
        this.raw |= interrupts;
        this.update();
    }

    update() {
        const irq = this.number === 0 ? IRQ.UART0 : IRQ.UART1;
        this.machine.setInterrupt(irq, (this.raw & this.registers[IMSC]) !== 0);
        if (this.registers[DMACR] & RECEIVE_BY_DMA && this.rx.length > 0) {
            this.chip.dma.setDREQ(this.request);
        } else {
            this.chip.dma.clearDREQ(this.request);
        }
    }

    // To the other device -------------------------------------------------------------------------------------------

    put(byte) {
        if (this.tx.length === FIFO_SIZE) {
            return; // lost, as on the chip
        }
        this.tx.push(byte);
        if (this.tx.length > this.level(0)) {
            this.raw &= ~TX;
            this.update();
        }
        this.sendNext();
    }

    sendNext() {
        if (this.enabled && this.divider > 0 && this.tx.length > 0 && !this.sending.scheduled) {
            this.shifting = this.tx.shift();
            this.sending.at(this.clock.now + Math.round(10 * this.bit));
            if (this.tx.length === this.level(0)) {
                this.raise(TX); // only when the level falls
            }
        }
    }

    sent() {
        if (this.connected('tx')) {
            this.onData(this.matches ? this.shifting : this.shifting ^ 0xa5, this.number);
        }
        this.sendNext();
    }

    get matches() {
        return Math.abs(this.outside.baud / this.baudRate - 1) <= TOLERANCE;
    }

    // From the other end -----------------------------------------------------------------------------------------------

    /** The other device has a character to send. */
    awaitNext() {
        if (this.outside.queue.length > 0 && !this.arriving.scheduled) {
            this.arriving.at(this.clock.now + Math.round((10 * this.clock.frequency) / this.outside.baud));
        }
    }

    arrived() {
        const byte = this.outside.queue.shift();
        if (this.enabled && this.connected('rx')) {
            this.receive(this.matches && byte < 256 ? byte : (byte & 0xff) | FRAMING_ERROR);
        }
        this.awaitNext();
    }

    receive(entry) {
        if (this.rx.length === FIFO_SIZE) {
            this.overrun = true;
            this.raise(OVERRUN_INTERRUPT);
        } else {
            this.rx.push(entry);
            this.overrun = false;
            if (this.rx.length === this.level(3)) {
                this.raise(RX);
            }
            this.update(); // the DMA may take the byte at once
        }
        this.silence.at(this.clock.now + Math.round(32 * this.bit));
    }

    take() {
        const entry = (this.rx.shift() ?? 0) | (this.overrun ? OVERRUN : 0); // a flag of the UART, not of this entry
        if (this.rx.length < this.level(3)) {
            this.raw &= ~RX;
        }
        if (this.rx.length === 0) {
            this.raw &= ~TIMEOUT;
            this.silence.cancel();
        }
        this.update();
        return entry;
    }
}
