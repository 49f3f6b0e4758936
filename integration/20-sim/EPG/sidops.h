/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions of 20-sim's equation language (SIDOPS+) that are missing in C.
 *
 * Only `%SUBMODEL_NAME%.c` includes this file, after it has defined XXDouble, XXInteger, XXBoolean and XXString.
 * Equations compute with whole numbers as XXDouble, so the arguments of these functions have that type, too.
 */
#ifndef %SUBMODEL_NAME%_SIDOPS_H
#define %SUBMODEL_NAME%_SIDOPS_H

#define XXTRUE 1
#define XXFALSE 0

/* Only dll() functions use texts, and these run only inside of 20-sim. */
#define XXString2Double(text) ((XXDouble)0)

static inline XXDouble XXAbsolute(XXDouble x)
{
    return (XXDouble)fabs((double)x);
}

static inline XXDouble XXArcCosineHyperbolic(XXDouble x)
{
    return (XXDouble)log((double)x + sqrt((double)x * (double)x - 1.0));
}

static inline XXDouble XXArcSineHyperbolic(XXDouble x)
{
    return (XXDouble)log((double)x + sqrt((double)x * (double)x + 1.0));
}

static inline XXDouble XXArcTangentHyperbolic(XXDouble x)
{
    return (XXDouble)(0.5 * log((1.0 + (double)x) / (1.0 - (double)x)));
}

static inline XXDouble XXExponent2(XXDouble x)
{
    return (XXDouble)exp((double)x * 0.6931471805599453);
}

static inline XXDouble XXExponent10(XXDouble x)
{
    return (XXDouble)exp((double)x * 2.3025850929940457);
}

static inline XXDouble XXLogarithm2(XXDouble x)
{
    return (XXDouble)(log((double)x) * 1.4426950408889634);
}

static inline XXDouble XXLogarithm10(XXDouble x)
{
    return (XXDouble)log10((double)x);
}

static inline XXDouble XXPow2(XXDouble x)
{
    return x * x;
}

static inline XXDouble XXPower(XXDouble x, XXDouble exponent)
{
    return (XXDouble)pow((double)x, (double)exponent);
}

static inline XXDouble XXIntegerDivide(XXDouble a, XXDouble b)
{
    return (XXDouble)(XXInteger)(a / b);
}

static inline XXDouble XXIntegerModulo(XXDouble a, XXDouble b)
{
    return a - (XXDouble)(XXInteger)(a / b) * b;
}

static inline XXDouble XXRamp(XXDouble start, XXDouble time)
{
    return time < start ? (XXDouble)0 : time - start;
}

static inline XXDouble XXStep(XXDouble start, XXDouble time)
{
    return time < start ? (XXDouble)0 : (XXDouble)1;
}

static inline XXDouble XXImpulse(XXDouble start, XXDouble duration, XXDouble time, XXDouble step)
{
    if (step <= (XXDouble)0 || duration <= (XXDouble)0 || time < start || time > start + duration) {
        return (XXDouble)0;
    }
    return (XXDouble)1 / (step < duration ? duration : step);
}

static inline XXDouble XXSign(XXDouble x)
{
    return (XXDouble)((x > (XXDouble)0) - (x < (XXDouble)0));
}

static inline XXDouble XXXor(XXDouble a, XXDouble b)
{
    return (XXDouble)((a < (XXDouble)0 || a > (XXDouble)0) != (b < (XXDouble)0 || b > (XXDouble)0));
}

/* Rounds to the nearest whole number, and halves away from zero. */
static inline XXDouble XXRound(XXDouble x)
{
    if (fabs((double)x - (XXInteger)x) < 0.5) {
        return (XXDouble)(XXInteger)x;
    }
    return (XXDouble)(x >= (XXDouble)0 ? ceil((double)x) : floor((double)x));
}

static inline XXInteger XXBitAnd(XXDouble a, XXDouble b)
{
    return (XXInteger)a & (XXInteger)b;
}

static inline XXInteger XXBitOr(XXDouble a, XXDouble b)
{
    return (XXInteger)a | (XXInteger)b;
}

static inline XXInteger XXBitXor(XXDouble a, XXDouble b)
{
    return (XXInteger)a ^ (XXInteger)b;
}

static inline XXInteger XXBitInv(XXDouble a)
{
    return ~(XXInteger)a;
}

static inline XXInteger XXBitCmp(XXDouble a, XXDouble bits)
{
    return (XXInteger)bits < 32 ? ~(XXInteger)a & (XXInteger)((1u << (XXInteger)bits) - 1u) : ~(XXInteger)a;
}

static inline XXInteger XXBitGet(XXDouble a, XXDouble position)
{
    return ((XXInteger)a >> ((XXInteger)position - 1)) & 1;
}

static inline XXInteger XXBitSet(XXDouble a, XXDouble position)
{
    return (XXInteger)a | (XXInteger)(1u << ((XXInteger)position - 1));
}

static inline XXInteger XXBitClear(XXDouble a, XXDouble position)
{
    return (XXInteger)a & ~(XXInteger)(1u << ((XXInteger)position - 1));
}

static inline XXInteger XXBitShift(XXDouble a, XXDouble bits)
{
    const XXInteger by = (XXInteger)bits;

    return by > 0 ? (XXInteger)((unsigned)(XXInteger)a << by) : (XXInteger)a >> -by;
}

static inline XXInteger XXBitShiftRight(XXDouble a, XXDouble bits)
{
    const XXInteger by = (XXInteger)bits;

    return by > 0 ? (XXInteger)a >> by : (XXInteger)((unsigned)(XXInteger)a << -by);
}

static inline XXInteger XXSwapBytes(XXDouble a)
{
    const unsigned x = (unsigned)(XXInteger)a;

    return (XXInteger)(x << 24 | (x & 0xFF00u) << 8 | (x >> 8 & 0xFF00u) | x >> 24);
}

/*
 * Returns a uniformly distributed number between -range and range: 31 bits of a xorshift generator (G. Marsaglia,
 * J. Stat. Software 8(14), 2003).
 */
static inline XXDouble random_between(unsigned *state, XXDouble range)
{
    unsigned x = *state & 0xFFFFFFFFu;

    x ^= x << 13 & 0xFFFFFFFFu;
    x ^= x >> 17;
    x ^= x << 5 & 0xFFFFFFFFu;
    *state = x;
    return (XXDouble)((double)range * 2.0 * ((double)(x >> 1) / 2147483647.0 - 0.5));
}
#define XXRandom(range) random_between(&self->random_state, range)

static inline XXBoolean set_flag(char *flag)
{
    *flag = 1;
    return XXFALSE;
}
#define XXStopSimulation(message, id) set_flag(&self->stop_simulation)

static inline XXBoolean XXWarning(XXString message, XXInteger id)
{
    (void)message;
    (void)id;
    return XXFALSE;
}

/* Files with numbers, and events between two steps, exist only inside of 20-sim.  These functions return 0. */

static inline XXDouble XXData(XXString name, XXInteger column, XXInteger id)
{
    (void)name;
    (void)column;
    (void)id;
    return 0;
}

static inline XXDouble XXTable(XXString name, XXDouble argument, XXInteger id)
{
    (void)name;
    (void)argument;
    (void)id;
    return 0;
}

static inline XXDouble XXTimeDelay(XXDouble argument, XXDouble time, XXInteger id)
{
    (void)argument;
    (void)time;
    (void)id;
    return 0;
}

static inline XXBoolean XXFrequencyEvent(XXDouble argument, XXInteger id)
{
    (void)argument;
    (void)id;
    return 0;
}

#endif
