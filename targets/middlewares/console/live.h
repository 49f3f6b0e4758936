/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The console for programs: messages in frames, streams of signals, and enabling on a lease.  docs/live.md defines them.
 */
#ifndef EPG_CONSOLE_LIVE_H
#define EPG_CONSOLE_LIVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "frame.h"

/** Types of messages: the first byte of each.  Whole numbers follow with their least significant byte first. */
typedef enum epg_console_message {
    EPG_CONSOLE_COMMAND = 'C', /**< to the console: tag (1 byte), command line */
    EPG_CONSOLE_STREAM = 'S', /**< to the console: tag (1), cycles per row (4), indices of signals (2 each; first 65535:
                                     values of 8 bytes) */
    EPG_CONSOLE_RESPONSE = 'R', /**< to the console: a number that it sent (4) */
    EPG_CONSOLE_KEEP = 'K',     /**< to the console: the program is there */
    EPG_CONSOLE_ANSWER = 'A',   /**< from the console: tag of the command or 0 (1), line */
    EPG_CONSOLE_NUMBER = 'N',   /**< from the console: number (4), which a program on a lease must send back */
    EPG_CONSOLE_ROWS = 'D', /**< from the console: first row's number (4) and tick in ns (8), values (float, 4 each) */
    EPG_CONSOLE_EXACT_ROWS = 'E' /**< the same with values of 8 bytes (double) */
} epg_console_message_t;

enum { EPG_CONSOLE_NUMBERS = 8 };

/** The state of the connection to a program. */
typedef struct epg_console_live {
    epg_console_frame_t frame;
    uint64_t byte_ns;  /**< arrival of the last byte of an open frame */
    uint64_t heard_ns; /**< arrival of the last whole frame */
    uint8_t wait_tag;  /**< tag of the command that waits for an event */
    uint8_t list_tag;  /**< tag of the command whose answer has several lines */
    uint8_t jog_tag;   /**< tag of the last jog */

    bool leased;       /**< numbers are sent */
    uint32_t number;   /**< newest number */
    uint32_t returned; /**< newest number that came back */
    uint64_t
        sent_ns[EPG_CONSOLE_NUMBERS]; /**< when the newest numbers were sent, at index number % EPG_CONSOLE_NUMBERS */
    uint64_t number_ns;               /**< when the next number must be sent */

    bool streaming;
    size_t columns;
    size_t value_size; /**< bytes of a value in a frame: 4 or 8 */
    size_t most;       /**< largest number of rows in a frame */
    uint64_t row_ns;   /**< time between two rows */
} epg_console_live_t;

#endif
