/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The tick: the wrap of a PWM slice, which repeats by itself.
 */
#ifndef WRAP_H
#define WRAP_H

/** Starts control on this core: encoders, PWM, and a cycle in each interrupt of the tick's slice. */
void wrap_start(void);

#endif
