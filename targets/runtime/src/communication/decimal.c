/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Conversions between doubles and decimal text, with intermediate numbers of at least 161 bits.
 *
 * 17 decimal digits identify every double (IEEE 754-2019, 5.12.2).  For most numbers that people write, 15 or 16 digits
 * do.  The code therefore takes the first of 15, 16 and 17 digits whose text reads back as the same double.  A text does
 * so if it is nearer to the double than half the distance to the next one.  The first 17 digits and five bits more
 * nearly always tell; otherwise, the code reads the text back.
 *
 * Scaling by a power of ten takes at most 92 steps.  Each step cuts off less than one part in 2^160.  A text of 17
 * digits is nearer to its double than half the distance to the next one; the margin is a tenth of one part in 2^54.
 * This is far more than the error of all steps, so a written number always reads back.
 */
#include "epg/decimal.h"

#include <string.h>

enum {
    WORDS = 6,
    NINE_DIGITS = 9,     /* a power of ten with so many zeros fits into a word, */
    FOUR_DIGITS = 4,     /* and one with so many into half a word */
    FRACTION = 52,       /* bits of the significand after its leading 1 (IEEE 754-2019, table 3.5) */
    LEAST = -1074,       /* binary exponent of the smallest double above zero */
    INFINITE = 0x7FF,    /* biased exponent of infinity and NaN */
    LARGEST_POWER = 310, /* above this decimal exponent, every number is too large for a double */
    LEAST_POWER = -365,  /* below it, EPG_DECIMAL_DIGITS digits give less than half of the smallest double */
    EXACT_DIGITS = 15,   /* a decimal number with so many digits is unchanged after conversion to double and back */
    MOST_DIGITS = 17,    /* a double is unchanged after conversion to so many digits and back */
    FINE = 5             /* bits after the point of 17 digits; 17 digits and these bits are below 2^62 */
};

#define SIGN ((uint64_t)1 << 63)
#define NS_PER_S 1000000000U
#define POWER_9 1000000000U

static size_t put(char *text, size_t length, const char *more)
{
    while (*more != '\0') {
        text[length++] = *more++;
    }
    return length;
}

