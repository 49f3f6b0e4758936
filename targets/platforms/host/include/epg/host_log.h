/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The severity of the messages that a running host program prints on stderr, as in ROS 2: `--ros-args --log-level warn`.
 *
 * An error that ends the program is always printed.
 */
#ifndef EPG_HOST_LOG_H
#define EPG_HOST_LOG_H

#include <stdbool.h>

typedef enum epg_host_log {
    EPG_HOST_LOG_DEBUG,
    EPG_HOST_LOG_INFO, /**< the state of a connection; the level at the start */
    EPG_HOST_LOG_WARN,
    EPG_HOST_LOG_ERROR,
    EPG_HOST_LOG_FATAL,
    EPG_HOST_LOG_NONE /**< as a level: no messages */
} epg_host_log_t;

/** Sets the level.  Messages of a lower severity are not printed.  Must be called before the target starts. */
void epg_host_log_set(epg_host_log_t level);

/** True if messages of this severity are printed. */
bool epg_host_logs(epg_host_log_t severity);

#endif
