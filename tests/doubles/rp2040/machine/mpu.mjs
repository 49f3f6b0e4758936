// SPDX-License-Identifier: Apache-2.0
// The memory protection unit, limited to the protection against writes (Armv6-M Architecture Reference Manual, B3.5),
// which is enough for a stack guard.  Reads and execution are not checked.

const REGIONS = 8;
const CTRL_ENABLE = 1;
const RBAR_VALID = 1 << 4;
const RASR_ENABLE = 1;
// indexed by the AP field, for privileged code
const FORBIDS_WRITES = [true, false, false, false, false, true, true, true];

export class Mpu {
    /** `changed(ranges)` is called with the ranges [low, high) in which writes are forbidden. */
    constructor(changed) {
        this.changed = changed;
        this.reset();
    }

    reset() {
        this.control = 0;
        this.number = 0;
        this.bases = new Uint32Array(REGIONS);
        this.attributes = new Uint32Array(REGIONS);
        this.changed([]);
    }

    /** HFNMIENA: the MPU is also active in the HardFault handler. */
    get protectsHardFault() {
        return (this.control & 2) !== 0;
    }

    read(offset) {
        switch (offset) {
            case 0xd90:
                return REGIONS << 8;
            case 0xd94:
                return this.control;
            case 0xd98:
                return this.number;
            case 0xd9c:
                return (this.bases[this.number] | this.number) >>> 0;
            default:
                return this.attributes[this.number];
        }
    }

    write(offset, value) {
        switch (offset) {
            case 0xd94:
                this.control = value & 7;
                break;
            case 0xd98:
                this.number = value & (REGIONS - 1);
                break;
            case 0xd9c:
                if (value & RBAR_VALID) {
                    this.number = value & (REGIONS - 1);
                }
                this.bases[this.number] = value & ~0xff;
                break;
            case 0xda0:
                this.attributes[this.number] = value;
                break;
            default:
        }
        this.changed(this.ranges());
    }

    /**
     * Eighths of each region, except disabled subregions.  The priority of a region with a higher number is ignored.
     */
    ranges() {
        const ranges = [];
        if (!(this.control & CTRL_ENABLE)) {
            return ranges;
        }
        this.attributes.forEach((attributes, number) => {
            if (!(attributes & RASR_ENABLE) || !FORBIDS_WRITES[(attributes >>> 24) & 7]) {
                return;
            }
            const part = 2 ** (((attributes >>> 1) & 31) + 1 - 3);
            for (let n = 0; n < 8; n++) {
                if (!(attributes & (1 << (8 + n)))) {
                    ranges.push([this.bases[number] + n * part, this.bases[number] + (n + 1) * part]);
                }
            }
        });
        return ranges;
    }
}
