/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The part of the port layer for middlewares that wait for an answer.
 *
 * Most middlewares never wait (epg/middleware.h).  Some libraries, however, block until the other end has answered.  A
 * platform implements this function if its communication side is a thread or a task.  The control loop then continues
 * while the middleware waits, and this function does the remaining work of the communication side.
 */
#ifndef EPG_PORT_WAIT_H
#define EPG_PORT_WAIT_H

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Waits until bytes may have arrived, at most one or two milliseconds.  Meanwhile it serves the transports and a
 * console that runs beside the middleware, and it reports the communication side as alive.  May be called from the
 * middleware's poll() only.
 */
void epg_port_wait_for_bytes(void);

#ifdef __cplusplus
}
#endif

#endif
