// SPDX-License-Identifier: Apache-2.0
// A USB host.  It attaches, enumerates, and moves the packets of CDC serial ports with the times of a real bus.
//
// States of the bus: detached -> waiting for the pull-up -> bus reset -> enumeration -> configured.  A frame starts
// every millisecond of the host's own clock.  Each packet takes a random time from `packetDelay`.

const RESET_TIME = 10_000; // microseconds of bus reset, and of the pause after it
const DEBOUNCE = 2_000;
const SUSPEND_TIME = 3_000; // microseconds without frames until a device detects suspend
const CONTROL_DELAY = 10;
const DESCRIPTOR_DEVICE = 1;
const DESCRIPTOR_CONFIGURATION = 2;
const DESCRIPTOR_STRING = 3;
const CLASS_CDC = 2;
const CLASS_CDC_DATA = 10;
const CLASS_VENDOR = 0xff;

/**
 * A small random generator with a seed, so that runs are repeatable (xorshift32; G. Marsaglia, "Xorshift RNGs", 2003).
 */
export class Random {
    constructor(seed) {
        this.state = (Math.imul(seed, 0x9e3779b1) ^ 0x6a09e667) >>> 0 || 1;
    }

    next() {
        let s = this.state;
        s ^= s << 13;
        s ^= s >>> 17;
        s ^= s << 5;
        this.state = s >>> 0;
        return this.state / 2 ** 32;
    }
}

/**
 * Times as on a desktop computer with low load: 45 to 105 us per packet; one packet in ten waits up to a frame more.
 */
export function desktopDelay(random) {
    return 45 + random.next() * (random.next() < 0.1 ? 1000 : 60);
}

/** A serial port of the device: interface, endpoints, bytes that wait to be sent. */
class Port {
    constructor(number, comm) {
        this.number = number;
        this.comm = comm; // number of its first interface
        this.in = -1;
        this.out = -1;
        this.dtr = false;
        this.outgoing = [];
        this.flood = null;
    }
}

export class UsbHost {
    constructor(machine, options = {}) {
        this.machine = machine;
        this.clock = machine.clock;
        this.perMicrosecond = machine.clock.frequency / 1e6;
        this.random = new Random(options.seed ?? 1);
        this.rate = 1 + (options.clockError ?? 0) * 1e-6; // ppm
        this.phase = options.phase ?? 0; // microseconds
        this.packetDelay = options.packetDelay ?? desktopDelay;
        this.attached = options.attached ?? true;
        this.openAtStart = options.open ?? true;
        this.onData = () => {}; // (bytes, number of the port)
        this.frame = 0;
        this.stateAlarm = this.clock.createAlarm(() => this.stateStep(), true);
        this.frameAlarm = this.clock.createAlarm(() => this.frameStarts(), true);
        this.endpointAlarms = new Map();
        this.floods = new Map(); // number of a port -> source of its flood, until the test stops it
        this.clear();
    }

    /** The first port, the one that most tests use. */
    get port() {
        return this.ports[0] ?? null;
    }

    /** True if the device is configured and a terminal has opened the first port. */
    get isOpen() {
        return this.state === 'configured' && this.port !== null && this.port.dtr;
    }

    clear() {
        this.state = 'detached';
        this.requests = [];
        this.current = null;
        this.descriptor = null;
        this.device = null;
        this.serial = '';
        this.ports = []; // in the order of their interfaces
        this.early = new Map(); // number of a port -> bytes to send, stored until the port is enumerated
        this.resetInterface = -1;
        for (const alarm of this.endpointAlarms.values()) {
            alarm.cancel();
        }
    }

    after(alarm, microseconds) {
        alarm.at(this.clock.now + Math.round((microseconds / this.rate) * this.perMicrosecond));
    }

    get usb() {
        return this.machine.usb;
    }

    // Attachment -------------------------------------------------------------------------------------------------------

    /** The chip was reset: the host sees a new device on the same cable. */
    deviceReplaced() {
        this.clear();
        this.stateAlarm.cancel();
        this.frameAlarm.cancel();
        this.deviceChanged();
    }

    deviceChanged() {
        const present = this.attached && this.usb.present;
        if (present && this.state === 'detached') {
            this.state = 'connecting';
            this.after(this.stateAlarm, DEBOUNCE + this.phase);
        } else if (!present && this.state !== 'detached') {
            this.clear();
            this.stateAlarm.cancel();
            this.frameAlarm.cancel();
        }
    }

    attach() {
        this.attached = true;
        this.deviceChanged();
    }

