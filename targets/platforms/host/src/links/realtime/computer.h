/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What distinguishes this computer and this program from others.
 */
#ifndef EPG_HOST_COMPUTER_H
#define EPG_HOST_COMPUTER_H

#include <stdbool.h>

/** Words for the computer and the file of this program, the same after each start.  NULL is behind the last one. */
const char *const *epg_host_computer_words(void);

/**
 * Reserves a name on this computer until this program ends.  Returns false if another program has it.  The system frees
 * the name of a program that was killed.
 */
bool epg_host_computer_reserve(const char *name);

#endif
