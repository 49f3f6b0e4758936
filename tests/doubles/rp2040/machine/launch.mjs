// SPDX-License-Identifier: Apache-2.0
// Core 1 in the boot ROM: wait_for_vector of that ROM (data sheet of the RP2040, 2.8.2) as a state machine.
//
// The ROM drains core 1's mailbox, sends a 0, and then echoes the sequence 0, 0, 1, vectors, stack, entry.
const EXPECTED = [0, 0, 1];
const CYCLES = 50; // from the last word to the first instruction

export class Launch {
    constructor(machine) {
        this.machine = machine;
        this.waiting = true;
        this.words = [];
    }

    /** The power-on state machine (PSM) has released core 1. */
    begin() {
        const { sio } = this.machine;
        this.waiting = true;
        this.words = [];
        sio.mailboxes[1].length = 0;
        this.answer(0);
    }

    /** The PSM holds core 1 in reset. */
    hold() {
        this.waiting = false;
        this.machine.cores[1].stop();
    }

    answer(word) {
        const { sio, cores } = this.machine;
        sio.mailboxes[0].push(word);
        sio.updateMailboxInterrupt(0);
        cores[0].signalEvent();
    }

    /** Takes a word for core 1; returns false if core 1's own program reads the words. */
    receive() {
        if (!this.waiting) {
            return false;
        }
        const { machine, words } = this;
        const word = machine.sio.mailboxes[1].shift();
        if (words.length < EXPECTED.length && word !== EXPECTED[words.length]) {
            words.length = word === 0 ? 1 : 0;
        } else {
            words.push(word);
        }
        this.answer(word);
        if (words.length === 6) {
            this.waiting = false;
            machine.cores[1].start(words[5], words[4], words[3]);
            machine.cores[1].time = machine.clock.now + CYCLES;
        }
        return true;
    }
}
