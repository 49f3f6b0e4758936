/**
 * @file
 * BLAKE2s with and without a key, against the numbers that RFC 7693 and its authors have published.
 */
#include "links/blake2s.h"

#include "check.h"

static void hash(unsigned char *output, size_t size, const void *key, size_t key_size, const void *data,
                 size_t data_size)
{
    epg_host_blake2s_t state;
    epg_host_blake2s_begin(&state, size, key, key_size);
    epg_host_blake2s_add(&state, data, data_size);
    epg_host_blake2s_end(&state, output);
}

static void check_hash(const unsigned char *found, const char *expected)
{
    char text[2 * EPG_HOST_BLAKE2S_MOST + 1];
    for (size_t i = 0; i < EPG_HOST_BLAKE2S_MOST; i++) {
        (void)snprintf(text + 2 * i, 3, "%02x", found[i]);
    }
    if (strcmp(text, expected) != 0) {
        fprintf(stderr, "%s, not %s\n", text, expected);
        exit(1);
    }
}

/* RFC 7693, appendix B. */
TEST(the_example_of_the_rfc)
{
    unsigned char found[32];
    hash(found, 32, NULL, 0, "abc", 3);
    check_hash(found, "508c5e8c327c14e2e1a72ba34eeb452f37458b209ed63a294d999b4c86675982");
}

/* The first and the last row with a key of the authors' table, testvectors/blake2s-kat.txt of BLAKE2/BLAKE2. */
TEST(the_authors_examples_with_a_key)
{
    unsigned char key[32];
    unsigned char data[255];
    unsigned char found[32];
    for (size_t i = 0; i < sizeof data; i++) {
        data[i] = (unsigned char)i;
    }
    memcpy(key, data, sizeof key);
    hash(found, 32, key, sizeof key, data, 0);
    check_hash(found, "48a8997da407876b3d79c0d92325ad3b89cbb754d86ab71aee047ad345fd2c49");
    hash(found, 32, key, sizeof key, data, sizeof data);
    check_hash(found, "3fb735061abc519dfe979e54c1ee5bfad0a9d858b3315bad34bde999efd724dd");
}

static void fill(unsigned char *data, size_t size, uint32_t seed)
{
    uint32_t a = 0xDEAD4BADU * seed;
    uint32_t b = 1;
    for (size_t i = 0; i < size; i++) {
        const uint32_t next = a + b;
        a = b;
        b = next;
        data[i] = (unsigned char)(next >> 24U);
    }
}

/* RFC 7693, appendix E: the hash of the hashes of many sizes, with and without a key. */
TEST(the_self_test_of_the_rfc)
{
    static const size_t sizes[4] = {16, 20, 28, 32};
    static const size_t data_sizes[6] = {0, 3, 64, 65, 255, 1024};
    unsigned char data[1024];
    unsigned char key[32];
    unsigned char found[32];
    epg_host_blake2s_t all;
    epg_host_blake2s_begin(&all, 32, NULL, 0);
    for (size_t i = 0; i < 4; i++) {
        for (size_t j = 0; j < 6; j++) {
            fill(data, data_sizes[j], (uint32_t)data_sizes[j]);
            hash(found, sizes[i], NULL, 0, data, data_sizes[j]);
            epg_host_blake2s_add(&all, found, sizes[i]);
            fill(key, sizes[i], (uint32_t)sizes[i]);
            hash(found, sizes[i], key, sizes[i], data, data_sizes[j]);
            epg_host_blake2s_add(&all, found, sizes[i]);
        }
    }
    epg_host_blake2s_end(&all, found);
    check_hash(found, "6a411f08ce25adcdfb02aba641451cec53c598b24f4fc787fbdc88797f4c1dfe");
}

TEST(parts_give_the_hash_of_the_whole)
{
    unsigned char data[300];
    unsigned char whole[32];
    unsigned char parts[32];
    fill(data, sizeof data, 7);
    hash(whole, 32, data, 16, data, sizeof data);
    for (size_t step = 1; step < sizeof data; step++) {
        epg_host_blake2s_t state;
        epg_host_blake2s_begin(&state, 32, data, 16);
        for (size_t at = 0; at < sizeof data; at += step) {
            epg_host_blake2s_add(&state, data + at, sizeof data - at < step ? sizeof data - at : step);
        }
        epg_host_blake2s_end(&state, parts);
        CHECK(memcmp(whole, parts, sizeof whole) == 0);
    }
}

RUN()
