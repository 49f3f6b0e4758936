/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Starts, runs and stops a target whose ticks and drivers belong to the program.
 */
#include "epg/firmware.h"

#include <stdatomic.h>

#include "epg/port.h"
#include "epg/serve.h"
#include "tick.h"

/** Time without a turn of the communication side after which epg_firmware_alive() is false. */
#define SILENCE_LIMIT_NS 1000000000U
/** Reads of a clock that stands still after which a wait for it ends. */
#define READS_OF_A_DEAD_CLOCK 100000U

/*
 * The communication side writes `state` while the target is off, and to request a stop; the control side writes it to end
 * a stop.  A fault handler can come between any two of these steps.  It therefore has a word of its own, which nobody
 * clears.  All accesses are loads and stores of single words, which every processor has.
 */
static atomic_uint state;
static atomic_bool made_safe;
static atomic_bool in_cycle; /* written by the control side */
static atomic_bool in_turn;  /* written by the communication side */

static struct {
    const epg_firmware_target_t *firmware;
    epg_firmware_tick_t tick;
} run;

static unsigned int present_state(void)
{
    return atomic_load(&made_safe) ? (unsigned int)EPG_FIRMWARE_SAFE : atomic_load(&state);
}

static const epg_application_t *application(void)
{
    return run.firmware->target->application;
}

bool epg_firmware_start(const epg_firmware_target_t *firmware)
{
    if (present_state() != EPG_FIRMWARE_OFF || atomic_load(&in_turn)) {
        return false;
    }
    if (!epg_serve_start_transport(firmware->transport, "EPG ROS 2") ||
        !epg_serve_start_transport(firmware->console_transport, "EPG console")) {
        return false;
    }
    const epg_target_t *target = firmware->target;
    run.firmware = firmware;
    epg_control_start(target->control, target->application);
    run.tick = (epg_firmware_tick_t){.period_ns = target->application->period_ns};
    epg_serve_start_middleware(target, target->middleware, firmware->transport);
    epg_serve_start_middleware(target, target->console, firmware->console_transport);
    atomic_store(&state, EPG_FIRMWARE_RUNNING);
    return true;
}

/** Waits until `state` is no longer STOPPING, at most four control periods.  A clock that stands still ends it, too. */
static void wait_for_tick(void)
{
    const uint64_t begin_ns = epg_port_time_ns();
    uint64_t last_ns = begin_ns;
    uint32_t reads = 0;
    while (present_state() == EPG_FIRMWARE_STOPPING && last_ns - begin_ns < 4U * application()->period_ns &&
           reads < READS_OF_A_DEAD_CLOCK) {
        const uint64_t now_ns = epg_port_time_ns();
        reads = now_ns == last_ns ? reads + 1U : 0U;
        last_ns = now_ns;
    }
}

static void stop_middleware(const epg_middleware_t *middleware)
{
    if (middleware != NULL && middleware->stop != NULL) {
        middleware->stop();
    }
}

bool epg_firmware_stop(void)
{
    if (atomic_load(&in_cycle) || atomic_load(&in_turn)) {
        return false;
    }
    if (present_state() != EPG_FIRMWARE_RUNNING) {
        return true;
    }
    atomic_store(&state, EPG_FIRMWARE_STOPPING);
    wait_for_tick();
    if (present_state() == EPG_FIRMWARE_STOPPING) { /* there are no ticks: the timer does not run */
        application()->safe();
        atomic_store(&state, EPG_FIRMWARE_OFF);
    }
    stop_middleware(run.firmware->target->middleware);
    stop_middleware(run.firmware->target->console);
    return true;
}

