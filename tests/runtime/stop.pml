/*
 * The latch of targets/runtime/src/control/stop.c for the model checker spin: every interleaving of its loads and stores.
 *
 * Each statement of a process touches one shared word, as the C code does; what is in d_step with it is bookkeeping for
 * assertions.  The words are sequentially consistent atomics.  A request carries the number of its maker, so that the
 * assertions know it; the C code stores the same constant for all.
 *
 * The properties, for stops and requests that begin and return at any time:
 *
 * P1  A cycle that begins after a stop has returned is disabled, until one such cycle was disabled as a whole.
 * P2  A request that had returned when a stop began does not act after that stop has returned.  A request acts once.
 * P3  A request that names a number does not act if a stop has returned since its maker learned the number.
 * P6  A request that begins after the last stop has returned acts at the latest in the second cycle after the one that
 *     took the stop.
 *
 * Four models, because one with all processes is too large.  Each has a control side with a fault.  Lease, fail-safe
 * input and guards are faults: the control side finds them itself, and does the same for each.
 *
 * DIRECT  a request without a queue, from a thread or an interrupt of the user's program; two stoppers, of which one
 *         stops twice.
 * NAMED   a second such request, which names a number; one stopper, which stops twice.  Requests of different contexts
 *         are in different words, so that more of them add nothing.
 * QUEUE   one context that finds stops, requests and movements by hand in a queue: the console.  A service is the same
 *         with one kind of request.  Two queues share no word but `pending`, and each sees the other's stops as those of
 *         another context.
 * EDGE    the topic: two publishers, and a stop of another context.  P4: a message `true` acts only if nothing else has
 *         stopped since the message before it, which was `false`.
 *
 * BROKEN_... leave out one rule each; spin must refuse each of them in the model that its comment names.
 */

#define NONE 0
#if defined(DIRECT) || defined(NAMED)
#define WITHOUT_QUEUE
#endif

/* The words of epg_latch_t.  Gate q: the queue, gate e: the edge. */
bit pending;
byte request_any;   /* EPG_GATE_PROGRAM */
byte request_after; /* EPG_GATE_PROGRAM_AFTER, */
byte after_number;  /* and the number in the same word */
byte request_q;
byte request_e;
bit closed_q;
bit closed_e;
bit moves;

byte number;    /* belongs to the control side */
byte acted;     /* the same: requests that have acted.  In C, the newest one of each gate */
byte published; /* the number in the newest status */
bit driven;

/* Bookkeeping.  Requests are bits: 1, 2, 4, 8. */
byte returned;    /* stops that have returned */
byte covered;     /* of these, the ones after which a whole cycle was disabled */
byte foreign;     /* stops that are under way, without those that wait in the queue */
bit since_poll;   /* such a stop began after the last poll that found the gate open */
byte made;        /* requests that have returned, or have arrived in the queue */
byte killed;      /* requests that must not act any more, by P2 */
byte outdated;    /* the same by P3 */
byte knowing;     /* requests whose makers have learned a number */
byte fresh;       /* requests that P6 promises to let act */
byte busy = 1;    /* processes that have not ended */
byte given;       /* a movement by hand that was handed over; its request */
bit moving;

/* Stores to words that no process of a model reads are left out of that model. */
inline cancel(own_q, own_e)
{
#ifdef WITHOUT_QUEUE
#ifndef BROKEN_STOP_KEEPS_REQUESTS /* DIRECT */
    request_any = NONE;
    request_after = NONE
#else
    skip
#endif
#else
#ifndef BROKEN_STOP_LEAVES_GATES_OPEN /* QUEUE */
    if
    :: own_q
    :: !own_q -> closed_q = 1
    fi;
#endif
#ifdef EDGE
    if
    :: own_e
    :: !own_e -> closed_e = 1
    fi;
    request_e = NONE
#else
    request_q = NONE;
#ifndef BROKEN_STOP_KEEPS_MOVEMENTS /* QUEUE */
    moves = 0
#else
    skip
#endif
#endif
#endif
}

