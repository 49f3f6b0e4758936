// SPDX-License-Identifier: Apache-2.0
// The USB device controller's registers and buffers (data sheet of the RP2040, 4.1).
//
// A buffer that the firmware has made available stays available until the host (usb_host.mjs) has moved its packet.  As
// on a real bus, the device answers NAK while the host has nothing to send or does not read.
import { BasePeripheral, IRQ } from './package.mjs';

const SIE_BUS_RESET = 1 << 19;
const SIE_SETUP = 1 << 17;
const SIE_CONNECTED = 1 << 16;
const SIE_RESUME = 1 << 11;
const SIE_SUSPENDED = 1 << 4;
const SIE_VBUS = 1;
const SIE_WRITE_CLEAR = 0xff0f0810;

// The source of each interrupt (4.1.3, INTR and SIE_STATUS).
const SIE_INTERRUPTS = [
    [SIE_SETUP, 1 << 16],
    [SIE_RESUME, 1 << 15],
    [SIE_SUSPENDED, 1 << 14],
    [SIE_BUS_RESET, 1 << 12],
];
const INTERRUPT_SOF = 1 << 17;
const INTERRUPT_BUFFER = 1 << 4;

const BUFFER_FULL = 1 << 15;
const BUFFER_STALL = 1 << 11;
const BUFFER_AVAILABLE = 1 << 10;
const BUFFER_LENGTH = 0x3ff;

const CONTROL_DOUBLE = 1 << 30;
const CONTROL_PER_PAIR = 1 << 28;
const LINE_STATE_J = 1 << 2;

export class UsbDevice extends BasePeripheral {
    constructor(machine, chip) {
        super(chip, 'USB');
        this.machine = machine;
        this.ram = chip.usbDPRAM;
        this.view = chip.usbDPRAMView;
        this.host = null;
        this.reset();
    }

    reset() {
        this.address = 0;
        this.mainControl = 0;
        this.sieControl = 0;
        this.sieStatus = 0;
        this.frame = 0;
        this.startOfFrame = false;
        this.buffers = 0; // BUFF_STATUS
        this.abort = 0;
        this.stallArm = 0;
        this.power = 0;
        this.muxing = 0;
        this.enabled = this.forced = 0;
        this.half = new Uint8Array(32); // which buffer of a pair the host serves next, by endpoint and direction
        this.update();
        this.host?.deviceChanged();
    }

    /** The pull-up on D+, by which the host detects a device. */
    get present() {
        return (this.mainControl & 1) !== 0 && (this.sieControl & (1 << 16)) !== 0;
    }

    readUint32(offset) {
        switch (offset) {
            case 0x00:
                return this.address;
            case 0x40:
                return this.mainControl;
            case 0x48:
                this.startOfFrame = false;
                this.update();
                return this.frame;
            case 0x4c:
                return this.sieControl;
            case 0x50:
                return this.sieStatus | (this.host?.attached ? LINE_STATE_J | SIE_CONNECTED : 0) |
                    (this.power & 0xc || this.host?.attached ? SIE_VBUS : 0);
            case 0x58:
                return this.buffers;
            case 0x60:
                return this.abort;
            case 0x64:
                return this.abort; // the abort is complete at once
            case 0x68:
                return this.stallArm;
            case 0x74:
                return this.muxing;
            case 0x78:
                return this.power;
            case 0x8c:
                return this.raw;
            case 0x90:
                return this.enabled;
            case 0x94:
                return this.forced;
            case 0x98:
                return (this.raw & this.enabled) | this.forced;
            default:
                return 0;
        }
    }

