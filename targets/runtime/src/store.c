/**
 * @file
 * Parameters that outlive a restart.
 *
 * | bytes | what                                                              |
 * |-------|-------------------------------------------------------------------|
 * | 4     | "EPGP"                                                            |
 * | 4     | version of this layout, 1                                         |
 * | 8     | the model                                                         |
 * | 4     | number of values                                                  |
 * | 12    | for each: index (4), value (8, IEEE 754 binary64)                 |
 * | 4     | CRC-32 of everything before it (IEEE 802.3, reflected)            |
 *
 * Numbers are little-endian, so that a store reads the same wherever it was written.
 */
#include <string.h>

#include "epg/finite.h"
#include "epg/parameters.h"
#include "epg/port.h"

enum { HEADER = 20, ENTRY = 12, CHECK = 4, VERSION = 1 };

static const uint32_t MAGIC = 0x50475045U; /* "EPGP" */

static void put(unsigned char *bytes, uint64_t value, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        bytes[i] = (unsigned char)(value >> (8U * i) & 0xFFU);
    }
}

static uint64_t get(const unsigned char *bytes, size_t size)
{
    uint64_t value = 0;
    for (size_t i = size; i > 0; i--) {
        value = value << 8 | bytes[i - 1];
    }
    return value;
}

static double get_value(const unsigned char *bytes)
{
    const uint64_t bits = get(bytes, sizeof bits);
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

/** Without a table: a store is some hundred bytes, and written by hand. */
static uint32_t crc32(const unsigned char *bytes, size_t size)
{
    uint32_t crc = 0xFFFFFFFFU;
    for (size_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 1U) != 0U ? crc >> 1 ^ 0xEDB88320U : crc >> 1;
        }
    }
    return ~crc;
}

/** Number of values in a store that is whole, of whatever model; SIZE_MAX for any other. */
static size_t whole(const epg_parameters_t *parameters, size_t size)
{
    const unsigned char *store = parameters->store;
    if (size < HEADER + CHECK || get(store, 4) != MAGIC || get(store + 4, 4) != VERSION) {
        return SIZE_MAX;
    }
    const size_t count = (size_t)get(store + 16, 4);
    if (count > (size - HEADER - CHECK) / ENTRY) {
        return SIZE_MAX;
    }
    const size_t checked = HEADER + count * ENTRY;
    return get(store + checked, CHECK) == crc32(store, checked) ? count : SIZE_MAX;
}

/** True when every entry names a parameter and has a finite value. */
static bool sound(const epg_parameters_t *parameters, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const unsigned char *entry = parameters->store + HEADER + i * ENTRY;
        if (get(entry, 4) >= parameters->count || !epg_is_finite(get_value(entry + 4))) {
            return false;
        }
    }
    return true;
}

/** Reads the store; `*count` values of it are right if it belongs to this model. */
static epg_parameters_stored_t read_store(const epg_parameters_t *parameters, size_t *count)
{
    const size_t room = EPG_PARAMETERS_STORE_SIZE(parameters->count);
    const size_t size = epg_port_store_read(parameters->store, room);
    if (size < HEADER || get(parameters->store, 4) != MAGIC) {
        return EPG_STORED_NOTHING;
    }
    if (get(parameters->store + 8, 8) != parameters->model) {
        return EPG_STORED_FOR_OTHER;
    }
    *count = whole(parameters, size);
    return *count != SIZE_MAX && sound(parameters, *count) ? EPG_STORED_LOADED : EPG_STORED_NOTHING;
}

void epg_parameters_load(epg_parameters_t *parameters)
{
    size_t count = 0;
    epg_handover_clear(&parameters->handover);
    for (size_t i = 0; i < parameters->count; i++) {
        parameters->values[i] = parameters->table[i].value;
        parameters->changed[i] = false;
    }
    parameters->stored = read_store(parameters, &count);
    for (size_t i = 0; i < count && parameters->stored == EPG_STORED_LOADED; i++) {
        const unsigned char *entry = parameters->store + HEADER + i * ENTRY;
        const size_t index = (size_t)get(entry, 4);
        parameters->values[index] = get_value(entry + 4);
        parameters->applied[index] = parameters->values[index];
        parameters->changed[index] = true;
    }
}

bool epg_parameters_save(epg_parameters_t *parameters, size_t *stored)
{
    unsigned char *store = parameters->store;
    size_t count = 0;
    for (size_t i = 0; i < parameters->count; i++) {
        if (bits_of(parameters->values[i]) != bits_of(parameters->table[i].value)) {
            unsigned char *entry = store + HEADER + count * ENTRY;
            put(entry, i, 4);
            put(entry + 4, bits_of(parameters->values[i]), 8);
            count++;
        }
    }
    put(store, MAGIC, 4);
    put(store + 4, VERSION, 4);
    put(store + 8, parameters->model, 8);
    put(store + 16, count, 4);
    const size_t checked = HEADER + count * ENTRY;
    put(store + checked, crc32(store, checked), CHECK);
    *stored = count;
    return epg_port_store_write(store, checked + CHECK);
}
