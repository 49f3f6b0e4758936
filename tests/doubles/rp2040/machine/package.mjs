// SPDX-License-Identifier: Apache-2.0
// The npm package rp2040js, from the folder that EPG_RP2040JS names (emulator.py installs it into EPG's cache).
//
// The emulator uses its processor core and those peripherals that it does not replace (clocks, PLLs, pads, IO bank,
// ADC, I2C, SPI, RTC, DMA).  Files are imported one by one because the package exports only its index.
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const folder = process.env.EPG_RP2040JS;
if (!folder) {
    throw new Error('EPG_RP2040JS does not name the folder of the package rp2040js');
}

const load = (file) => import(pathToFileURL(join(folder, 'dist', 'esm', file)).href);

export const { RP2040 } = await load('rp2040.js');
export const { CortexM0Core } = await load('cortex-m0-core.js');
export const { BasePeripheral } = await load('peripherals/peripheral.js');
export const { RPSIO } = await load('sio.js');
export const { IRQ } = await load('irq.js');
