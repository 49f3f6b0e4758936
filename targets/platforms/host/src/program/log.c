/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The severity of messages.
 */
#include "epg/host_log.h"

static epg_host_log_t level = EPG_HOST_LOG_INFO;

void epg_host_log_set(epg_host_log_t new_level)
{
    level = new_level;
}

bool epg_host_logs(epg_host_log_t severity)
{
    return severity >= level;
}
