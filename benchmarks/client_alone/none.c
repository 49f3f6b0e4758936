/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * No communication.
 */
#include "handwritten.h"

void communicate(void)
{
    control_alive();
}