    /** Pulls the cable.  A board with its own supply then receives no frames and detects suspend. */
    detach() {
        this.attached = false;
        this.clear();
        this.frameAlarm.cancel();
        this.state = 'suspending';
        this.after(this.stateAlarm, SUSPEND_TIME);
    }

    busReset() {
        this.clear();
        this.state = 'connecting';
        this.stateStep();
    }

    stateStep() {
        switch (this.state) {
            case 'connecting':
                this.state = 'resetting';
                this.usb.busReset();
                this.after(this.stateAlarm, RESET_TIME);
                break;
            case 'resetting':
                this.state = 'enumerating';
                this.frameStarts();
                this.enumerate();
                break;
            case 'suspending':
                this.state = 'detached';
                this.usb.suspend();
                break;
            default:
        }
    }

    frameStarts() {
        this.frame++;
        this.usb.frameStarts(this.frame);
        this.after(this.frameAlarm, 1000);
    }

    // Enumeration ------------------------------------------------------------------------------------------------------

    enumerate() {
        this.controlIn(0x80, 6, DESCRIPTOR_DEVICE << 8, 0, 18, (device) => {
            this.device = device;
            this.controlOut(0x00, 5, 1, 0, null, () => {
                this.controlIn(0x80, 6, DESCRIPTOR_CONFIGURATION << 8, 0, 9, (head) => {
                    const length = head[2] | (head[3] << 8);
                    this.controlIn(0x80, 6, DESCRIPTOR_CONFIGURATION << 8, 0, length, (all) => this.configure(all));
                });
            });
        });
    }

    configure(descriptor) {
        this.descriptor = descriptor;
        this.parse(descriptor);
        const finish = () => this.controlOut(0x00, 9, 1, 0, null, () => {
            this.state = 'configured';
            for (const port of this.openAtStart ? this.ports : []) {
                this.setLine(true, port.number);
            }
        });
        const serialIndex = this.device[16];
        if (serialIndex === 0) {
            finish();
            return;
        }
        this.controlIn(0x80, 6, (DESCRIPTOR_STRING << 8) | serialIndex, 0x409, 255, (text) => {
            this.serial = text === null ? '' : String.fromCharCode(...wide(text.subarray(2)));
            finish();
        });
    }

    parse(descriptor) {
        let number = -1;
        let kind = -1;
        const ports = [];
        for (let at = 0; at + 1 < descriptor.length && descriptor[at] > 1; at += descriptor[at]) {
            const type = descriptor[at + 1];
            if (type === 4) {
                number = descriptor[at + 2];
                kind = descriptor[at + 5];
                if (kind === CLASS_CDC) {
                    ports.push(new Port(ports.length, number));
                }
                if (kind === CLASS_VENDOR && descriptor[at + 6] === 0 && descriptor[at + 7] === 1) {
                    this.resetInterface = number; // pico/usb_reset_interface.h
                }
            } else if (type === 5 && kind === CLASS_CDC_DATA && ports.length > 0) {
                const address = descriptor[at + 2];
                ports[ports.length - 1][address & 0x80 ? 'in' : 'out'] = address & 0xf;
            }
        }
        this.ports = ports.filter((port) => port.in >= 0 && port.out >= 0);
        for (const port of this.ports) {
            port.flood = this.floods.get(port.number) ?? null;
            port.outgoing = this.early.get(port.number) ?? [];
        }
    }

    // Control transfers ------------------------------------------------------------------------------------------------

    controlIn(type, request, value, index, length, done) {
        this.control({ type, request, value, index, length, data: [], out: false, done });
    }

    controlOut(type, request, value, index, data, done) {
        this.control({ type, request, value, index, length: data?.length ?? 0, data: [...(data ?? [])], out: true, done });
    }

    control(transfer) {
        this.requests.push(transfer);
        this.nextControl();
    }

    nextControl() {
        if (this.current !== null || this.requests.length === 0) {
            return;
        }
        const transfer = this.requests.shift();
        this.current = transfer;
        transfer.sent = 0;
        transfer.stage = transfer.length === 0 ? 'status' : 'data';
        const { type, request, value, index, length } = transfer;
        this.usb.setup([type, request, value & 255, value >> 8, index & 255, index >> 8, length & 255, length >> 8]);
    }

