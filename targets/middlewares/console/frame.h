/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Frames: the form of a message for programs, beside lines of text on the same stream.  docs/live.md defines them.
 *
 * A frame is a message and its CRC-32 (that of IEEE 802.3, least significant byte first), in the encoding COBS
 * (S. Cheshire and M. Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM Transactions on Networking 7(2), 1999),
 * between two zero bytes.  Text contains no zero byte, so both can follow each other.
 */
#ifndef EPG_CONSOLE_FRAME_H
#define EPG_CONSOLE_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    EPG_CONSOLE_FRAME_CRC = 4,  /**< bytes of the CRC */
    EPG_CONSOLE_FRAME_RUN = 255 /**< code of the longest run of COBS: 254 bytes without a zero after them */
};

/** Types of messages: the first byte of each.  Whole numbers follow with their least significant byte first. */
typedef enum epg_console_message {
    EPG_CONSOLE_COMMAND = 'C', /**< to the console: tag (1 byte), command line */
    EPG_CONSOLE_STREAM = 'S', /**< to the console: tag (1), cycles per row (4), indices of signals (2 each; first 65535:
                                     values of 8 bytes) */
    EPG_CONSOLE_RESPONSE = 'R', /**< to the console: a number that it sent (4) */
    EPG_CONSOLE_KEEP = 'K',     /**< to the console: the program is there */
    EPG_CONSOLE_ANSWER = 'A',   /**< from the console: tag of the command or 0 (1), line */
    EPG_CONSOLE_NUMBER = 'N',   /**< from the console: number (4), for a program on a lease or that moves by hand */
    EPG_CONSOLE_ROWS = 'D', /**< from the console: first row's number (4) and tick in ns (8), values (float, 4 each) */
    EPG_CONSOLE_EXACT_ROWS = 'E' /**< the same with values of 8 bytes (double) */
} epg_console_message_t;

/** Start value of a CRC-32, and value by which the result of epg_console_crc() must be inverted at the end. */
#define EPG_CONSOLE_CRC_START UINT32_C(0xFFFFFFFF)

/** Returns the CRC-32 after one more byte. */
uint32_t epg_console_crc(uint32_t crc, uint8_t byte);

/** A frame that is being received. */
typedef struct epg_console_frame {
    bool open;     /**< the first zero byte has arrived */
    bool too_long; /**< the frame is longer than the buffer */
    size_t length; /**< bytes of the message, with its CRC, so far; no more than the buffer has room for */
    uint32_t crc;  /**< CRC-32 of all bytes of the message so far, inverted */
    uint8_t code;  /**< code of the present run; 0: none has begun */
    uint8_t left;  /**< bytes of the present run that are still to come */
} epg_console_frame_t;

/** The meaning of a byte that was received. */
typedef enum epg_console_frame_part {
    EPG_CONSOLE_FRAME_MORE,     /**< the frame goes on */
    EPG_CONSOLE_FRAME_WHOLE,    /**< the frame is complete, and its CRC is right; `length` is without the CRC */
    EPG_CONSOLE_FRAME_TOO_LONG, /**< the frame is complete, but longer than the buffer */
    EPG_CONSOLE_FRAME_DAMAGED   /**< the frame is damaged; the byte can also be the beginning of the next one */
} epg_console_frame_part_t;

/**
 * Takes a byte: a zero byte, or any byte while `frame` is open.  The message is put into `bytes`, which has room for
 * `size` bytes.
 */
epg_console_frame_part_t epg_console_frame_take(epg_console_frame_t *frame, uint8_t *bytes, size_t size, uint8_t byte);

#endif
