/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SMALL_H
#define SMALL_H
#pragma GCC system_header
#include "stm32h7xx.h"

int main(void);

/** Sets the handler of an interrupt; system exceptions have negative numbers. */
void set_handler(int interrupt, void (*handler)(void));

extern volatile uint32_t unexpected_exception;
#endif
