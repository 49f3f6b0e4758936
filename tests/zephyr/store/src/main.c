/*
 * Copyright (c) The EPG contributors
 *
 * SPDX-License-Identifier: Apache-2.0
 */

/**
 * @file
 * @brief The store: after a power failure at any time, the data are all new or all old
 */

#include <string.h>

#include <zephyr/stats/stats.h>
#include <zephyr/storage/flash_map.h>
#include <zephyr/ztest.h>

#include "epg/port.h"

/* Numbers of the store's pages, and a size that does not fit in one page. */
#define PAGE     4096U
#define TOO_LONG PAGE

static bool refuse_hold;
static unsigned int holds;
static unsigned int releases;

/* Replaces the function of the control thread, which does not run here. */
bool epg_zephyr_control_hold(void)
{
	holds++;
	return !refuse_hold;
}

void epg_zephyr_control_release(void)
{
	releases++;
}

static uint8_t data[TOO_LONG];
static uint8_t found[TOO_LONG];

/* Fills with bytes that differ for each seed. */
static void fill(uint32_t seed, size_t size)
{
	for (size_t i = 0; i < size; i++) {
		data[i] = (uint8_t)((seed * 31U) + (i * 7U) + (i >> 8));
	}
}

static bool store(uint32_t seed, size_t size)
{
	fill(seed, size);
	return epg_port_store_write(data, size) == NULL;
}

static bool holds_what_was_stored(uint32_t seed, size_t size)
{
	fill(seed, size);
	memset(found, 0x55, sizeof(found));
	return epg_port_store_read(found, sizeof(found)) == size && memcmp(found, data, size) == 0;
}

static int find_counter(struct stats_hdr *header, void *argument, const char *name, uint16_t offset)
{
	const char **wanted = argument;

	if (strcmp(name, wanted[0]) == 0) {
		wanted[1] = (const char *)header + offset;
	}

	return 0;
}

static uint32_t *counter(const char *group, const char *name)
{
	const char *wanted[2] = {name, NULL};
	struct stats_hdr *header = stats_group_find(group);

	zassert_not_null(header);
	stats_walk(header, find_counter, wanted);
	zassert_not_null(wanted[1]);

	return (uint32_t *)wanted[1];
}

/* From now on, only `writes` more writes reach the flash. */
static void let_power_fail_after(uint32_t writes)
{
	const uint32_t done = *counter("flash_sim_stats", "flash_write_calls");

	*counter("flash_sim_thresholds", "max_write_calls") = done + writes + 1U;
}

static void restore_power(void)
{
	*counter("flash_sim_thresholds", "max_write_calls") = 0;
}

static void before(void *fixture)
{
	const struct flash_area *area;

	ARG_UNUSED(fixture);
	restore_power();
	refuse_hold = false;
	holds = 0;
	releases = 0;
	zassert_ok(flash_area_open(FIXED_PARTITION_ID(storage_partition), &area));
	zassert_ok(flash_area_erase(area, 0, area->fa_size));
	flash_area_close(area);
}

ZTEST(epg_store, test_nothing_is_stored_at_first)
{
	zassert_equal(epg_port_store_read(found, sizeof(found)), 0);
}

ZTEST(epg_store, test_the_newest_counts)
{
	for (uint32_t seed = 1; seed < 200; seed++) {
		const size_t size = 1U + ((seed * 37U) % 700U);

		zassert_true(store(seed, size), "write %u of %zu bytes", seed, size);
		zassert_true(holds_what_was_stored(seed, size), "write %u of %zu bytes", seed, size);
	}
}

ZTEST(epg_store, test_a_part_can_be_read)
{
	zassert_true(store(1, 100));
	fill(1, 100);
	zassert_equal(epg_port_store_read(found, 10), 10);
	zassert_mem_equal(found, data, 10);
}

ZTEST(epg_store, test_what_is_too_long_is_refused)
{
	zassert_true(store(1, 100));
	zassert_false(store(2, TOO_LONG));
	zassert_true(holds_what_was_stored(1, 100));
}

ZTEST(epg_store, test_the_control_loop_is_held)
{
	zassert_true(store(1, 100));
	zassert_equal(holds, 1);
	zassert_equal(releases, 1);

	refuse_hold = true;
	zassert_false(store(2, 100));
	zassert_equal(releases, 1);
	zassert_true(holds_what_was_stored(1, 100));
}

/* The power fails after each write of each record, over several changes of pages. */
ZTEST(epg_store, test_the_power_may_fail_at_any_write)
{
	const size_t size = 500;
	uint32_t kept = 1;
	uint32_t lost = 0;
	uint32_t later = 0;

	zassert_true(store(kept, size));
	for (uint32_t seed = 2; seed < 400; seed++) {
		let_power_fail_after(seed % 200U);
		const bool written = store(seed, size);

		restore_power();
		if (holds_what_was_stored(seed, size)) {
			kept = seed;
			later++;
		} else {
			zassert_false(written, "write %u", seed);
			lost++;
		}
		zassert_true(holds_what_was_stored(kept, size), "write %u", seed);
		zassert_true(store(seed + 1000U, size), "after write %u", seed);
		kept = seed + 1000U;
		zassert_true(holds_what_was_stored(kept, size), "after write %u", seed);
	}
	zexpect_true(lost > 100, "%u were lost", lost);
	zexpect_true(later > 20, "%u were kept", later);
}

ZTEST_SUITE(epg_store, NULL, NULL, before, NULL, NULL);
