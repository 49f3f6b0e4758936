/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Variables that keep their values over a reset.
 */
#ifndef MPS2_PARTS_H
#define MPS2_PARTS_H

#define NOT_CLEARED __attribute__((section(".noinit")))

#endif
