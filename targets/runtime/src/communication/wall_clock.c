/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The clock of the network: time stamps of messages, in nanoseconds since 1970.
 */
#include "epg/wall_clock.h"

#define MS UINT64_C(1000000)

static const uint64_t FIRST_INTERVAL_NS = 20 * MS; /* interval between two requests until the clock is set */
static const uint64_t INTERVAL_NS = 100 * MS;      /* the same later */
static const uint64_t FIRST_ROUND_NS = 1000 * MS;  /* longest time for a round's answers until the clock is set */
static const uint64_t ROUND_NS = 3000 * MS;        /* the same later: all requests and the longest round trip */
static const uint64_t PAUSE_NS = 10000 * MS;       /* time between the begins of two rounds */
static const uint64_t BUSY_NS = 5 * MS;            /* longest time for which a request waits for a short poll */
static const uint64_t LONGEST_ROUND_TRIP_NS = 2000 * MS;
static const uint64_t LATEST_NS = INT32_MAX * (1000 * MS); /* stamps have 32 bits for the seconds */
static const int64_t STEP_NS = 500000000;

/** The time of a correction.  A power of two, so that no division is needed: 8.6 s. */
#define SLEW_NS (INT64_C(1) << 33)

/** Returns the difference from board time to the time since 1970.  It is continuous where the two pieces meet. */
static int64_t offset_at(const epg_clock_t *clock, uint64_t time_ns)
{
    const epg_clock_piece_t *piece = time_ns >= clock->present.since_ns ? &clock->present : &clock->before;
    const uint64_t elapsed_ns = time_ns > piece->since_ns ? time_ns - piece->since_ns : 0;
    if (piece->surplus_ns == 0 || elapsed_ns >= SLEW_NS) {
        return piece->offset_ns;
    }
    return piece->offset_ns + piece->surplus_ns * (SLEW_NS - (int64_t)elapsed_ns) / SLEW_NS;
}

/** Sets the clock by the best answer of the round. */
static void set_clock(epg_clock_t *clock, uint64_t now_ns)
{
    epg_clock_piece_t piece = {.since_ns = now_ns, .offset_ns = clock->best_offset_ns};
    clock->uncertainty_ns = (uint32_t)((clock->best_ns + 1U) / 2U);
    if (!clock->set) { /* cycles before this instant get a stamp, too */
        clock->set = true;
        clock->before = piece;
        clock->present = piece;
        return;
    }
    piece.surplus_ns = offset_at(clock, now_ns) - piece.offset_ns;
    if (piece.surplus_ns > STEP_NS || piece.surplus_ns < -STEP_NS) {
        clock->steps++;
        clock->step_ns = -piece.surplus_ns;
        piece.surplus_ns = 0;
    }
    clock->before = clock->present;
    clock->present = piece;
}

static void end_round(epg_clock_t *clock, uint64_t now_ns)
{
    const bool any = clock->answered > 0;
    if (any) {
        set_clock(clock, now_ns);
    }
    clock->due_ns = any ? clock->round_ns + PAUSE_NS : now_ns;
    clock->asked = 0;
    clock->answered = 0;
}

void epg_clock_start(epg_clock_t *clock, bool simulated)
{
    *clock = (epg_clock_t){.set = simulated, .simulated = simulated, .due_ns = simulated ? UINT64_MAX : 0};
}

void epg_clock_connected(epg_clock_t *clock, uint64_t now_ns)
{
    if (!clock->simulated) {
        clock->asked = 0;
        clock->answered = 0;
        clock->due_ns = now_ns;
    }
}

bool epg_clock_poll(epg_clock_t *clock, uint64_t now_ns, bool busy)
{
    if (now_ns < clock->due_ns || (busy && now_ns - clock->due_ns < BUSY_NS)) {
        return false;
    }
    if (clock->asked == 0) {
        clock->round_ns = now_ns;
        clock->answered = 0; /* late answers of the last round are older than the pause */
    }
    const uint64_t end_ns = clock->round_ns + (clock->set ? ROUND_NS : FIRST_ROUND_NS);
    if (now_ns >= end_ns) {
        end_round(clock, now_ns);
        return false;
    }
    clock->asked++;
    const uint64_t next_ns = now_ns + (clock->set ? INTERVAL_NS : FIRST_INTERVAL_NS);
    clock->due_ns = clock->asked < EPG_CLOCK_ANSWERS && next_ns < end_ns ? next_ns : end_ns;
    return true;
}

void epg_clock_answer(epg_clock_t *clock, uint64_t epoch_ns, uint64_t now_ns, uint64_t round_trip_ns)
{
    if (clock->simulated || round_trip_ns > LONGEST_ROUND_TRIP_NS || epoch_ns == 0 || epoch_ns > LATEST_NS) {
        return;
    }
    if (clock->answered == 0 || round_trip_ns < clock->best_ns) {
        clock->best_ns = round_trip_ns;
        clock->best_offset_ns = (int64_t)epoch_ns - (int64_t)now_ns;
    }
    clock->answered++;
    if (clock->answered == EPG_CLOCK_ANSWERS) {
        end_round(clock, now_ns);
    }
}

uint64_t epg_clock_stamp_ns(const epg_clock_t *clock, uint64_t time_ns)
{
    if (!clock->set) {
        return 0;
    }
    const int64_t stamp_ns = (int64_t)time_ns + offset_at(clock, time_ns);
    return stamp_ns > 0 ? (uint64_t)stamp_ns : 0;
}
