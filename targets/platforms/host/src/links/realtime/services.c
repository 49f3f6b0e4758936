/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The middlewares that run beside the control loop in real time: services.h.
 */
#include "links/services.h"

#include "epg/port.h"
#include "port/clock.h"

enum { LONGEST_SLEEP_NS = 1000 * 1000 };

/** The target's middleware if it has a connection other than that of a console; NULL otherwise. */
static const epg_middleware_t *connected(const epg_host_services_t *services)
{
    return services->link != NULL || epg_host_connects_itself(services->target) ? services->target->middleware : NULL;
}

/** The middleware that is the console; NULL if there is neither a terminal nor a socket for it. */
static const epg_middleware_t *console_of(const epg_host_services_t *services)
{
    if (services->terminal == NULL && services->udp == NULL) {
        return NULL;
    }
    return services->target->console != NULL ? services->target->console : services->target->middleware;
}

bool epg_host_services_run(const epg_host_services_t *services)
{
    return connected(services) != NULL || console_of(services) != NULL;
}

void epg_host_services_start(const epg_host_services_t *services)
{
    const epg_middleware_t *middleware = connected(services);
    const epg_middleware_t *console = console_of(services);
    if (middleware != NULL) {
        middleware->start(services->target, services->link != NULL ? &services->link->stream : NULL);
    }
    if (console != NULL) {
        console->start(services->target, services->udp != NULL ? epg_host_udp_console_stream(services->udp)
                                                               : &services->terminal->stream);
    }
}

void epg_host_services_serve(epg_host_services_t *services, uint64_t time_ns)
{
    const epg_middleware_t *middleware = connected(services);
    const epg_middleware_t *console = console_of(services);
    const uint64_t soon_ns = epg_host_monotonic_ns() + LONGEST_SLEEP_NS;
    const uint64_t until_ns = time_ns < soon_ns ? time_ns : soon_ns;
    if (middleware != NULL && middleware->wait != NULL) {
        /* The middleware waits by the port layer's time, which can be simulated. */
        const uint64_t now_ns = epg_host_monotonic_ns();
        middleware->wait(epg_port_time_ns() + (until_ns > now_ns ? until_ns - now_ns : 0));
    } else {
        epg_host_services_wait(services, until_ns);
    }
    if (middleware != NULL) {
        middleware->poll(epg_port_time_ns());
        epg_host_services_tell(services);
    }
    if (console != NULL) {
        console->poll(epg_port_time_ns());
    }
}

static void stop(const epg_middleware_t *middleware)
{
    if (middleware != NULL && middleware->stop != NULL) {
        middleware->stop();
    }
}

void epg_host_services_stop(const epg_host_services_t *services)
{
    stop(console_of(services));
    stop(connected(services));
}
