/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What a target says about itself.
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

/** State and fault of a target at one moment. */
typedef struct epg_status {
    bool enabled;
    uint16_t fault_component; /**< index of the component that has the fault; EPG_NO_COMPONENT: none in particular */
    epg_fault_t fault;        /**< why it is disabled; EPG_FAULT_NONE: by request */
    uint64_t time_ns;         /**< tick of the cycle that wrote this */
    epg_statistics_t statistics;
} epg_status_t;

#ifdef __cplusplus
}
#endif

#endif