#define BEGINS victims = made; foreign++; since_poll = 1; fresh = 0
#define RETURNS(by) returned++; foreign = foreign - by; killed = killed | victims; outdated = outdated | knowing

/* epg_stop().  `by` is 1 for a stop that is not from the queue. */
inline stop(own_q, own_e, by, victims)
{
#ifdef BROKEN_PENDING_FIRST /* DIRECT */
    pending = 1;
    cancel(own_q, own_e);
    d_step { RETURNS(by); }
#else
    cancel(own_q, own_e);
#ifdef BROKEN_STOP_NOT_LATCHED /* DIRECT */
    d_step { RETURNS(by); }
#else
    d_step { pending = 1; RETURNS(by); }
#endif
#endif
}

/* Control side ------------------------------------------------------------------------------------------------- */

/* A request may act: bookkeeping at the instant of the last question. */
inline judge(id)
{
    assert((killed & id) == 0);   /* P2 */
    assert((outdated & id) == 0); /* P3 */
}

inline find_request(found)
{
    found = NONE;
#ifdef WITHOUT_QUEUE
    found = request_any;
    if
    :: found == NONE ->
#ifdef BROKEN_NUMBER_NOT_COMPARED /* NAMED */
        found = request_after
#else
        d_step { if :: after_number == number -> found = request_after :: else fi }
#endif
    :: else
    fi;
#endif
#ifdef QUEUE
    if
#ifdef BROKEN_REQUEST_READ_BEFORE_ITS_GATE /* QUEUE */
    :: true ->
        found = request_q;
        if
        :: closed_q == 1 -> found = NONE
        :: else
        fi
#elif defined(BROKEN_CONTROL_IGNORES_GATES) /* QUEUE */
    :: true -> found = request_q
#else
    :: closed_q == 0 -> found = request_q
    :: else
#endif
    fi;
#endif
#ifdef EDGE
    if
#ifdef BROKEN_CONTROL_IGNORES_EDGE /* EDGE */
    :: true -> found = request_e
#else
    :: closed_e == 0 -> found = request_e
    :: else
#endif
    fi;
#endif
}

active proctype control()
{
    byte found;
    byte before;
    byte guard;
    byte quiet;
    byte faults;
    byte victims;
    bit stopped;
    do
    :: quiet < 4 ->
        /* A cycle begins. */
        d_step {
            before = returned;
            found = NONE;
            stopped = 0;
            if
            :: busy == 0 -> quiet++
            :: else
            fi
        }
#ifdef BROKEN_REQUEST_READ_LAST /* NAMED */
        if
        :: pending == 1 -> stopped = 1
        :: else
        fi;
        if
        :: !driven -> find_request(found)
        :: else
        fi;
        if
        :: !stopped && guard == 0 && found != NONE && !driven -> judge(found)
        :: else
        fi;
#else
        if
        :: !driven -> find_request(found)
        :: else
        fi;
#ifndef BROKEN_REQUEST_ACTS_TWICE /* DIRECT */
        d_step { if :: (acted & found) != 0 -> found = NONE :: else fi }
#endif
        d_step {
            if
            :: pending == 1 -> stopped = 1
            :: pending == 0 && guard == 0 && found != NONE && !driven -> judge(found)
            :: else
            fi
        }
#endif
        d_step {
            if
            :: stopped ->
#ifndef BROKEN_PENDING_NOT_CLEARED /* DIRECT */
                pending = 0;
#endif
                number++;
#ifndef BROKEN_NO_GUARD /* DIRECT */
                guard = 1;
#endif
                driven = 0
            :: !stopped && guard > 0 -> guard--; driven = 0
            :: !stopped && guard == 0 && found != NONE && !driven ->
                driven = 1;
                assert((acted & found) == 0); /* once */
                acted = acted | found
            :: else
            fi
        }
        /* A fault, at most one in a run, which a component finds in this cycle. */
        if
        :: faults == 0 && busy > 0 ->
            d_step { faults++; BEGINS; }
#ifndef BROKEN_FAULT_KEEPS_REQUESTS /* DIRECT */
            cancel(0, 0);
#endif
            d_step { RETURNS(1); before++; number++; guard = 1; driven = 0; }
        :: true
        fi;
        /* A movement by hand. */
#ifdef QUEUE
        if
        :: given != NONE ->
            d_step {
                if
                :: moves == 1 && !driven ->
                    if
                    :: !moving -> moving = 1; judge(given)
                    :: else
                    fi
                :: else -> given = NONE; moving = 0
                fi
            }
        :: else
        fi;
#endif
        d_step {
            if
            :: driven -> assert(covered == before) /* P1 */
            :: else -> covered = before
            fi;
            published = number
        }
    :: else -> break
    od;
    assert(fresh == 0 || driven) /* P6: four cycles after the last event; the first may have been under way */
}

