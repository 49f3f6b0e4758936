/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The store: names and parameters that are kept over a restart.  Its layout:
 *
 * | bytes | meaning                                                                      |
 * |-------|------------------------------------------------------------------------------|
 * | 4     | "EPGP"                                                                       |
 * | 4     | version of this layout, 2                                                    |
 * | 64    | name of the node, zero-padded; empty: the generated one                      |
 * | 64    | its namespace, in the same way                                               |
 * | 4     | CRC-32 of everything before it (IEEE 802.3, reflected), so that the names    |
 * |       | are valid even if the parameters are not                                     |
 * | 8     | identification of the model                                                  |
 * | 4     | number of values                                                             |
 * | 12    | for each: index (4), value (8, IEEE 754 binary64)                            |
 * | 4     | CRC-32 of everything before it                                               |
 *
 * Numbers are little-endian on every processor.
 */
#include "epg/store.h"

#include <string.h>

#include "epg/names.h"
#include "epg/port.h"

enum {
    NODE = 8,
    NAME_SPACE = NODE + EPG_STORE_NAME_SIZE,
    NAMES_CHECK = NAME_SPACE + EPG_STORE_NAME_SIZE,
    MODEL = NAMES_CHECK + 4,
    COUNT = MODEL + 8,
    HEADER = COUNT + 4,
    ENTRY = 12,
    CHECK = 4,
    VERSION = 2
};

static_assert(EPG_STORE_SIZE(0) == HEADER + CHECK, "the layout of a store");

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

/** Computes a CRC-32 without a table.  A store has a few hundred bytes and is written only at a user's command. */
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

/** Writes the CRC of all bytes before `place` to `place`. */
static void seal(unsigned char *bytes, size_t place)
{
    put(bytes + place, crc32(bytes, place), CHECK);
}

static bool is_sealed(const unsigned char *bytes, size_t place)
{
    return get(bytes + place, CHECK) == crc32(bytes, place);
}

/** Returns the number of values in a complete store of `size` bytes, of any model; SIZE_MAX if it is damaged. */
static size_t whole(const unsigned char *bytes, size_t size)
{
    if (size < HEADER + CHECK) {
        return SIZE_MAX;
    }
    const size_t count = (size_t)get(bytes + COUNT, 4);
    if (count > (size - HEADER - CHECK) / ENTRY) {
        return SIZE_MAX;
    }
    return is_sealed(bytes, HEADER + count * ENTRY) ? count : SIZE_MAX;
}

static const unsigned char *entry_at(const epg_store_t *store, size_t place)
{
    return store->bytes + HEADER + place * ENTRY;
}

/** Returns true if the parameter of the entry `place` can have its value. */
static bool fits(const epg_store_t *store, size_t place)
{
    const unsigned char *entry = entry_at(store, place);
    return epg_parameters_can_be(store->parameters, (size_t)get(entry, 4), get_value(entry + 4));
}

/** Returns EPG_STORED_PARTLY if an entry has a value that its parameter cannot have. */
static epg_parameters_stored_t judge_entries(const epg_store_t *store, size_t count)
{
    epg_parameters_stored_t result = EPG_STORED_LOADED;
    for (size_t i = 0; i < count; i++) {
        if (get(entry_at(store, i), 4) >= store->parameters->count) {
            return EPG_STORED_DAMAGED;
        }
        if (!fits(store, i)) {
            result = EPG_STORED_PARTLY;
        }
    }
    return result;
}

/** Checks the parameters in a store of `size` bytes.  `*count` is the number of its entries. */
static epg_parameters_stored_t judge(const epg_store_t *store, size_t size, size_t *count)
{
    if (size == 0) {
        return EPG_STORED_NOTHING;
    }
    if (size < HEADER || get(store->bytes, 4) != MAGIC || get(store->bytes + 4, 4) != VERSION) {
        return EPG_STORED_DAMAGED;
    }
    if (get(store->bytes + MODEL, 8) != store->parameters->model) {
        return EPG_STORED_FOR_OTHER;
    }
    const size_t entries = whole(store->bytes, size);
    if (entries == SIZE_MAX) {
        return EPG_STORED_DAMAGED;
    }
    *count = entries;
    return judge_entries(store, entries);
}

