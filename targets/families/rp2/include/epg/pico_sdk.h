/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The headers of the Pico SDK, as system headers: the warnings that users choose apply to their own code only.
 */
#ifndef EPG_PICO_SDK_H
#define EPG_PICO_SDK_H

#pragma GCC system_header

#include "hardware/address_mapped.h"
#include "hardware/clocks.h"
#include "hardware/exception.h"
#include "hardware/gpio.h"
#include "hardware/irq.h"
#include "hardware/pwm.h"
#include "hardware/structs/busctrl.h"
#include "hardware/structs/iobank0.h"
#include "hardware/structs/psm.h"
#include "hardware/structs/scb.h"
#include "hardware/structs/sio.h"
#include "hardware/structs/systick.h"
#include "hardware/structs/timer.h"
#include "hardware/structs/watchdog.h"
#include "hardware/sync.h"
#include "hardware/timer.h"
#include "hardware/watchdog.h"
#include "pico.h"
#include "pico/multicore.h"
#include "pico/runtime_init.h"
#include "pico/unique_id.h"

#if PICO_NO_RAM_VECTOR_TABLE
#error "EPG needs a vector table in RAM: remove PICO_NO_RAM_VECTOR_TABLE from the compile definitions"
#endif

#endif
