/**
 * @file
 * Numbers of type double by integers, compared with this computer's double arithmetic.
 */
#define EPG_SOFT_DOUBLE 1 /* the functions of a processor without double arithmetic */
#include "epg/soft_double.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>

#include "check.h"

enum { RANDOM_PAIRS = 1000000 };

/** Each has its neighbours and its negative in the pairs.  0x1p-1040 is denormal. */
static const double special[] = {
    0.0,    DBL_TRUE_MIN, 0x1p-1040, DBL_MIN, DBL_EPSILON, 0.5,    1.0,    3.141592653589793, INT32_MAX,
    0x1p31, UINT32_MAX,   0x1p32,    0x1p52,  0x1p53,      0x1p63, 0x1p64, DBL_MAX,           INFINITY,
};
enum { SPECIAL_COUNT = sizeof special / sizeof special[0] };

static double numbers[6 * SPECIAL_COUNT];
enum { NUMBER_COUNT = sizeof numbers / sizeof numbers[0] };

static const int64_t integers[] = {
    0,
    1,
    -1,
    2,
    -3,
    4096,
    INT16_MIN,
    INT16_MAX,
    INT32_MIN + 1LL,
    INT32_MIN,
    INT32_MIN - 1LL,
    INT32_MAX - 1LL,
    INT32_MAX,
    INT32_MAX + 1LL,
    UINT32_MAX,
    UINT32_MAX + 1LL,
    -(int64_t)UINT32_MAX,
    -(int64_t)UINT32_MAX - 1,
    (1LL << 53) - 1,
    (1LL << 53) + 1,
    INT64_MIN,
    INT64_MIN + 1,
    INT64_MAX - 1,
    INT64_MAX,
};
enum { INTEGER_COUNT = sizeof integers / sizeof integers[0] };

static uint64_t random_state = 0x9E3779B97F4A7C15U;

/** xorshift64*, so that a failure can be repeated. */
static uint64_t next_random(void)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return random_state * 0x2545F4914F6CDD1DU;
}

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/** Returns any number that is not NaN: all patterns of bits are equally likely. */
static double random_number(void)
{
    for (;;) {
        const uint64_t bits = next_random();
        double value;
        memcpy(&value, &bits, sizeof value);
        if (!isnan(value)) {
            return value;
        }
    }
}

static void fill_numbers(void)
{
    for (size_t i = 0; i < SPECIAL_COUNT; i++) {
        const double around[] = {nextafter(special[i], -INFINITY), special[i], nextafter(special[i], INFINITY)};
        for (size_t k = 0; k < 3; k++) {
            numbers[6 * i + 2 * k] = around[k];
            numbers[6 * i + 2 * k + 1] = -around[k];
        }
    }
}

static void check_pair(double a, double b)
{
    const int64_t order_a = epg_order(a);
    const int64_t order_b = epg_order(b);
    if (epg_less(a, b) != (a < b) || epg_at_most(a, b) != (a <= b) || (order_a < order_b) != (a < b) ||
        (order_a == order_b) != (a == b)) {
        fprintf(stderr, "%a and %a: less %d, at most %d, orders %" PRId64 " and %" PRId64 "\n", a, b, epg_less(a, b),
                epg_at_most(a, b), order_a, order_b);
        exit(1);
    }
}

/** Checks that both have the same bits, or are NaN: C does not state the sign and the payload of a NaN. */
static void check_scaled(int64_t number, double scale, double offset)
{
    const double expected = offset + (double)number * scale;
    const double actual = epg_scaled(number, scale, offset);
    if (bits_of(actual) != bits_of(expected) && !(isnan(actual) && isnan(expected))) {
        fprintf(stderr, "%a + %" PRId64 " * %a is %a, not %a\n", offset, number, scale, actual, expected);
        exit(1);
    }
}

TEST(special_numbers_compare_like_doubles)
{
    fill_numbers();
    for (size_t i = 0; i < NUMBER_COUNT; i++) {
        for (size_t k = 0; k < NUMBER_COUNT; k++) {
            check_pair(numbers[i], numbers[k]);
        }
    }
}

TEST(random_numbers_compare_like_doubles)
{
    for (int i = 0; i < RANDOM_PAIRS; i++) {
        const double a = random_number();
        check_pair(a, random_number());
        check_pair(a, a);
        check_pair(a, -a);
        check_pair(a, nextafter(a, INFINITY));
        check_pair(a, nextafter(a, -INFINITY));
    }
}

TEST(the_order_of_zero_is_zero)
{
    CHECK(epg_order(0.0) == 0);
    CHECK(epg_order(-0.0) == 0);
    CHECK(epg_order(DBL_TRUE_MIN) == 1);
    CHECK(epg_order(-DBL_TRUE_MIN) == -1);
}

TEST(special_integers_are_scaled_like_doubles)
{
    fill_numbers();
    for (size_t i = 0; i < INTEGER_COUNT; i++) {
        for (size_t k = 0; k < NUMBER_COUNT; k++) {
            if (numbers[k] != 0.0) { /* see epg_scaled() */
                for (size_t n = 0; n < NUMBER_COUNT; n++) {
                    check_scaled(integers[i], numbers[k], numbers[n]);
                }
                check_scaled(integers[i], numbers[k], NAN);
            }
        }
        check_scaled(integers[i], NAN, 0.0);
        check_scaled(integers[i], NAN, 1.0);
    }
}

TEST(random_integers_are_scaled_like_doubles)
{
    for (int i = 0; i < RANDOM_PAIRS; i++) {
        const int64_t number = (int64_t)next_random();
        const int64_t small = (int32_t)(next_random() >> 33) - (1 << 30);
        const double scale = random_number();
        if (scale != 0.0) {
            check_scaled(number, scale, 0.0);
            check_scaled(small, scale, 0.0);
            check_scaled(small, scale, -0.0);
            check_scaled(small, scale, random_number());
        }
    }
}

RUN()
