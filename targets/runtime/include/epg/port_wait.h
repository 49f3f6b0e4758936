/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The part of the port layer that is for middlewares which wait for the other end.
 *
 * Most never do (epg/middleware.h).  A platform implements this where communication is a thread or a task of its own:
 * there a middleware may wait, because control goes on, and so does what else the communication side does.
 */
#ifndef EPG_PORT_WAIT_H
#define EPG_PORT_WAIT_H

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Returns when something may have arrived, after a millisecond or two at the latest.  Meanwhile the transports have
 * moved their bytes, a console beside the middleware has been served, and the communication side counts as alive.  From
 * the middleware's poll().
 */
void epg_port_wait_for_bytes(void);

#ifdef __cplusplus
}
#endif

#endif