/* Direct requests ---------------------------------------------------------------------------------------------- */

#ifdef WITHOUT_QUEUE
proctype stopper(byte times)
{
    byte victims;
    do
    :: times > 0 ->
        d_step { BEGINS; }
        stop(0, 0, 1, victims);
        times--
    :: else -> break
    od;
    busy--
}

proctype enabler()
{
    d_step { if :: foreign == 0 -> fresh = fresh | 1 :: else fi }
    d_step { request_any = 1; made = made | 1; }
    busy--
}

/* Learns the newest number, and enables if it still is the newest. */
#ifdef NAMED
proctype enabler_after()
{
    byte known;
    d_step { known = published; knowing = knowing | 2; }
    d_step { after_number = known; request_after = 2; made = made | 2; }
    busy--
}
#endif

init
{
    atomic {
        busy = 3;
        run stopper(2);
        run enabler();
#ifdef DIRECT
        run stopper(1)
#else
        run enabler_after()
#endif
    }
}
#endif

/* A stop of another context, for the models with a queue. */
proctype stopper_of_another()
{
    byte victims;
    d_step { BEGINS; }
    stop(0, 0, 1, victims);
    busy--
}

/* epg_gate_poll() with the request of the gate. */
inline poll_gate(request, clean)
{
#ifdef BROKEN_POLL_IS_ALWAYS_CLEAN /* QUEUE */
    clean = 1;
    d_step { closed_q = 0; if :: foreign == 0 -> since_poll = 0 :: else fi }
#else
    d_step {
        clean = 1 - closed_q;
        if
        :: clean && foreign == 0 -> since_poll = 0
        :: else
        fi
    }
    if
    :: clean
    :: else ->
#ifndef BROKEN_OPEN_KEEPS_THE_REQUEST /* QUEUE */
        request = NONE;
#endif
        closed_q = 0
    fi
#endif
}

#define PROMISE(id) if :: foreign == 0 && since_poll == 0 -> fresh = fresh | id :: else fi

/* A queue ------------------------------------------------------------------------------------------------------ */

#ifdef QUEUE
#define STOP 1
#define ENABLE 2
#define MOVE 3

/* Kind, request, and for a stop the requests that had arrived before it. */
chan queue = [2] of { byte, byte, byte };
byte left = 2; /* entries that have not been carried out */

/* Puts two entries into the queue. */
proctype sender()
{
    byte id = 1;
    do
    :: id <= 2 ->
        if
        :: d_step { PROMISE(id); queue!ENABLE,id,0; made = made | id; }
        :: d_step { queue!MOVE,id,0; made = made | id; }
        :: d_step { fresh = 0; queue!STOP,0,made }
        fi;
        id = id * 2
    :: else -> break
    od;
    busy--
}

