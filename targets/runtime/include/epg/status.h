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

/** The origin of a stop, for the user. */
typedef enum epg_stop_source {
    EPG_STOP_START,    /**< the start of the target: nothing has stopped it since */
    EPG_STOP_LINE,     /**< a line of text at the console */
    EPG_STOP_FRAME,    /**< a program that uses frames, such as the page of `epg connect` */
    EPG_STOP_OTHER,    /**< an address that does not use the console by UDP */
    EPG_STOP_TOPIC,    /**< the topic that enables the target */
    EPG_STOP_SERVICE,  /**< the service that enables the target */
    EPG_STOP_PROGRAM,  /**< the user's program: `<name>_enable(false)` */
    EPG_STOP_SCENARIO, /**< an event of a simulation */
    EPG_STOP_FAULT,    /**< a fault was latched; the end of a lease and the fail-safe input are faults */
    EPG_STOP_SOURCES
} epg_stop_source_t;

/** The status of a target at the end of one control cycle. */
typedef struct epg_status {
    bool enabled;
    bool leased;              /**< while enabled: the target stays enabled only while a program answers */
    uint16_t fault_component; /**< index of the component with the fault; EPG_NO_COMPONENT: the whole target */
    epg_fault_t fault;        /**< the latched fault; EPG_FAULT_NONE: a disabled target was disabled by request */
    uint64_t time_ns;         /**< tick of the cycle that wrote this status, in board time */
    epg_statistics_t statistics;
    uint64_t stop_number; /**< number of the newest stop: its count since the start, plus 2^32 times a number that is
                                   different after each start of the program */
    uint64_t stop_ns;     /**< tick of the cycle that took that stop, in board time */
    epg_stop_source_t stop_source; /**< origin of that stop */
} epg_status_t;

#ifdef __cplusplus
}
#endif

#endif
