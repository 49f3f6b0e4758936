/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Doubles to text and back, by exact arithmetic on large whole numbers.
 *
 * Writing is the free-format algorithm of G. Steele and J. White, "How to print floating-point numbers accurately",
 * PLDI 1990, with the scaling of R. Burger and R. Dybvig, "Printing floating-point numbers quickly and accurately",
 * PLDI 1996.  Reading divides two whole numbers until the quotient has the bits of a double and one more.
 */
#include "epg/decimal.h"

#include <string.h>

#include "big.h"

enum {
    FRACTION = 52,       /* bits of the significand behind its leading 1 (IEEE 754-2019, table 3.5) */
    LEAST = -1074,       /* binary exponent of the smallest double above zero */
    INFINITE = 0x7FF,    /* biased exponent */
    LARGEST_POWER = 310, /* a decimal exponent above it makes any number too large for a double, */
    LEAST_POWER = -365   /* and one below it less than half of the smallest, with EPG_DECIMAL_DIGITS digits */
};

#define SIGN ((uint64_t)1 << 63)

static size_t put(char *text, size_t length, const char *more)
{
    while (*more != '\0') {
        text[length++] = *more++;
    }
    return length;
}

/** Digits of a whole number at the end of `text`'s first 20 places; returns where they begin. */
static size_t digits_of(char text[20], uint64_t value)
{
    size_t begin = 20;
    do {
        text[--begin] = (char)('0' + (int)(value % 10U));
        value /= 10U;
    } while (value != 0);
    return begin;
}

static size_t put_whole(char *text, size_t length, uint64_t value)
{
    char digits[20];
    for (size_t i = digits_of(digits, value); i < sizeof digits; i++) {
        text[length++] = digits[i];
    }
    return length;
}

/** floor(log10(2^exponent)), or one less: log10(2) lies between 1233 / 4096 and 1234 / 4096. */
static int power_of_ten(int exponent)
{
    return exponent >= 0 ? exponent * 1233 / 4096 : -((-exponent * 1234 + 4095) / 4096);
}

/**
 * The shortest digits of significand * 2^exponent; `*point` is the decimal exponent of the first.  Returns how many.
 * value = r / s, and the doubles beside it are (r + plus) / s and (r - minus) / s, all times 2.
 */
static size_t shortest(char digits[17], uint64_t significand, int exponent, bool narrow, int *point)
{
    epg_big_t r, s, plus, minus;
    const bool even = (significand & 1U) == 0; /* then the limits themselves still read as this double */
    epg_big_set(&r, significand);
    epg_big_set(&s, 1);
    epg_big_set(&plus, 1);
    epg_big_set(&minus, 1);
    epg_big_shift(&r, (narrow ? 2U : 1U) + (exponent > 0 ? (unsigned int)exponent : 0U));
    epg_big_shift(&s, (narrow ? 2U : 1U) + (exponent < 0 ? (unsigned int)-exponent : 0U));
    epg_big_shift(&plus, (narrow ? 1U : 0U) + (exponent > 0 ? (unsigned int)exponent : 0U));
    epg_big_shift(&minus, exponent > 0 ? (unsigned int)exponent : 0U);

    unsigned int bits = 0;
    for (uint64_t rest = significand; rest != 0; rest >>= 1) {
        bits++;
    }
    int k = power_of_ten(exponent + (int)bits - 1);
    if (k >= 0) {
        epg_big_scale(&s, (unsigned int)k);
    } else {
        epg_big_scale(&r, (unsigned int)-k);
        epg_big_scale(&plus, (unsigned int)-k);
        epg_big_scale(&minus, (unsigned int)-k);
    }
    /* Is the value, or what rounds to it, at least 10^(k + 1)?  The estimate may be too small. */
    for (;;) {
        epg_big_t upper = r;
        epg_big_t ten = s;
        epg_big_add(&upper, &plus);
        epg_big_multiply(&ten, 10, 0);
        const int compared = epg_big_compare(&upper, &ten);
        if (compared < 0 || (compared == 0 && !even)) {
            break;
        }
        s = ten;
        k++;
    }

    size_t count = 0;
    for (;;) {
        unsigned int digit = 0;
        while (epg_big_compare(&r, &s) >= 0) {
            epg_big_subtract(&r, &s);
            digit++;
        }
        epg_big_t upper = r;
        epg_big_add(&upper, &plus);
        const int below = epg_big_compare(&r, &minus);
        const int above = epg_big_compare(&upper, &s);
        const bool low = below < 0 || (below == 0 && even);
        const bool high = above > 0 || (above == 0 && even);
        if (low || high) {
            epg_big_t twice = r;
            epg_big_multiply(&twice, 2, 0);
            const int half = epg_big_compare(&twice, &s);
            const bool up = high && (!low || half > 0 || (half == 0 && (digit & 1U) != 0));
            digits[count++] = (char)('0' + (int)digit + (up ? 1 : 0));
            break;
        }
        digits[count++] = (char)('0' + (int)digit);
        epg_big_multiply(&r, 10, 0);
        epg_big_multiply(&plus, 10, 0);
        epg_big_multiply(&minus, 10, 0);
    }
    *point = k;
    return count;
}