void epg_firmware_cycle(void)
{
    const unsigned int now = present_state();
    if (now == EPG_FIRMWARE_STOPPING && !atomic_load(&in_cycle)) {
        application()->safe();
        atomic_store(&state, EPG_FIRMWARE_OFF);
        return;
    }
    if (now != EPG_FIRMWARE_RUNNING || atomic_load(&in_cycle)) {
        return; /* a tick during a cycle: the clock shows the next cycle that this one was missed */
    }
    atomic_store(&in_cycle, true);
    epg_control_t *control = run.firmware->target->control;
    const uint32_t missed = epg_firmware_tick_pass(&run.tick, epg_port_time_ns());
    if (run.tick.wrong_rate) {
        run.tick.wrong_rate = false;
        epg_control_fault(control, EPG_FAULT_TICK, EPG_NO_COMPONENT);
    }
    epg_control_cycle(control, run.tick.due_ns, missed);
    run.tick.ended_ns = epg_port_time_ns();
    /* epg_firmware_safe() may have been called during the cycle, and before the cycle wrote its outputs. */
    if (present_state() == EPG_FIRMWARE_SAFE) {
        application()->safe();
    }
    atomic_store(&in_cycle, false);
}

void epg_firmware_communicate(void)
{
    if (present_state() != EPG_FIRMWARE_RUNNING || atomic_load(&in_turn)) {
        return;
    }
    atomic_store(&in_turn, true);
    const epg_firmware_target_t *firmware = run.firmware;
    epg_control_alive(firmware->target->control);
    epg_serve(firmware->target->middleware, firmware->transport);
    epg_serve(firmware->target->console, firmware->console_transport);
    atomic_store(&in_turn, false);
}

bool epg_firmware_alive(void)
{
    return present_state() == EPG_FIRMWARE_RUNNING &&
           epg_control_silence(run.firmware->target->control) * (uint64_t)application()->period_ns < SILENCE_LIMIT_NS;
}

void epg_firmware_safe(const epg_firmware_target_t *firmware)
{
    atomic_store(&made_safe, true);
    firmware->target->application->safe();
}

void epg_firmware_wait_until(uint64_t time_ns)
{
    uint64_t last_ns = epg_port_time_ns();
    uint32_t reads = 0;
    while (last_ns < time_ns && reads < READS_OF_A_DEAD_CLOCK) {
        const uint64_t now_ns = epg_port_time_ns();
        reads = now_ns == last_ns ? reads + 1U : 0U;
        last_ns = now_ns;
    }
}

/* Streams ------------------------------------------------------------------------------------------------------ */

bool epg_firmware_stream_start(void *context, const char *title)
{
    (void)title; /* two functions cannot report a name to the other end */
    epg_firmware_stream_t *stream = context;
    stream->first = 0;
    stream->count = 0;
    return true;
}

void epg_firmware_stream_flush(void *context)
{
    epg_firmware_stream_t *stream = context;
    /* At most two turns: the bytes to the end of the ring, and those at its beginning. */
    for (unsigned int part = 0; part < 2U && stream->count > 0; part++) {
        const size_t to_end = stream->size - stream->first;
        const size_t wanted = stream->count < to_end ? stream->count : to_end;
        const size_t offered = stream->write(stream->bytes + stream->first, wanted);
        const size_t taken = offered < wanted ? offered : wanted;
        stream->first = taken == to_end ? 0 : stream->first + taken;
        stream->count -= taken;
        if (taken < wanted) {
            return;
        }
    }
}

bool epg_firmware_stream_connected(void *context)
{
    (void)context;
    return true; /* two functions cannot tell whether a program is at the other end */
}

size_t epg_firmware_stream_read(void *context, void *data, size_t size)
{
    const epg_firmware_stream_t *stream = context;
    const size_t count = stream->read(data, size);
    return count < size ? count : size;
}

size_t epg_firmware_stream_write(void *context, const void *data, size_t size)
{
    epg_firmware_stream_t *stream = context;
    const unsigned char *bytes = data;
    size_t taken = 0;
    while (taken < size && stream->count < stream->size) {
        size_t at = stream->first + stream->count;
        at = at < stream->size ? at : at - stream->size;
        stream->bytes[at] = bytes[taken++];
        stream->count++;
    }
    return taken;
}

size_t epg_firmware_stream_writable(void *context)
{
    const epg_firmware_stream_t *stream = context;
    return stream->size - stream->count;
}