/* The context of the queue: polls until all entries are carried out. */
proctype poller()
{
    byte kind[2];
    byte id[2];
    byte count;
    byte next;
    byte last_stop;
    byte victims;
    bit clean;
    do
    :: left > 0 ->
        poll_gate(request_q, clean);
        /* All that has arrived is read, and its stops act before any command. */
        count = 0;
        last_stop = 0;
        do
        :: count < 2 && nempty(queue) ->
            queue?kind[count],id[count],victims;
            if
            :: kind[count] == STOP ->
                last_stop = count + 1;
#ifdef BROKEN_OWN_STOP_CLOSES_ITS_GATE /* QUEUE */
                stop(0, 0, 0, victims)
#else
                stop(1, 0, 0, victims)
#endif
            :: else
            fi;
            count++
        :: count == 2 || empty(queue) -> break
        od;
        next = 0;
        do
        :: next < count ->
            if
#ifdef BROKEN_OVERTAKEN_ACTS /* QUEUE */
            :: kind[next] == ENABLE && clean -> request_q = id[next]
            :: kind[next] == ENABLE && !clean
#else
            :: kind[next] == ENABLE && clean && next >= last_stop -> request_q = id[next]
            :: kind[next] == ENABLE && (!clean || next < last_stop)
#endif
            :: kind[next] == MOVE && clean && next >= last_stop && given == NONE ->
#ifdef BROKEN_MOVE_ASKS_FIRST /* QUEUE */
                if
                :: closed_q == 0 -> moves = 1; given = id[next]
                :: else
                fi
#else
                moves = 1;
                if
                :: closed_q == 0 -> given = id[next]
                :: else
                fi
#endif
            :: kind[next] == MOVE && !(clean && next >= last_stop && given == NONE)
            :: kind[next] == STOP
            fi;
            next++;
            left--
        :: else -> break
        od
    :: else -> break
    od;
    busy--
}

init
{
    atomic {
        busy = 3;
        run sender();
        run stopper_of_another();
        run poller()
    }
}
#endif

/* The topic ---------------------------------------------------------------------------------------------------- */

#ifdef EDGE
#define FALSE 1
#define TRUE 2

chan topic = [3] of { byte, byte, byte };
byte left = 3;

/* One node publishes `false` and then `true`, which is request 1.  Another node repeats `true`: request 2. */
inline publish_edge()
{
    d_step { fresh = 0; topic!FALSE,0,made; made = made | 1; PROMISE(1); } /* a stop after this kills the request, too */
    topic!TRUE,1,0
}

inline publish_repeated()
{
    d_step { topic!TRUE,2,0; made = made | 2; killed = killed | 2; } /* no message `false` is before it */
}

proctype publishers()
{
    if
    :: publish_edge(); publish_repeated()
    :: publish_repeated(); publish_edge()
    fi;
    busy--
}

proctype poller()
{
    byte kind;
    byte id;
    byte victims;
    bit clean;
    bit low;
    do
    :: left > 0 ->
        poll_gate(request_q, clean); /* gate q is that of the topic's queue here */
        do
        :: nempty(topic) ->
            topic?kind,id,victims;
            left--;
            if
            :: kind == FALSE ->
                stop(1, 1, 0, victims);
                low = 1;
#ifdef BROKEN_EDGE_OPENED_LAST /* EDGE */
                if
                :: clean && closed_q == 0 -> request_e = NONE; closed_e = 0
                :: else -> closed_e = 1
                fi
#else
                request_e = NONE;
                closed_e = 0;
#ifndef BROKEN_EDGE_OPENED_BLINDLY /* EDGE */
                if
                :: !clean || closed_q == 1 -> closed_e = 1
                :: else
                fi
#endif
#endif
            :: kind == TRUE ->
#ifdef BROKEN_EVERY_TRUE /* EDGE */
                if
                :: clean && closed_e == 0 -> request_e = id
                :: else
                fi
#else
                if
                :: low && clean && closed_e == 0 -> request_e = id
                :: else
                fi;
                low = 0
#endif
            fi
        :: empty(topic) -> break
        od
    :: else -> break
    od;
    busy--
}

init
{
    atomic {
        busy = 3;
        run publishers();
        run stopper_of_another();
        run poller()
    }
}
#endif