/** `digits` with the point where it belongs; with an exponent below 1e-4 and from 1e17 on, as C's "%.17g". */
static size_t lay_out(char *text, size_t length, const char *digits, size_t count, int point)
{
    if (point < -4 || point >= 17) {
        const unsigned int size = (unsigned int)(point < 0 ? -point : point);
        text[length++] = digits[0];
        if (count > 1) {
            text[length++] = '.';
        }
        for (size_t i = 1; i < count; i++) {
            text[length++] = digits[i];
        }
        text[length++] = 'e';
        text[length++] = point < 0 ? '-' : '+';
        if (size < 10) {
            text[length++] = '0';
        }
        return put_whole(text, length, size);
    }
    if (point < 0) {
        length = put(text, length, "0.");
        for (int i = -1; i > point; i--) {
            text[length++] = '0';
        }
    }
    for (size_t i = 0; i < count || (int)i <= point; i++) {
        if (point >= 0 && (int)i == point + 1) {
            text[length++] = '.';
        }
        text[length++] = i < count ? digits[i] : '0';
    }
    return length;
}

size_t epg_decimal_write(char *text, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint64_t fraction = bits & (((uint64_t)1 << FRACTION) - 1U);
    const unsigned int biased = (unsigned int)(bits >> FRACTION) & INFINITE;
    size_t length = 0;
    if (biased == INFINITE && fraction != 0) {
        return put(text, length, "nan");
    }
    if (bits >> 63 != 0) {
        text[length++] = '-';
    }
    if (biased == INFINITE) {
        return put(text, length, "inf");
    }
    if (biased == 0 && fraction == 0) {
        return put(text, length, "0");
    }
    const uint64_t significand = biased == 0 ? fraction : fraction | (uint64_t)1 << FRACTION;
    const int exponent = LEAST + (biased == 0 ? 0 : (int)biased - 1);
    /* The next double below a power of two is half as far away as the next above. */
    const bool narrow = fraction == 0 && biased > 1;
    char digits[17];
    int point = 0;
    const size_t count = shortest(digits, significand, exponent, narrow, &point);
    return lay_out(text, length, digits, count, point);
}

size_t epg_decimal_write_seconds(char *text, uint64_t time_ns)
{
    size_t length = put_whole(text, 0, time_ns / 1000000000U);
    const uint64_t rest = time_ns % 1000000000U;
    if (rest != 0) {
        char digits[20];
        digits_of(digits, 1000000000U + rest); /* a 1, and all nine places */
        size_t end = sizeof digits;
        while (digits[end - 1] == '0') {
            end--;
        }
        text[length++] = '.';
        for (size_t i = sizeof digits - 9; i < end; i++) {
            text[length++] = digits[i];
        }
    }
    return length;
}

size_t epg_decimal_write_integer(char *text, int64_t value)
{
    size_t length = 0;
    if (value < 0) {
        text[length++] = '-';
    }
    return put_whole(text, length, value < 0 ? 0U - (uint64_t)value : (uint64_t)value);
}

/** What a text says: digits without point, and the power of ten they are multiplied with. */
typedef struct number {
    epg_big_t digits;
    bool negative;
    int exponent;
} number_t;

