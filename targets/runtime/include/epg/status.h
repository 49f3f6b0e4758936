/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The status of a target: enabled or disabled, its fault, and its statistics.
 */
#ifndef EPG_STATUS_H
#define EPG_STATUS_H

#include <stdbool.h>
#include <stdint.h>

#include "epg/fault.h"
#include "epg/statistics.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The status of a target at the end of one control cycle. */
typedef struct epg_status {
    bool enabled;
    bool leased;              /**< while enabled: the target stays enabled only while a program answers */
    uint16_t fault_component; /**< index of the component with the fault; EPG_NO_COMPONENT: the whole target */
    epg_fault_t fault;        /**< the latched fault; EPG_FAULT_NONE: a disabled target was disabled by request */
    uint64_t time_ns;         /**< tick of the cycle that wrote this status, in board time */
    epg_statistics_t statistics;
} epg_status_t;

#ifdef __cplusplus
}
#endif

#endif
