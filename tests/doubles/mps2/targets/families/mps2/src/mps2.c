/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions that programs call, the main stack, the serial number, the number of a start, and a store in memory that no reset clears.
 */
#include "epg/mps2.h"

#include <string.h>

#include "epg/one_core.h"
#include "epg/port.h"
#include "parts.h"

#define SECTOR 4096U
#define HEAD 64U

extern uint32_t stack_begin, stack_end;
const epg_mcu_stack_t epg_family_main_stack = {.bottom = &stack_begin, .top = &stack_end};

static NOT_CLEARED unsigned char sectors[2][SECTOR];

epg_mcu_error_t epg_family_check_start(const epg_family_target_t *target)
{
    (void)target;
    return EPG_MCU_OK;
}

bool epg_mps2_start(const epg_mps2_target_t *mps2)
{
    return epg_mcu_start(mps2);
}

bool epg_mps2_stop(void)
{
    return epg_mcu_stop();
}

const char *epg_port_serial(void)
{
    return "1";
}

uint32_t epg_port_boot_id(void)
{
    static NOT_CLEARED uint32_t starts; /* QEMU's memory begins with zeros */
    static bool counted;
    starts += counted ? 0U : 1U;
    counted = true;
    return starts;
}

size_t epg_sectors_capacity(void)
{
    return SECTOR - HEAD;
}

bool epg_sectors_read(uint32_t index, size_t at, void *data, size_t size)
{
    memcpy(data, &sectors[index][at], size);
    return true;
}

bool epg_sectors_write(uint32_t index, const void *data, size_t size, const void *head, size_t head_size)
{
    if (!epg_one_core_hold()) {
        return false;
    }
    memset(sectors[index], 0xFF, SECTOR);
    memcpy(sectors[index], data, size);
    memcpy(&sectors[index][SECTOR - HEAD], head, head_size);
    const uint64_t begin_ns = epg_one_core_time_ns(); /* as long as the erasure of a sector of flash */
    while (epg_one_core_time_ns() - begin_ns < 800000000U) {
    }
    epg_one_core_release();
    return true;
}