    /** Serves endpoint 0 for the present transfer. */
    serveControl(out) {
        const transfer = this.current;
        if (transfer === null) {
            return;
        }
        const wanted = (transfer.stage === 'data') === transfer.out;
        if (out !== wanted) {
            return;
        }
        const buffer = this.usb.buffer(0, out);
        if (buffer === null) {
            return;
        }
        if (buffer.stalled) {
            this.finishControl(null);
            return;
        }
        if (transfer.stage === 'status') {
            if (out) {
                this.usb.giveOut(buffer, new Uint8Array(0));
            } else {
                this.usb.takeIn(buffer);
            }
            this.finishControl(Uint8Array.from(transfer.data));
        } else if (out) {
            const part = transfer.data.slice(transfer.sent, transfer.sent + 64);
            transfer.sent += part.length;
            if (transfer.sent === transfer.data.length) {
                transfer.stage = 'status';
            }
            this.usb.giveOut(buffer, Uint8Array.from(part));
        } else {
            const part = this.usb.takeIn(buffer);
            transfer.data.push(...part);
            if (part.length < 64 || transfer.data.length >= transfer.length) {
                transfer.stage = 'status';
            }
        }
        this.bufferChanged(0, false);
        this.bufferChanged(0, true);
    }

    finishControl(result) {
        const { done } = this.current;
        this.current = null;
        done?.(result);
        this.nextControl();
    }

    // Serial ports -----------------------------------------------------------------------------------------------------

    /** Opens the terminal (line coding 115200 8N1, then DTR) or closes it (DTR off). */
    setLine(open, number = 0, done = null) {
        const port = this.ports[number];
        if (port === undefined) {
            done?.(null);
            return;
        }
        if (open) {
            this.controlOut(0x21, 0x20, 0, port.comm, [0x00, 0xc2, 0x01, 0x00, 0, 0, 8]);
        }
        this.controlOut(0x21, 0x22, open ? 3 : 0, port.comm, null, (result) => {
            port.dtr = open;
            if (open) {
                this.bufferChanged(port.in, false);
            }
            done?.(result);
        });
    }

    send(bytes, number = 0) {
        const port = this.ports[number];
        if (port === undefined) {
            this.early.set(number, [...(this.early.get(number) ?? []), ...bytes]);
            return;
        }
        for (const byte of bytes) {
            port.outgoing.push(byte);
        }
        this.bufferChanged(port.out, true);
    }

    /** Sends without end: `make(length)` returns the bytes of each packet.  Null stops it. */
    setFlood(make, number = 0) {
        this.floods.set(number, make);
        const port = this.ports[number];
        if (port !== undefined) {
            port.flood = make;
            this.bufferChanged(port.out, true);
        }
    }

    /** The firmware has changed a buffer, or the host has data to send: after its delay, a packet can move. */
    bufferChanged(endpoint, out) {
        const key = 2 * endpoint + (out ? 1 : 0);
        let alarm = this.endpointAlarms.get(key);
        if (alarm === undefined) {
            alarm = this.clock.createAlarm(() => this.serve(endpoint, out), true);
            this.endpointAlarms.set(key, alarm);
        }
        if (!alarm.scheduled && this.wants(endpoint, out) && this.usb.buffer(endpoint, out) !== null) {
            this.after(alarm, endpoint === 0 ? CONTROL_DELAY : this.packetDelay(this.random));
        }
    }

    wants(endpoint, out) {
        if (this.state !== 'enumerating' && this.state !== 'configured') {
            return false;
        }
        if (endpoint === 0) {
            return this.current !== null;
        }
        const port = this.portOf(endpoint, out);
        if (port === null) {
            return false;
        }
        return out ? port.outgoing.length > 0 || port.flood !== null : port.dtr;
    }

    portOf(endpoint, out) {
        return this.ports.find((port) => (out ? port.out : port.in) === endpoint) ?? null;
    }

    serve(endpoint, out) {
        if (!this.wants(endpoint, out)) {
            return;
        }
        if (endpoint === 0) {
            this.serveControl(out);
            return;
        }
        const buffer = this.usb.buffer(endpoint, out);
        if (buffer === null || buffer.stalled) {
            return;
        }
        const port = this.portOf(endpoint, out);
        if (out) {
            const data = port.outgoing.length > 0 ? port.outgoing.splice(0, buffer.length) : port.flood(buffer.length);
            this.usb.giveOut(buffer, Uint8Array.from(data));
        } else {
            this.onData(this.usb.takeIn(buffer), port.number);
        }
        this.bufferChanged(endpoint, out);
    }
}

function wide(bytes) {
    const units = [];
    for (let at = 0; at + 1 < bytes.length; at += 2) {
        units.push(bytes[at] | (bytes[at + 1] << 8));
    }
    return units;
}
