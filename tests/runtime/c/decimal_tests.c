/**
 * @file
 * Decimal numbers, compared with this computer's C library, which rounds correctly.
 */
#include "epg/decimal.h"

#include <float.h>
#include <inttypes.h>

#include "check.h"

static uint64_t random_state = 0x9E3779B97F4A7C15U;

/** xorshift64*, so that a failure can be repeated. */
static uint64_t next_random(void)
{
    random_state ^= random_state >> 12;
    random_state ^= random_state << 25;
    random_state ^= random_state >> 27;
    return random_state * 0x2545F4914F6CDD1DU;
}

static double double_of(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static const char *written(double value)
{
    static char text[EPG_DECIMAL_SIZE + 1];
    memset(text, '#', sizeof text);
    const size_t length = epg_decimal_write(text, value);
    CHECK(length <= EPG_DECIMAL_SIZE);
    CHECK(text[EPG_DECIMAL_SIZE] == '#');
    text[length] = '\0';
    return text;
}

static bool reads(const char *text, double *value)
{
    return epg_decimal_read(text, value);
}

/** Number of digits in the shortest text that the C library reads back as `value`. */
static int least_digits(double value)
{
    char text[32];
    for (int digits = 1; digits < 17; digits++) {
        snprintf(text, sizeof text, "%.*e", digits - 1, value);
        if (strtod(text, NULL) == value) {
            return digits;
        }
    }
    return 17;
}

static int digits_in(const char *text)
{
    int count = 0;
    int zeros = 0;
    for (; *text != '\0' && *text != 'e'; text++) {
        if (*text >= '0' && *text <= '9' && (count > 0 || *text != '0')) {
            zeros = *text == '0' ? zeros + 1 : 0;
            count++;
        }
    }
    return count - zeros;
}

static void check_value(double value)
{
    const char *text = written(value);
    double back = 0.0;
    if (bits_of(strtod(text, NULL)) != bits_of(value) || !reads(text, &back) || bits_of(back) != bits_of(value) ||
        digits_in(text) > least_digits(value)) {
        fprintf(stderr, "%.17g is written as %s, read as %.17g\n", value, text, back);
        exit(1);
    }
}

TEST(numbers_are_written_as_people_write_them)
{
    CHECK(strcmp(written(0.0), "0") == 0);
    CHECK(strcmp(written(-0.0), "-0") == 0);
    CHECK(strcmp(written(1.0), "1") == 0);
    CHECK(strcmp(written(-12.5), "-12.5") == 0);
    CHECK(strcmp(written(0.1), "0.1") == 0);
    CHECK(strcmp(written(0.0001), "0.0001") == 0);
    CHECK(strcmp(written(0.00001), "1e-05") == 0);
    CHECK(strcmp(written(2.5e-7), "2.5e-07") == 0);
    CHECK(strcmp(written(1112.0), "1112") == 0);
    CHECK(strcmp(written(1e16), "10000000000000000") == 0);
    CHECK(strcmp(written(1e17), "1e+17") == 0);
    CHECK(strcmp(written(1e21), "1e+21") == 0);
    CHECK(strcmp(written(3.141592653589793), "3.141592653589793") == 0);
    CHECK(strcmp(written(-2.2250738585072014e-308), "-2.2250738585072014e-308") == 0);
    CHECK(strcmp(written(double_of(0x7FF0000000000000U)), "inf") == 0);
    CHECK(strcmp(written(double_of(0xFFF0000000000000U)), "-inf") == 0);
    CHECK(strcmp(written(double_of(0xFFF8000000000000U)), "nan") == 0);
}

TEST(every_power_of_two_and_ten_is_exact)
{
    for (uint64_t exponent = 0; exponent < 0x7FF; exponent++) {
        check_value(double_of(exponent << 52));
        check_value(double_of(exponent << 52 | 1U));
        check_value(double_of((exponent << 52) + ((uint64_t)1 << 52) - 1U));
    }
    for (int exponent = -323; exponent <= 308; exponent++) {
        char text[16];
        snprintf(text, sizeof text, "1e%d", exponent);
        check_value(strtod(text, NULL));
    }
    for (unsigned int bit = 0; bit < 52; bit++) {
        check_value(double_of((uint64_t)1 << bit));
    }
}

TEST(random_doubles_are_exact)
{
    for (int i = 0; i < 60000; i++) {
        const double value = double_of(next_random());
        if (value - value == 0.0) {
            check_value(value);
        }
    }
}

TEST(ordinary_numbers_are_exact)
{
    for (int i = 0; i < 60000; i++) {
        check_value((double)(int64_t)(next_random() >> 40) / 1000.0 - 8000.0);
    }
}

/** Texts that a user or a program may write, which are not always the shortest. */
TEST(texts_are_read_as_the_c_library_reads_them)
{
    for (int i = 0; i < 60000; i++) {
        char text[64];
        const int digits = 1 + (int)(next_random() % 40U);
        const int point = (int)(next_random() % (unsigned int)(digits + 1));
        int length = 0;
        for (int k = 0; k < digits; k++) {
            if (k == point) {
                text[length++] = '.';
            }
            text[length++] = (char)('0' + (int)(next_random() % 10U));
        }
        snprintf(text + length, sizeof text - (size_t)length, "e%d", (int)(next_random() % 720U) - 380);
        const double expected = strtod(text, NULL);
        double value = 1.0;
        if (reads(text, &value) ? bits_of(value) != bits_of(expected) : expected <= DBL_MAX) {
            fprintf(stderr, "%s is read as %.17g, not %.17g\n", text, value, expected);
            exit(1);
        }
    }
}

TEST(ties_go_to_the_even_neighbour)
{
    double value;
    CHECK(reads("9007199254740993", &value)); /* 2^53 + 1 */
    CHECK_EQUAL(value, 9007199254740992.0);
    CHECK(reads("9007199254740995", &value));
    CHECK_EQUAL(value, 9007199254740996.0);
    CHECK(reads("9007199254740993.0000000000000000001", &value));
    CHECK_EQUAL(value, 9007199254740994.0);
    CHECK(reads("1.7976931348623157e308", &value));
    CHECK_EQUAL(value, DBL_MAX);
    CHECK(!reads("1.7976931348623159e308", &value));
    CHECK(reads("4.9e-324", &value));
    CHECK(bits_of(value) == 1U);
    CHECK(reads("2.4703282292062327e-324", &value));
    CHECK(bits_of(value) == 0U);
    CHECK(reads("2.4703282292062328e-324", &value));
    CHECK(bits_of(value) == 1U);
    CHECK(reads("2.2250738585072011e-308", &value)); /* the largest subnormal number */
    CHECK(bits_of(value) == 0x000FFFFFFFFFFFFFU);
    CHECK(reads("2.2250738585072014e-308", &value));
    CHECK(bits_of(value) == 0x0010000000000000U);
}

TEST(what_is_no_number_is_refused)
{
    static const char *const wrong[] = {"",
                                        "-",
                                        "+",
                                        ".",
                                        "e5",
                                        "1e",
                                        "1e+",
                                        "1.2.3",
                                        " 1",
                                        "1 ",
                                        "0x10",
                                        "nan",
                                        "inf",
                                        "infinity",
                                        "1,5",
                                        "--1",
                                        "1e5.",
                                        "1e--5",
                                        "1f",
                                        "½",
                                        "1e400",
                                        "1e99999999999999999999",
                                        "12345678901234567890123456789012345678901"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        double value = 7.0;
        CHECK(!reads(wrong[i], &value));
    }
}

TEST(other_ways_to_write_a_number)
{
    double value;
    CHECK(reads("+.5", &value));
    CHECK_EQUAL(value, 0.5);
    CHECK(reads("5.", &value));
    CHECK_EQUAL(value, 5.0);
    CHECK(reads("-0", &value));
    CHECK(bits_of(value) == (uint64_t)1 << 63);
    CHECK(reads("1E3", &value));
    CHECK_EQUAL(value, 1000.0);
    CHECK(reads("00000000000000000000000000000000000000000000000000012", &value));
    CHECK_EQUAL(value, 12.0);
    CHECK(reads("0e99999999999999999999", &value));
    CHECK_EQUAL(value, 0.0);
    CHECK(reads("1e-99999999999999999999", &value));
    CHECK_EQUAL(value, 0.0);
}

TEST(whole_numbers_and_times)
{
    char text[EPG_DECIMAL_SIZE + 1];
    text[epg_decimal_write_integer(text, INT64_MIN)] = '\0';
    CHECK(strcmp(text, "-9223372036854775808") == 0);
    text[epg_decimal_write_integer(text, 0)] = '\0';
    CHECK(strcmp(text, "0") == 0);
    text[epg_decimal_write_seconds(text, 1500000000U)] = '\0';
    CHECK(strcmp(text, "1.5") == 0);
    text[epg_decimal_write_seconds(text, 1000000U)] = '\0';
    CHECK(strcmp(text, "0.001") == 0);
    text[epg_decimal_write_seconds(text, 0U)] = '\0';
    CHECK(strcmp(text, "0") == 0);
    text[epg_decimal_write_seconds(text, UINT64_MAX)] = '\0';
    CHECK(strcmp(text, "18446744073.709551615") == 0);
}

RUN()
