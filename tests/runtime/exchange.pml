/*
 * The exchange of targets/runtime/src/control/exchange.c for the model checker spin: one writer, one reader, every
 * interleaving of their loads and stores.
 *
 * A value is two words that are copied one after the other, so that a torn value can be seen.  Each statement of a
 * process touches one shared word, as the C code does; what stands in d_step with it is bookkeeping for assertions.
 * Sequential interleaving is what C11 promises here: the control words are sequentially consistent atomics, and the
 * assertion `unshared` shows that the plain words are free of data races.
 *
 * Neither process has a loop or a wait inside one operation, and spin reports a state in which one cannot go on as
 * an invalid end state: both sides are wait-free, in at most nine steps.  epg_exchange_take() asks for `writes` once
 * more in epg_exchange_read(), which decides nothing: the count never returns to 0.
 *
 * BROKEN_... leave out one rule of the algorithm each; spin must refuse all of them.  WITHOUT_UNSHARED leaves out
 * the assertion `unshared`, which most of them hit first, so that the assertions on values are seen to work as well.
 */
#ifdef WITHOUT_UNSHARED
#define UNSHARED true
#else
#define UNSHARED (being_read != being_written)
#endif
#ifndef WRITES
#define WRITES 6
#endif
#ifndef READS
#define READS 5
#endif
#define NONE 4

byte first[4];
byte second[4];
bit latest;
bit reading;
bit newest[2];
byte writes;            /* writes that have finished */

byte finished;          /* newest value whose write has returned */
byte being_written = NONE;
byte being_read = NONE;

active proctype writer()
{
    byte value = 1;
    bit pair;
    bit index;
    do
    :: value <= WRITES ->
#ifdef BROKEN_IGNORES_THE_READER
        pair = 1 - latest;
#else
        pair = 1 - reading;
#endif
#ifdef BROKEN_ONE_BUFFER_PER_PAIR
        index = 0;
#else
        index = 1 - newest[pair];
#endif
#ifdef BROKEN_NEWEST_BEFORE_DATA
        newest[pair] = index;
#endif
        d_step { being_written = 2 * pair + index; first[2 * pair + index] = value; }
        d_step {
            assert(UNSHARED); /* unshared */
            second[2 * pair + index] = value;
            being_written = NONE;
        }
#ifdef BROKEN_COUNT_BEFORE_PAIR
        writes = value;
#endif
#ifdef BROKEN_PAIR_BEFORE_NEWEST
        latest = pair;
        newest[pair] = index;
#else
        newest[pair] = index;
        latest = pair;
#endif
        d_step { writes = value; finished = value; }
        value++
    :: else -> break
    od
}

active proctype reader()
{
    byte count;
    byte before;
    byte expected;
    byte one;
    byte two;
    byte seen;
    byte taken;
    bit take;
    bit pair;
    bit index;
    do
    :: count < READS ->
        expected = finished;
        if
        :: take = 0
        :: take = 1 /* epg_exchange_take() */
        fi;
        seen = writes;
        if
        :: seen == 0 ->
            assert(expected == 0) /* empty only before the first write has returned */
        :: seen != 0 && take && seen == taken ->
            assert(before >= expected) /* nothing to take only if the value read before is the newest */
        :: else ->
            if
            :: take -> taken = seen
            :: else
            fi;
            pair = latest;
#ifdef BROKEN_ANNOUNCES_LATE
            index = newest[pair];
            reading = pair;
#else
            reading = pair;
            index = newest[pair];
#endif
            d_step { being_read = 2 * pair + index; one = first[2 * pair + index]; }
            d_step {
                assert(UNSHARED); /* unshared */
                two = second[2 * pair + index];
                being_read = NONE;
            }
            assert(one == two);      /* coherent: never half of one value and half of another */
            assert(one >= expected); /* fresh: never older than the newest write that had returned */
            assert(one >= before);   /* in order: never older than the value read before */
            before = one
        fi;
        count++
    :: else -> break
    od
}
