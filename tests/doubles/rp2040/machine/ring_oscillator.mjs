// SPDX-License-Identifier: Apache-2.0
// The ring oscillator: RP2040 data sheet, 2.17.  Its random bit is the same in each run, and goes on over resets.
import { Registers } from './resets.mjs';

const STATUS = 0x18;
const RUNNING = 0x80001000;
const RANDOM_BIT = 0x1c;

export class RingOscillator extends Registers {
    constructor(chip, noise) {
        super(chip, 'ROSC', { [STATUS]: RUNNING });
        this.noise = noise;
    }

    readUint32(offset) {
        if (offset !== RANDOM_BIT) {
            return super.readUint32(offset);
        }
        let state = this.noise.state; // xorshift
        state ^= state << 13;
        state ^= state >>> 17;
        state ^= state << 5;
        this.noise.state = state;
        return state & 1;
    }
}
