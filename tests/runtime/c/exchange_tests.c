/**
 * @file
 * The exchange in one thread: the values that a read gets after a write.  Two threads: stress.c and exchange.pml.
 */
#include <limits.h>

#include "check.h"
#include "epg/exchange.h"

typedef struct value {
    uint32_t number;
    char text[11]; /* an odd size on purpose */
} value_t;

static value_t buffers[4];
static epg_exchange_t exchange = EPG_EXCHANGE(buffers);

static void write_number(uint32_t number)
{
    value_t value = {.number = number};
    snprintf(value.text, sizeof value.text, "%u", number);
    epg_exchange_write(&exchange, &value);
}

static bool holds(uint32_t number)
{
    value_t value;
    char text[11];
    snprintf(text, sizeof text, "%u", number);
    return epg_exchange_read(&exchange, &value) && value.number == number && strcmp(value.text, text) == 0;
}

TEST(empty_until_the_first_write)
{
    value_t value = {.number = 77};
    CHECK(!epg_exchange_read(&exchange, &value));
    CHECK(value.number == 77);
    write_number(1);
    CHECK(holds(1));
}

TEST(every_pattern_of_reads_and_writes_gives_the_newest)
{
    for (uint32_t pattern = 0; pattern < 4096; pattern++) {
        epg_exchange_clear(&exchange);
        uint32_t newest = 0;
        for (uint32_t bit = 0; bit < 12; bit++) {
            if ((pattern >> bit & 1U) != 0) {
                write_number(++newest);
            } else if (newest > 0) {
                CHECK(holds(newest));
            }
        }
    }
}

TEST(a_value_may_be_read_again)
{
    write_number(5);
    CHECK(holds(5));
    CHECK(holds(5));
}

TEST(a_value_is_taken_once)
{
    value_t value = {.number = 77};
    CHECK(!epg_exchange_take(&exchange, &value));
    CHECK(value.number == 77);
    write_number(5);
    CHECK(epg_exchange_take(&exchange, &value) && value.number == 5);
    value.number = 77;
    CHECK(!epg_exchange_take(&exchange, &value));
    CHECK(value.number == 77);
    CHECK(holds(5)); /* a read is independent of a take */
    write_number(6);
    write_number(7);
    CHECK(epg_exchange_take(&exchange, &value) && value.number == 7);
    CHECK(!epg_exchange_take(&exchange, &value));
}

TEST(the_count_of_writes_may_wrap)
{
    value_t value;
    write_number(1);
    CHECK(epg_exchange_take(&exchange, &value));
    atomic_store(&exchange.writes, UINT_MAX);
    CHECK(epg_exchange_take(&exchange, &value));
    write_number(2);
    CHECK(epg_exchange_take(&exchange, &value) && value.number == 2);
    CHECK(holds(2));
}

TEST(cleared_is_empty)
{
    write_number(5);
    CHECK(holds(5));
    epg_exchange_clear(&exchange);
    value_t value;
    CHECK(!epg_exchange_read(&exchange, &value));
    CHECK(!epg_exchange_take(&exchange, &value));
}

RUN()