/** Reads an exponent behind its "e"; false if it is none.  One beyond +-9999 is cut to that. */
static bool read_exponent(const char *text, size_t length, int *exponent)
{
    size_t i = 0;
    const bool negative = length > 0 && text[0] == '-';
    if (length > 0 && (text[0] == '-' || text[0] == '+')) {
        i++;
    }
    if (i == length) {
        return false;
    }
    int size = 0;
    for (; i < length; i++) {
        if (text[i] < '0' || text[i] > '9') {
            return false;
        }
        size = size * 10 + (text[i] - '0');
        size = size > 9999 ? 9999 : size;
    }
    *exponent += negative ? -size : size;
    return true;
}

static bool read_number(const char *text, size_t length, number_t *number)
{
    size_t i = 0;
    size_t significant = 0;
    bool any = false;
    bool point = false;
    *number = (number_t){0};
    number->negative = length > 0 && text[0] == '-';
    if (length > 0 && (text[0] == '-' || text[0] == '+')) {
        i++;
    }
    for (; i < length; i++) {
        if (text[i] == '.' && !point) {
            point = true;
        } else if (text[i] >= '0' && text[i] <= '9') {
            any = true;
            significant += significant > 0 || text[i] != '0' ? 1U : 0U;
            if (significant > EPG_DECIMAL_DIGITS) {
                return false;
            }
            epg_big_multiply(&number->digits, 10, (uint32_t)(text[i] - '0'));
            number->exponent -= point ? 1 : 0;
        } else {
            return any && (text[i] == 'e' || text[i] == 'E') &&
                   read_exponent(text + i + 1, length - i - 1, &number->exponent);
        }
    }
    return any;
}

/** round(a / b), half to even, where the result is below 2^54; changes both. */
static uint64_t quotient(epg_big_t *a, epg_big_t *b)
{
    const unsigned int a_bits = epg_big_bits(a);
    const unsigned int b_bits = epg_big_bits(b);
    uint64_t result = 0;
    for (unsigned int step = a_bits >= b_bits ? a_bits - b_bits + 1U : 0U; step > 0; step--) {
        epg_big_t moved = *b;
        epg_big_shift(&moved, step - 1U);
        result <<= 1;
        if (epg_big_compare(a, &moved) >= 0) {
            epg_big_subtract(a, &moved);
            result |= 1U;
        }
    }
    epg_big_shift(a, 1);
    const int half = epg_big_compare(a, b);
    return half > 0 || (half == 0 && (result & 1U) != 0) ? result + 1U : result;
}

/** Bits of the double nearest to digits * 10^exponent, all above zero; SIGN or more if it is too large for one. */
static uint64_t nearest(epg_big_t *digits, int exponent)
{
    epg_big_t divisor;
    epg_big_set(&divisor, 1);
    epg_big_scale(exponent < 0 ? &divisor : digits, (unsigned int)(exponent < 0 ? -exponent : exponent));

    /* The quotient is to have 53 bits, one for the leading 1; fewer below the smallest normal number. */
    int binary = (int)epg_big_bits(digits) - (int)epg_big_bits(&divisor) - (FRACTION + 1);
    if (binary < LEAST) {
        binary = LEAST;
    }
    if (binary < 0) {
        epg_big_shift(digits, (unsigned int)-binary);
    } else {
        epg_big_shift(&divisor, (unsigned int)binary);
    }
    epg_big_t limit = divisor;
    epg_big_shift(&limit, FRACTION + 1);
    if (epg_big_compare(digits, &limit) >= 0) {
        epg_big_shift(&divisor, 1);
        binary++;
    }
    const uint64_t significand = quotient(digits, &divisor);
    /* Added, not put together: the leading 1 makes the biased exponent one more, and so does a carry into bit 53. */
    const uint64_t biased = (uint64_t)(binary - LEAST);
    return biased >= INFINITE ? SIGN : (biased << FRACTION) + significand;
}

bool epg_decimal_read(const char *text, size_t length, double *value)
{
    number_t number;
    uint64_t bits = 0;
    if (!read_number(text, length, &number)) {
        return false;
    }
    if (number.digits.used > 0 && number.exponent > LARGEST_POWER) {
        return false;
    }
    if (number.digits.used > 0 && number.exponent >= LEAST_POWER) {
        bits = nearest(&number.digits, number.exponent);
    }
    if (bits >= (uint64_t)INFINITE << FRACTION) {
        return false;
    }
    bits |= number.negative ? SIGN : 0U;
    memcpy(value, &bits, sizeof bits);
    return true;
}
