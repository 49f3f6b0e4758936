/**
 * @file
 * Names of a node: the rules of ROS 2, and the names that a board stores.
 */
#include "epg/names.h"

#include "check.h"
#include "epg/store.h"
#include "fake_port.h"

static unsigned char bytes[EPG_STORE_SIZE(0)];
static epg_store_t store;
static epg_target_t target;

static void restart(void)
{
    store = (epg_store_t){.bytes = bytes};
    target = (epg_target_t){.node = "generated", .name_space = "", .store = &store};
    epg_store_load(&store);
}

static void begin(void)
{
    fake_port_reset();
    restart();
}

static void save(void)
{
    size_t values = 99;
    CHECK(epg_store_save(&store, &values) == NULL);
    CHECK_EQUAL(values, 0);
}

TEST(the_serial_number_stands_where_it_is_named)
{
    char name[64];
    CHECK(epg_names_expand("robot_$serial", name, sizeof name));
    CHECK(strcmp(name, "robot_E6616407E3A51B2C") == 0);
    CHECK(epg_names_expand("$serials$", name, sizeof name));
    CHECK(strcmp(name, "E6616407E3A51B2Cs$") == 0);
    CHECK(!epg_names_expand("robot_$serial", name, 10));
    CHECK(strcmp(name, "robot_E66") == 0);
    CHECK(epg_names_expand("123456789", name, 10));
}

TEST(names_of_nodes)
{
    static const char *const good[] = {"a", "_", "robot_$serial", "r1", "JIWY_node", "a$serial$serial_1"};
    static const char *const bad[] = {"",    "1a",  "a b",   "a-b", "$serial",  "a$",       "/a",
                                      "a/b", "a.b", "a$ser", "a\n", "\xc3\xa4", "a$$serial"};
    char longest[65] = {0};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        CHECK(epg_names_is_node(good[i]));
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CHECK(!epg_names_is_node(bad[i]));
    }
    memset(longest, 'n', 64);
    CHECK(!epg_names_is_node(longest));
    longest[63] = '\0';
    CHECK(epg_names_is_node(longest));
    memcpy(longest + 47, "$serial", 8); /* 63 characters with the serial number */
    CHECK(epg_names_is_node(longest));
    memcpy(longest + 48, "$serial", 8);
    longest[47] = 'n';
    CHECK(!epg_names_is_node(longest));
}

TEST(namespaces)
{
    static const char *const good[] = {"/", "/a", "/fleet/robot_$serial", "/a/b/c"};
    static const char *const bad[] = {"", "a", "//", "/a/", "/a//b", "/1", "/a__b", "/$serial", "/a b", "/a/$serial_b"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        CHECK(epg_names_is_space(good[i]));
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CHECK(!epg_names_is_space(bad[i]));
    }
}

TEST(names_are_as_generated_until_they_are_set)
{
    begin();
    CHECK(strcmp(epg_names_node(&target), "generated") == 0);
    CHECK(strcmp(epg_names_space(&target), "") == 0);
    CHECK(epg_names_set_node(&target, "other") && epg_names_set_space(&target, "/fleet"));
    CHECK(strcmp(epg_names_node(&target), "other") == 0);
    CHECK(strcmp(epg_names_space(&target), "/fleet") == 0);
    CHECK(!epg_names_set_node(&target, "1") && !epg_names_set_space(&target, "fleet"));
    CHECK(strcmp(epg_names_node(&target), "other") == 0);
    restart(); /* not saved */
    CHECK(strcmp(epg_names_node(&target), "generated") == 0);
}

TEST(names_that_are_saved_are_back_after_a_restart)
{
    begin();
    CHECK(epg_names_set_node(&target, "other_$serial") && epg_names_set_space(&target, "/fleet"));
    save();
    restart();
    CHECK(strcmp(epg_names_node(&target), "other_$serial") == 0);
    CHECK(strcmp(epg_names_space(&target), "/fleet") == 0);
    CHECK(epg_names_set_node(&target, "generated") && epg_names_set_space(&target, "/"));
    save();
    restart();
    target.node = "renamed"; /* by new firmware: no other name was set */
    target.name_space = "/new";
    CHECK(strcmp(epg_names_node(&target), "renamed") == 0);
    CHECK(strcmp(epg_names_space(&target), "/new") == 0);
    CHECK(epg_names_set_space(&target, "/"));
    save();
    restart();
    target.name_space = "/new";
    CHECK(strcmp(epg_names_space(&target), "") == 0);
}

static void set_parameters(const double *values, const bool *which)
{
    (void)values;
    (void)which;
}

TEST(names_outlive_the_model)
{
    static const epg_parameter_t table[2] = {{"a", "", 1.0}, {"b", "", 2.0}};
    static double values[2];
    static double applied[2];
    static bool wanted[2];
    static bool changed[2];
    static unsigned char more[EPG_STORE_SIZE(2)];
    epg_parameters_t parameters = {.count = 2,
                                   .table = table,
                                   .model = 5,
                                   .set = set_parameters,
                                   .values = values,
                                   .wanted = wanted,
                                   .applied = applied,
                                   .changed = changed};
    size_t count;
    begin();
    store = (epg_store_t){.bytes = more, .parameters = &parameters};
    epg_store_load(&store);
    CHECK(epg_names_set_node(&target, "kept"));
    values[0] = 3.0;
    values[1] = 4.0;
    CHECK(epg_store_save(&store, &count) == NULL);
    CHECK_EQUAL(count, 2);
    restart(); /* firmware without parameters, which must not read beyond its own store */
    CHECK(strcmp(epg_names_node(&target), "kept") == 0);
    parameters.model = 6;
    store = (epg_store_t){.bytes = more, .parameters = &parameters};
    epg_store_load(&store);
    CHECK(parameters.stored == EPG_STORED_FOR_OTHER);
    CHECK_EQUAL(values[0], 1.0);
    CHECK(strcmp(epg_names_node(&target), "kept") == 0);
}

TEST(damaged_names_are_none)
{
    begin();
    CHECK(epg_names_set_node(&target, "other") && epg_names_set_space(&target, "/fleet"));
    save();
    for (size_t bit = 0; bit < 140U * 8U; bit++) {
        fake_port.store[bit / 8U] ^= (unsigned char)(1U << bit % 8U);
        restart();
        CHECK(store.node[0] == '\0' && store.name_space[0] == '\0');
        fake_port.store[bit / 8U] ^= (unsigned char)(1U << bit % 8U);
    }
    for (size_t size = 0; size < 140U; size++) {
        fake_port.store_size = size;
        restart();
        CHECK(store.node[0] == '\0');
    }
}

TEST(without_a_store_nothing_can_be_set)
{
    begin();
    target.store = NULL;
    CHECK(!epg_names_set_node(&target, "other") && !epg_names_set_space(&target, "/fleet"));
    CHECK(strcmp(epg_names_node(&target), "generated") == 0);
}

RUN()
