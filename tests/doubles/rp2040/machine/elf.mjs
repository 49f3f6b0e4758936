// SPDX-License-Identifier: Apache-2.0
// Images: 32-bit little-endian ELF (segments by their load address, symbols) and UF2.
import { readFileSync } from 'node:fs';

const LOADED = 1;
const SYMBOL_TABLE = 2;

export function readElf(path) {
    const file = readFileSync(path);
    if (file.length < 52 || file.readUInt32BE(0) !== 0x7f454c46 || file[4] !== 1 || file[5] !== 1) {
        throw new Error(`${path} is no 32-bit little-endian ELF file`);
    }
    const segments = [];
    const programs = file.readUInt32LE(28);
    for (let n = 0; n < file.readUInt16LE(44); n++) {
        const at = programs + n * file.readUInt16LE(42);
        const size = file.readUInt32LE(at + 16);
        if (file.readUInt32LE(at) === LOADED && size > 0) {
            const offset = file.readUInt32LE(at + 4);
            segments.push({ address: file.readUInt32LE(at + 12), data: file.subarray(offset, offset + size) });
        }
    }
    return { entry: file.readUInt32LE(24) & ~1, segments, symbols: readSymbols(file) };
}

function readSymbols(file) {
    const symbols = new Map();
    const sections = file.readUInt32LE(32);
    const size = file.readUInt16LE(46);
    for (let n = 0; n < file.readUInt16LE(48); n++) {
        const at = sections + n * size;
        if (file.readUInt32LE(at + 4) !== SYMBOL_TABLE) {
            continue;
        }
        const first = file.readUInt32LE(at + 16);
        const end = first + file.readUInt32LE(at + 20);
        const names = file.readUInt32LE(sections + file.readUInt32LE(at + 24) * size + 16);
        for (let entry = first; entry < end; entry += 16) {
            const type = file[entry + 12] & 15;
            const name = text(file, names + file.readUInt32LE(entry));
            if (name && type <= 2 && file.readUInt16LE(entry + 14) !== 0 && !name.startsWith('$')) {
                const value = file.readUInt32LE(entry + 4);
                const known = symbols.get(name);
                // a global symbol hides local symbols of the same name
                if (known === undefined || file[entry + 12] >> 4 !== 0) {
                    symbols.set(name, {
                        address: type === 2 ? value & ~1 : value, size: file.readUInt32LE(entry + 8), code: type === 2,
                    });
                }
            }
        }
    }
    return symbols;
}

function text(file, at) {
    return file.toString('latin1', at, file.indexOf(0, at));
}

export function readUf2(path) {
    const file = readFileSync(path);
    const segments = [];
    for (let at = 0; at + 512 <= file.length; at += 512) {
        if (file.readUInt32LE(at) !== 0x0a324655) {
            throw new Error(`${path} is no UF2 file`);
        }
        const size = file.readUInt32LE(at + 16);
        segments.push({ address: file.readUInt32LE(at + 12), data: file.subarray(at + 32, at + 32 + size) });
    }
    return { entry: 0x10000000, segments, symbols: new Map() };
}