static bool has_values(const epg_parameters_t *parameters)
{
    return parameters->stored == EPG_STORED_LOADED || parameters->stored == EPG_STORED_PARTLY;
}

static void load_parameters(epg_store_t *store, size_t size)
{
    epg_parameters_t *parameters = store->parameters;
    size_t count = 0;
    epg_handover_clear(&parameters->handover);
    for (size_t i = 0; i < parameters->count; i++) {
        parameters->values[i] = parameters->table[i].value;
        parameters->changed[i] = false;
        parameters->wanted[i] = false;
    }
    parameters->stored = judge(store, size, &count);
    for (size_t i = 0; i < count && has_values(parameters); i++) {
        const unsigned char *entry = entry_at(store, i);
        if (fits(store, i)) {
            const size_t index = (size_t)get(entry, 4);
            parameters->values[index] = get_value(entry + 4);
            parameters->applied[index] = parameters->values[index];
            parameters->changed[index] = true;
        }
    }
}

static void load_names(epg_store_t *store, size_t size)
{
    const unsigned char *bytes = store->bytes;
    store->node[0] = '\0';
    store->name_space[0] = '\0';
    if (size < MODEL || get(bytes, 4) != MAGIC || get(bytes + 4, 4) != VERSION || !is_sealed(bytes, NAMES_CHECK)) {
        return;
    }
    memcpy(store->node, bytes + NODE, sizeof store->node - 1);
    memcpy(store->name_space, bytes + NAME_SPACE, sizeof store->name_space - 1);
    store->node[sizeof store->node - 1] = '\0';
    store->name_space[sizeof store->name_space - 1] = '\0';
    /* Another firmware may have stored names that are not valid for this one. */
    if (!epg_names_is_node(store->node)) {
        store->node[0] = '\0';
    }
    if (!epg_names_is_space(store->name_space)) {
        store->name_space[0] = '\0';
    }
}

void epg_store_load(epg_store_t *store)
{
    const size_t room = EPG_STORE_SIZE(store->parameters != NULL ? store->parameters->count : 0U);
    const size_t size = epg_port_store_read(store->bytes, room);
    load_names(store, size);
    if (store->parameters != NULL) {
        load_parameters(store, size);
    }
}

/** Copies a name and fills the rest of its field with zeros, so that no part of an older name stays there. */
static void put_name(unsigned char *bytes, const char *name)
{
    const size_t length = strlen(name);
    memset(bytes, 0, EPG_STORE_NAME_SIZE);
    memcpy(bytes, name, length);
}

const char *epg_store_save(epg_store_t *store, size_t *values)
{
    epg_parameters_t *parameters = store->parameters;
    unsigned char *bytes = store->bytes;
    size_t count = 0;
    for (size_t i = 0; parameters != NULL && i < parameters->count; i++) {
        if (bits_of(parameters->values[i]) != bits_of(parameters->table[i].value)) {
            unsigned char *entry = bytes + HEADER + count * ENTRY;
            put(entry, i, 4);
            put(entry + 4, bits_of(parameters->values[i]), 8);
            count++;
        }
    }
    put(bytes, MAGIC, 4);
    put(bytes + 4, VERSION, 4);
    put_name(bytes + NODE, store->node);
    put_name(bytes + NAME_SPACE, store->name_space);
    seal(bytes, NAMES_CHECK);
    put(bytes + MODEL, parameters != NULL ? parameters->model : 0U, 8);
    put(bytes + COUNT, count, 4);
    seal(bytes, HEADER + count * ENTRY);
    *values = count;
    const char *problem = epg_port_store_write(bytes, HEADER + count * ENTRY + CHECK);
    if (problem == NULL && parameters != NULL) {
        parameters->stored = EPG_STORED_SAVED;
    }
    return problem;
}

const char *epg_store_refused(const epg_store_t *store, size_t index)
{
    const epg_parameters_t *parameters = store->parameters;
    if (parameters == NULL || parameters->stored != EPG_STORED_PARTLY) {
        return NULL;
    }
    const size_t count = (size_t)get(store->bytes + COUNT, 4);
    size_t refused = 0;
    for (size_t i = 0; i < count; i++) {
        if (!fits(store, i) && refused++ == index) {
            return parameters->table[get(entry_at(store, i), 4)].name;
        }
    }
    return NULL;
}