/** Writes the digits of a whole number to the end of `text`.  Returns the index of the first one. */
static size_t digits_of(char text[20], uint64_t value)
{
    size_t begin = 20;
    do { /* nine digits at a time: a Cortex-M0+ takes ten times as long for a division of 64 bits as for one of 32 */
        uint32_t digits = (uint32_t)(value % POWER_9);
        value /= POWER_9;
        for (int i = 0; i < NINE_DIGITS && (digits != 0 || value != 0); i++) {
            text[--begin] = (char)('0' + (int)(digits % 10U));
            digits /= 10U;
        }
    } while (value != 0);
    if (begin == 20) {
        text[--begin] = '0';
    }
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

/** The number words * 2^exponent, which is above zero.  The least significant word is the first; the last is not 0. */
typedef struct wide {
    uint32_t words[WORDS];
    int exponent;
} wide_t;

/** Shifts the words until the last one is not 0. */
static void fill(wide_t *value)
{
    while (value->words[WORDS - 1] == 0) {
        memmove(&value->words[1], &value->words[0], (WORDS - 1) * sizeof value->words[0]);
        value->words[0] = 0;
        value->exponent -= 32;
    }
}

static wide_t wide(uint64_t value, int exponent)
{
    const uint32_t high = (uint32_t)(value >> 32);
    const uint32_t low = (uint32_t)(value & 0xFFFFFFFFU);
    wide_t result = {{0}, exponent - 32 * (high != 0 ? WORDS - 2 : WORDS - 1)};
    result.words[WORDS - 1] = high != 0 ? high : low;
    result.words[WORDS - 2] = high != 0 ? low : 0U;
    return result;
}

/** Takes the WORDS most significant words, of which the last is not 0.  `words` has one more word at each end. */
static void take_words(wide_t *value, const uint32_t words[WORDS + 2])
{
    size_t first = 2;
    while (words[first + WORDS - 1] == 0) {
        first--;
    }
    memcpy(value->words, &words[first], sizeof value->words);
    value->exponent += 32 * ((int)first - 1);
}

/** value = value * factor; at least 161 bits of the result are kept. */
static void multiply(wide_t *value, uint32_t factor)
{
    uint32_t words[WORDS + 2] = {0};
    uint64_t carry = 0;
    for (size_t i = 0; i < WORDS; i++) {
        carry += (uint64_t)value->words[i] * factor;
        words[i + 1] = (uint32_t)(carry & 0xFFFFFFFFU);
        carry >>= 32;
    }
    words[WORDS + 1] = (uint32_t)carry;
    take_words(value, words);
}

/** value = value / divisor, which must be below 2^16; at least 161 bits of the result are kept. */
static void divide(wide_t *value, uint32_t divisor)
{
    uint32_t words[WORDS + 2] = {0};
    uint32_t rest = 0;
    for (size_t i = WORDS + 1; i > 0; i--) { /* half a word at a time: a division of 64 bits takes much longer */
        const uint32_t word = i > 1 ? value->words[i - 2] : 0U;
        const uint32_t high = rest << 16 | word >> 16;
        const uint32_t low = high % divisor << 16 | (word & 0xFFFFU);
        words[i - 1] = high / divisor << 16 | low / divisor;
        rest = low % divisor;
    }
    take_words(value, words);
}

static uint32_t power_of(int digits)
{
    uint32_t power = 1;
    for (int i = 0; i < digits; i++) {
        power *= 10U;
    }
    return power;
}

/** value = value * 10^power */
static void scale(wide_t *value, int power)
{
    for (int left = power; left > 0; left -= NINE_DIGITS) {
        multiply(value, power_of(left < NINE_DIGITS ? left : NINE_DIGITS));
    }
    for (int left = -power; left > 0; left -= FOUR_DIGITS) {
        divide(value, power_of(left < FOUR_DIGITS ? left : FOUR_DIGITS));
    }
}

static unsigned int bit(const wide_t *value, int place)
{
    return value->words[place / 32] >> (place % 32) & 1U;
}

/** Returns the whole number nearest to value / 2^exponent, which must be below 2^62; a tie goes to the even one. */
static uint64_t rounded(const wide_t *value, int exponent)
{
    const int quarter = exponent - 2 - value->exponent; /* index of the bit with weight 1/4; not negative */
    const int first = quarter / 32;                     /* the word that contains it */
    uint64_t quarters = 0;
    bool more = false;
    for (int i = WORDS - 1; i > first; i--) {
        quarters = quarters << 32 | value->words[i];
    }
    if (first < WORDS) {
        const int shift = quarter % 32;
        quarters = quarters << (32 - shift) | (uint64_t)value->words[first] >> shift;
        more = (value->words[first] & ((1U << shift) - 1U)) != 0;
    }
    for (int i = 0; i < first && i < WORDS; i++) {
        more = more || value->words[i] != 0;
    }
    quarters |= more ? 1U : 0U; /* only a remainder of exactly 2 quarters is a tie */
    return (quarters + 1U + (quarters >> 2 & 1U)) >> 2;
}

/** Returns the bits of the double nearest to a value; SIGN if the value is too large. */
static uint64_t nearest(const wide_t *value)
{
    int top = 32 * WORDS - 1;
    while (bit(value, top) == 0) {
        top--;
    }
    /* The result has 53 bits with its leading 1, or fewer below the smallest normal number. */
    int binary = value->exponent + top - FRACTION;
    if (binary < LEAST) {
        binary = LEAST;
    }
    /* An addition, not an OR: the leading 1 increments the biased exponent, and so does a carry into bit 53. */
    const uint64_t biased = (uint64_t)(binary - LEAST);
    return biased >= INFINITE ? SIGN : (biased << FRACTION) + rounded(value, binary);
}

/** Returns floor(log10(2^exponent)) or one less.  log10(2) is between 1233 / 4096 and 1234 / 4096. */
static int power_of_ten(int exponent)
{
    return exponent >= 0 ? exponent * 1233 / 4096 : -((-exponent * 1234 + 4095) / 4096);
}

/**
 * Returns `count` digits of significand * 2^exponent as a whole number; the value is this number * 10^*power.  `fine`,
 * if it is not NULL, gets the same number with FINE bits after its point.
 */
static uint64_t decimal(uint64_t significand, int exponent, int count, int *power, uint64_t *fine)
{
    const int low = count < NINE_DIGITS ? count : NINE_DIGITS;
    const uint64_t limit = (uint64_t)power_of(low) * power_of(count - low);
    int bits = FRACTION + 1;
    while (significand >> (bits - 1) == 0) {
        bits--;
    }
    *power = power_of_ten(exponent + bits - 1) - count + 1;
    for (;; ++*power) { /* the first estimate may be too small */
        wide_t value = wide(significand, exponent);
        scale(&value, -*power);
        const uint64_t result = rounded(&value, 0);
        if (result < limit) {
            if (fine != NULL) {
                *fine = rounded(&value, -FINE);
            }
            return result;
        }
    }
}

/** Returns the bits of the double nearest to digits * 10^power. */
static uint64_t double_of(uint64_t digits, int power)
{
    wide_t value = wide(digits, 0);
    scale(&value, power);
    return nearest(&value);
}

/**
 * Tells whether a double reads back from fewer digits than 17: a positive number if so, a negative one if not, 0 if only
 * a trial tells.  `fine` is 17 digits with FINE bits after their point; `unit` cuts off the last ones (10 or 100).
 */
static int reads_back(uint64_t fine, uint64_t significand, unsigned int unit)
{
    const uint64_t half = fine / (2U * significand); /* half the distance to the next double, at most 1 too small */
    const unsigned int whole = unit << FINE;
    const unsigned int above = (unsigned int)(fine % whole);
    const unsigned int off = above < whole - above ? above : whole - above; /* distance to the shorter number, +-1 */
    return off + 1U < half ? 1 : off > half + 2U ? -1 : 0;
}

/**
 * Returns digits that read back as the double `bits` (above zero, without sign), and their power of ten.  They are the
 * fewest, except for zeros at their end.
 */
static uint64_t shortest(uint64_t bits, int *power)
{
    const uint64_t fraction = bits & (((uint64_t)1 << FRACTION) - 1U);
    const int biased = (int)(bits >> FRACTION);
    const uint64_t significand = biased == 0 ? fraction : fraction | (uint64_t)1 << FRACTION;
    const int exponent = LEAST + (biased == 0 ? 0 : biased - 1);
    uint64_t fine;
    const uint64_t longest = decimal(significand, exponent, MOST_DIGITS, power, &fine);
    /* A power of two has a nearer neighbour below it than above it. */
    const bool same_distance = biased != 0 && fraction != 0;
    /* The smallest doubles have fewer bits than the others; one digit can be sufficient. */
    for (int count = biased == 0 ? 1 : EXACT_DIGITS; count < MOST_DIGITS; count++) {
        const int known = same_distance ? reads_back(fine, significand, power_of(MOST_DIGITS - count)) : 0;
        if (known >= 0) {
            int shorter;
            const uint64_t result = decimal(significand, exponent, count, &shorter, NULL);
            if (known > 0 || double_of(result, shorter) == bits) {
                *power = shorter;
                return result;
            }
        }
    }
    return longest;
}

/** Writes `digits` with their point, or with an exponent below 1e-4 and from 1e17 on, as C's "%.17g" does. */
static size_t lay_out(char *text, size_t length, const char *digits, size_t count, int point)
{
    const bool scientific = point < -4 || point >= MOST_DIGITS;
    const int whole = scientific ? 1 : point + 1; /* number of digits before the point; negative: zeros after it */
    if (whole <= 0) {
        length = put(text, length, "0.");
    }
    for (int i = whole; i < 0; i++) {
        text[length++] = '0';
    }
    for (int i = 0; i < (int)count || i < whole; i++) {
        if (i == whole && i > 0) {
            text[length++] = '.';
        }
        text[length++] = i < (int)count ? digits[i] : '0';
    }
    if (scientific) {
        const unsigned int size = (unsigned int)(point < 0 ? -point : point);
        length = put(text, length, point < 0 ? "e-" : "e+");
        length = put(text, length, size < 10 ? "0" : "");
        length = put_whole(text, length, size);
    }
    return length;
}

size_t epg_decimal_write(char *text, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint64_t size = bits & ~SIGN;
    const uint64_t infinity = (uint64_t)INFINITE << FRACTION;
    size_t length = 0;
    if (size > infinity) {
        return put(text, length, "nan");
    }
    if (size != bits) {
        text[length++] = '-';
    }
    if (size == infinity) {
        return put(text, length, "inf");
    }
    if (size == 0) {
        return put(text, length, "0");
    }
    char digits[20];
    int power = 0;
    const size_t begin = digits_of(digits, shortest(size, &power));
    size_t count = sizeof digits - begin;
    const int point = power + (int)count - 1;
    while (digits[begin + count - 1] == '0') {
        count--;
    }
    return lay_out(text, length, digits + begin, count, point);
}

size_t epg_decimal_write_seconds(char *text, uint64_t time_ns)
{
    size_t length = put_whole(text, 0, time_ns / NS_PER_S);
    uint64_t rest = time_ns % NS_PER_S;
    if (rest != 0) {
        text[length++] = '.';
    }
    for (; rest != 0; rest = rest * 10U % NS_PER_S) {
        text[length++] = (char)('0' + (int)(rest * 10U / NS_PER_S));
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

/** Skips a sign.  Returns true if it is a minus. */
static bool read_sign(const char **text)
{
    const bool negative = **text == '-';
    *text += negative || **text == '+' ? 1 : 0;
    return negative;
}

static bool is_digit(char character)
{
    return character >= '0' && character <= '9';
}

/** Adds the exponent after an "e" to `*exponent`.  Returns false if it is malformed.  It is limited to +-9999. */
static bool read_exponent(const char *text, int *exponent)
{
    const bool negative = read_sign(&text);
    const bool any = is_digit(*text);
    int size = 0;
    for (; is_digit(*text); text++) {
        size = size * 10 + (*text - '0');
        size = size > 9999 ? 9999 : size;
    }
    *exponent += negative ? -size : size;
    return any && *text == '\0';
}

/** Reads a number without its sign, words * 10^power.  Returns false if it is malformed or has too many digits. */
static bool read_number(const char *text, uint32_t words[WORDS], int *power)
{
    size_t significant = 0;
    bool any = false;
    bool point = false;
    for (; is_digit(*text) || (*text == '.' && !point); text++) {
        if (*text == '.') {
            point = true;
            continue;
        }
        any = true;
        significant += significant > 0 || *text != '0' ? 1U : 0U;
        if (significant > EPG_DECIMAL_DIGITS) {
            return false;
        }
        uint64_t carry = (uint64_t)(*text - '0');
        for (size_t i = 0; i < WORDS; i++) {
            carry += (uint64_t)words[i] * 10U;
            words[i] = (uint32_t)(carry & 0xFFFFFFFFU);
            carry >>= 32;
        }
        *power -= point ? 1 : 0;
    }
    if (*text == 'e' || *text == 'E') {
        return any && read_exponent(text + 1, power);
    }
    return any && *text == '\0';
}

bool epg_decimal_read(const char *text, double *value)
{
    const bool negative = read_sign(&text);
    wide_t number = {{0}, 0};
    int power = 0;
    uint64_t bits = 0;
    if (!read_number(text, number.words, &power)) {
        return false;
    }
    bool zero = true;
    for (size_t i = 0; i < WORDS; i++) {
        zero = zero && number.words[i] == 0;
    }
    if (!zero && power > LARGEST_POWER) {
        return false;
    }
    if (!zero && power >= LEAST_POWER) {
        fill(&number);
        scale(&number, power);
        bits = nearest(&number);
    }
    if (bits >= (uint64_t)INFINITE << FRACTION) {
        return false;
    }
    bits |= negative ? SIGN : 0U;
    memcpy(value, &bits, sizeof bits);
    return true;
}
