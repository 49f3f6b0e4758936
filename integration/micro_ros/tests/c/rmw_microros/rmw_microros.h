/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions of libmicroros for the agent's time, which clock_tests.c defines.
 */
#ifndef RMW_MICROROS_H
#define RMW_MICROROS_H

#include <stdbool.h>
#include <stdint.h>

#define RMW_RET_OK 0
#define RMW_RET_ERROR 1

typedef int32_t rmw_ret_t;

rmw_ret_t rmw_uros_sync_session(int timeout_ms);
bool rmw_uros_epoch_synchronized(void);
int64_t rmw_uros_epoch_nanos(void);

#endif
