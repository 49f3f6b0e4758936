/*
 * The handover of targets/runtime/include/epg/handover.h for the model checker spin: a giver and a taker, every
 * interleaving of their loads and stores.
 *
 * The block is two plain words.  Each statement of a process touches one shared word, as the C code does; what stands
 * in d_step with it is bookkeeping for assertions.  Both counters are sequentially consistent atomics, and `unshared`
 * shows that the plain words are free of data races.  Where a side would have to wait it does something else: an `else`
 * on each question shows that none is ever stuck in one.
 *
 * BROKEN_... leave out one rule each; spin must refuse all of them.
 */
#ifndef ROUNDS
#define ROUNDS 4
#endif

byte first;
byte second;
byte given;
byte returned;

byte using;  /* bit 0: the giver works on the block, bit 1: the taker */
byte answer; /* what the taker has made of it: the giver finds it when the block is back */

active proctype giver()
{
    byte round = 1;
    byte seen;
    do
    :: round > ROUNDS -> break
    :: else ->
        seen = returned;
#ifdef BROKEN_GIVER_DOES_NOT_ASK
        if
        :: true ->
#else
        if
        :: seen == given ->
#endif
            d_step { using = using | 1; assert(using == 1); /* unshared */ }
            assert(round == 1 || answer == round - 1);
            first = round;
#ifdef BROKEN_GIVEN_BEFORE_WRITTEN
            given = given + 1;
            second = round;
            using = using & 2;
#else
            second = round;
            using = using & 2;
            given = given + 1;
#endif
            round++
        :: else -> skip
        fi
    od
}

active proctype taker()
{
    byte taken = 0;
    byte seen;
    do
    :: taken == ROUNDS -> break
    :: else ->
        seen = given;
#ifdef BROKEN_TAKER_DOES_NOT_ASK
        if
        :: true ->
#else
        if
        :: seen != returned ->
#endif
            d_step { using = using | 2; assert(using == 2); /* unshared */ }
            taken++;
            assert(first == taken); /* none is lost, none comes twice */
            assert(second == taken);
#ifdef BROKEN_RETURNED_BEFORE_ANSWERED
            returned = given;
            answer = taken;
            using = using & 1;
#else
            answer = taken;
            using = using & 1;
            returned = given;
#endif
        :: else -> skip
        fi
    od
}
