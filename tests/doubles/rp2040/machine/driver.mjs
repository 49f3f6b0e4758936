// SPDX-License-Identifier: Apache-2.0
// Command line of the emulator: JSON lines in, JSON lines out.
//
//   {"id": 1, "call": "run", "with": {"cycles": 125000}}   ->   {"id": 1, "result": {...}}  or  {"id": 1, "error": "..."}
import { createInterface } from 'node:readline';
import { Commands } from './commands.mjs';

const COMMANDS = new Set(Object.getOwnPropertyNames(Commands.prototype).filter((name) => /^[a-z_]+$/.test(name)));
const INTERNAL = new Set(['constructor', 'receive', 'record']);

const commands = new Commands();
const lines = createInterface({ input: process.stdin, terminal: false });

for await (const line of lines) {
    const { id, call, with: parameters = {} } = JSON.parse(line);
    const answer = { id };
    try {
        if (!COMMANDS.has(call) || INTERNAL.has(call)) {
            throw new Error(`there is no command ${call}`);
        }
        if (commands.machine === null && call !== 'load') {
            throw new Error('no image is loaded');
        }
        answer.result = commands[call](parameters) ?? null;
    } catch (error) {
        answer.error = error instanceof Error ? error.message : String(error.cause ?? error);
        answer.trace = error.stack;
    }
    process.stdout.write(`${JSON.stringify(answer)}\n`);
}