    writeUint32(offset, value) {
        switch (offset) {
            case 0x00:
                this.address = value & 0x7f;
                return;
            case 0x40:
                this.mainControl = value;
                this.host?.deviceChanged();
                return;
            case 0x4c:
                this.sieControl = value;
                this.host?.deviceChanged();
                return;
            case 0x50:
                this.sieStatus &= ~(this.rawWriteValue & SIE_WRITE_CLEAR);
                break;
            case 0x58:
                this.buffers &= ~this.rawWriteValue;
                break;
            case 0x60:
                this.abort = value;
                return;
            case 0x68:
                this.stallArm = value;
                return;
            case 0x74:
                this.muxing = value;
                return;
            case 0x78:
                this.power = value;
                return;
            case 0x90:
                this.enabled = value & 0xfffff;
                break;
            case 0x94:
                this.forced = value & 0xfffff;
                break;
            default:
                return;
        }
        this.update();
    }

    get raw() {
        let bits = (this.buffers !== 0 ? INTERRUPT_BUFFER : 0) | (this.startOfFrame ? INTERRUPT_SOF : 0);
        for (const [status, interrupt] of SIE_INTERRUPTS) {
            bits |= this.sieStatus & status ? interrupt : 0;
        }
        return bits;
    }

    update() {
        this.machine.setInterrupt(IRQ.USBCTRL, ((this.raw & this.enabled) | this.forced) !== 0);
    }

    /** A word of the buffer memory was written.  The package defines the name. */
    DPRAMUpdated(offset) {
        if (offset >= 0x80 && offset < 0x100) {
            const endpoint = (offset - 0x80) >> 3;
            this.host?.bufferChanged(endpoint, (offset & 4) !== 0);
        }
    }

    // Actions of the host ---------------------------------------------------------------------------------------------

    raise(sieBit) {
        this.sieStatus |= sieBit;
        this.update();
    }

    busReset() {
        this.address = 0;
        this.half.fill(0);
        this.raise(SIE_BUS_RESET);
    }

    suspend() {
        this.raise(SIE_SUSPENDED);
    }

    frameStarts(frame) {
        this.frame = frame & 0x7ff;
        if (this.enabled & INTERRUPT_SOF) {
            this.startOfFrame = true;
            this.update();
        }
    }

    setup(packet) {
        this.ram.set(packet, 0);
        this.half[0] = this.half[1] = 0;
        this.raise(SIE_SETUP);
    }

    /** The buffer with which the device would answer the host now, or null for NAK. */
    buffer(endpoint, out) {
        const register = 0x80 + 8 * endpoint + (out ? 4 : 0);
        const index = 2 * endpoint + (out ? 1 : 0);
        const control = endpoint === 0 ? 0 : this.view.getUint32(8 * endpoint + (out ? 4 : 0), true);
        const double = (control & CONTROL_DOUBLE) !== 0;
        const half = double ? this.half[index] : 0;
        const bits = this.view.getUint32(register, true) >>> (16 * half);
        const stalled = (bits & BUFFER_STALL) !== 0;
        if (!stalled && !(bits & BUFFER_AVAILABLE)) {
            return null;
        }
        const address = endpoint === 0 ? 0x100 : (control & 0xffc0) + 64 * half;
        return { register, index, half, double, perPair: (control & CONTROL_PER_PAIR) !== 0, address, stalled,
            length: bits & BUFFER_LENGTH };
    }

    /** The host takes a packet from the device. */
    takeIn(buffer) {
        const data = this.ram.slice(buffer.address, buffer.address + buffer.length);
        this.finish(buffer, BUFFER_AVAILABLE | BUFFER_FULL, 0);
        return data;
    }

    /** The host sends the device a packet of at most `buffer.length` bytes. */
    giveOut(buffer, data) {
        this.ram.set(data, buffer.address);
        this.finish(buffer, BUFFER_AVAILABLE | BUFFER_LENGTH, BUFFER_FULL | data.length);
    }

    finish(buffer, clear, set) {
        const shift = 16 * buffer.half;
        const word = this.view.getUint32(buffer.register, true);
        this.view.setUint32(buffer.register, (word & ~(clear << shift)) | (set << shift), true);
        if (buffer.double) {
            this.half[buffer.index] ^= 1;
        }
        if (!buffer.double || !buffer.perPair || buffer.half === 1) {
            this.buffers |= 1 << buffer.index;
            this.update();
        }
    }
}
