// SPDX-License-Identifier: Apache-2.0
// The 30 GPIO pads: their drivers, the level that the chip reads, and a log of their edges.
//
// A pad has the level of the chip's output if that is enabled, else the level that the test drives from outside, else
// that of the pull resistor.  A floating pad reads low.

const PIN_COUNT = 30;
const PAD_AFTER_RESET = 0x56; // data sheet of the RP2040, 2.19.6.3: input enabled, pull-down, 4 mA, Schmitt trigger
const NO_FUNCTION = 0x1f;

export class Pads {
    constructor(machine, chip) {
        this.machine = machine;
        this.chip = chip;
        this.inputs = 0; // outputs of the chip's input buffers, one bit per pin
        this.levels = 0; // levels of the pads
        this.enables = 0; // outputs that are enabled
        this.external = machine.external; // per pin: -1 not driven, else the level
        chip.gpio.forEach((pin, index) => {
            pin.checkForUpdates = () => this.refresh(index);
            pin.refreshInput = () => this.refresh(index);
        });
    }

    reset(ios, pads) {
        for (const pin of this.chip.gpio) {
            if (ios) {
                pin.ctrl = NO_FUNCTION;
                pin.irqEnableMask = pin.irqForceMask = pin.irqStatus = 0;
            }
            if (pads) {
                pin.padValue = PAD_AFTER_RESET;
            }
        }
        this.refreshMask(0x3fffffff);
    }

    drive(pin, level) {
        if (!(pin >= 0 && pin < PIN_COUNT)) {
            throw new Error(`there is no GPIO ${pin}`);
        }
        this.external[pin] = level;
        this.refresh(pin);
    }

    refreshMask(mask) {
        while (mask !== 0) {
            const bit = mask & -mask;
            mask &= ~bit;
            this.refresh(31 - Math.clz32(bit));
        }
    }

    refresh(index) {
        const pin = this.chip.gpio[index];
        if (pin === undefined) {
            return;
        }
        const bit = 1 << index;
        const enabled = pin.outputEnable && !pin.outputDisable;
        const driven = this.external[index];
        const high = enabled ? pin.outputValue : driven >= 0 ? driven === 1 : pin.pullupEnabled;
        const before = this.levels & bit;
        const enabledBefore = this.enables & bit;
        this.levels = high ? this.levels | bit : this.levels & ~bit;
        this.enables = enabled ? this.enables | bit : this.enables & ~bit;
        const input = high && pin.inputEnable;
        const seen = pin.inputOverride === 0 ? input : pin.inputOverride === 1 ? !input : pin.inputOverride === 3;
        if (seen !== ((this.inputs & bit) !== 0)) {
            this.inputs ^= bit;
            for (const block of this.machine.pio) {
                block.inputsChanged();
            }
            pin.setInputValue(high); // the package's flags for GPIO interrupts
        }
        if (before !== (this.levels & bit) || enabledBefore !== (this.enables & bit)) {
            this.machine.pinChanged(index, high ? 1 : 0, enabled);
        }
    }

    state(index) {
        const pin = this.chip.gpio[index];
        return {
            level: (this.levels >>> index) & 1,
            output: ((this.enables >>> index) & 1) === 1,
            function: pin.functionSelect,
            pullUp: pin.pullupEnabled,
            pullDown: pin.pulldownEnabled,
        };
    }
}
