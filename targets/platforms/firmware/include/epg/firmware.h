/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A target in a program that has its own drivers, on any chip.
 *
 * The program calls three functions: one per tick of its own timer, one in its main loop or in a task, and one that
 * starts both.  EPG calls the program's drivers, which are a few typed functions.  The generated header
 * `<name>_firmware.h` declares all of them for one target and says for each in which context it is called.
 *
 * **Contexts.**  The control side is the context that calls `<name>_cycle()`: usually the interrupt of a timer.  The
 * communication side is the context that calls `<name>_communicate()`: the main loop, or a task.  The control side may
 * interrupt the communication side at any place.  They may also run on two cores.  Neither waits for the other, and no
 * function here masks interrupts, so the program owns all priorities.
 *
 * **Time.**  The program has one clock, `<name>_time_ns()`.  It need not be the clock of the timer that calls the
 * cycle: the two may differ by 1.5 percent.  A timer that is further off is a mistake in its settings; it latches the
 * fault EPG_FAULT_TICK.
 *
 * The functions need no operating system, no heap and no start-up code of EPG's.  A program contains one target of this
 * platform.  Generated code calls them; programs use the functions of `<name>_firmware.h`.
 */
#ifndef EPG_FIRMWARE_H
#define EPG_FIRMWARE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/target.h"
#include "epg/transport.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A stream of bytes by two functions of the program, and the ring in which bytes wait until they can be sent. */
typedef struct epg_firmware_stream {
    /** Copies up to `size` received bytes to `data`.  Returns their number, 0 if there are none.  Must not wait. */
    size_t (*read)(void *data, size_t size);
    /** Takes up to `size` bytes to send.  Returns their number, 0 if there is no room.  Must not wait. */
    size_t (*write)(const void *data, size_t size);
    unsigned char *bytes; /**< memory of the ring */
    size_t size;          /**< number of `bytes` */
    size_t first;         /**< index of the oldest byte in the ring */
    size_t count;         /**< number of bytes in the ring */
} epg_firmware_stream_t;

/* The functions of a transport over an epg_firmware_stream_t; epg/transport.h and epg/stream.h describe them. */
bool epg_firmware_stream_start(void *context, const char *title);
void epg_firmware_stream_flush(void *context);
bool epg_firmware_stream_connected(void *context);
size_t epg_firmware_stream_read(void *context, void *data, size_t size);
size_t epg_firmware_stream_write(void *context, const void *data, size_t size);
size_t epg_firmware_stream_writable(void *context);

/** Initialiser of an epg_transport_t over `stream_`, a pointer to an epg_firmware_stream_t. */
#define EPG_FIRMWARE_TRANSPORT(stream_)                                                                                \
    {                                                                                                                  \
        .start = epg_firmware_stream_start, .flush = epg_firmware_stream_flush, .stream = {                            \
            .connected = epg_firmware_stream_connected,                                                                \
            .read = epg_firmware_stream_read,                                                                          \
            .write = epg_firmware_stream_write,                                                                        \
            .writable = epg_firmware_stream_writable,                                                                  \
            .context = (stream_),                                                                                      \
        }                                                                                                              \
    }

/** A target with its transports; generated. */
typedef struct epg_firmware_target {
    const epg_target_t *target;
    const epg_transport_t *transport;         /**< of the target's middleware; NULL if it needs none */
    const epg_transport_t *console_transport; /**< of a console beside another middleware; NULL if there is none */
} epg_firmware_target_t;

/** The state of the target in this program. */
typedef enum epg_firmware_state {
    EPG_FIRMWARE_OFF,      /**< not started, or stopped */
    EPG_FIRMWARE_RUNNING,  /**< each tick runs a cycle */
    EPG_FIRMWARE_STOPPING, /**< the next tick makes the outputs safe */
    EPG_FIRMWARE_SAFE      /**< epg_firmware_safe() has ended the run: only a reset starts it again */
} epg_firmware_state_t;

/**
 * `<name>_start()`: starts components and communication.  Ticks before it do nothing.  Returns false if the target runs
 * already, or if a stream cannot start; then it can be called again.
 */
bool epg_firmware_start(const epg_firmware_target_t *firmware);

/**
 * `<name>_stop()`: waits for the next tick, at most four control periods, and returns true when the outputs are safe.
 * Returns false, and changes nothing, in the context of the cycle or of the communication.
 */
bool epg_firmware_stop(void);

/** `<name>_cycle()`: runs one control cycle.  Control side. */
void epg_firmware_cycle(void);

/** `<name>_communicate()`: one turn of the communication side. */
void epg_firmware_communicate(void);

/** `<name>_alive()`: true while both sides run, for a watchdog.  Control side. */
bool epg_firmware_alive(void);

/** `<name>_safe()`: makes all outputs safe until the next reset.  For fault handlers; every context. */
void epg_firmware_safe(const epg_firmware_target_t *firmware);

/** Waits until epg_port_time_ns() has reached `time_ns`.  A clock that stands still ends the wait, too. */
void epg_firmware_wait_until(uint64_t time_ns);

#ifdef __cplusplus
}
#endif

#endif
