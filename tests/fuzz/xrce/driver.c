/**
 * @file
 * Runs a fuzz target without libFuzzer:
 *
 *     xrce_fuzz [-random=<count>] [-seed=<seed>] [-corpus=<text file>] [file...]
 *
 * Each file is an input, and so is each line of the text file, in hexadecimal digits.  Then the driver makes `count`
 * more inputs: pieces of two inputs joined, with changed bytes, or random bytes only.  The same seed makes the same
 * inputs.
 */
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { LARGEST = 4096, MOST_SAMPLES = 65536 };

typedef struct sample {
    size_t size;
    uint8_t *data;
} sample_t;

static sample_t samples[MOST_SAMPLES];
static size_t sample_count;
static uint64_t chance;

/** xorshift64* of Vigna. */
static uint32_t draw(uint32_t below)
{
    chance ^= chance >> 12;
    chance ^= chance << 25;
    chance ^= chance >> 27;
    return (uint32_t)((chance * UINT64_C(0x2545F4914F6CDD1D)) >> 33) % below;
}

static size_t piece(uint8_t *data, size_t room)
{
    if (sample_count == 0 || draw(4) == 0) {
        const size_t size = draw(200) < room ? draw((uint32_t)(room < 200 ? room : 200)) : room;
        for (size_t i = 0; i < size; i++) {
            data[i] = (uint8_t)draw(256);
        }
        return size;
    }
    const sample_t *sample = &samples[draw((uint32_t)sample_count)];
    const size_t begin = sample->size > 0 && draw(2) == 0 ? draw((uint32_t)sample->size) : 0;
    const size_t size = sample->size - begin < room ? sample->size - begin : room;
    if (size > 0) {
        memcpy(data, sample->data + begin, size);
    }
    return size;
}

static void run_random(void)
{
    static uint8_t data[LARGEST];
    size_t size = piece(data, LARGEST / 2);
    if (draw(2) == 0) {
        size += piece(data + size, LARGEST - size);
    }
    for (uint32_t i = draw(6); i > 0 && size > 0; i--) {
        data[draw((uint32_t)size)] = (uint8_t)draw(256);
    }
    uint8_t *exact = malloc(size > 0 ? size : 1);
    if (exact != NULL) {
        memcpy(exact, data, size);
        (void)LLVMFuzzerTestOneInput(exact, size);
    }
    free(exact);
}

/** Copies an input to memory of exactly its size, so that sanitizers detect a read beyond it, and runs it. */
static int run_sample(const uint8_t *data, size_t size)
{
    uint8_t *exact = malloc(size > 0 ? size : 1);
    if (exact == NULL || sample_count == MOST_SAMPLES) {
        fputs("too many inputs\n", stderr);
        return 1;
    }
    memcpy(exact, data, size);
    samples[sample_count++] = (sample_t){size, exact};
    (void)LLVMFuzzerTestOneInput(exact, size);
    return 0;
}

static int run_file(const char *path)
{
    static uint8_t data[LARGEST];
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        fprintf(stderr, "cannot read %s\n", path);
        return 1;
    }
    const size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    return run_sample(data, size);
}

static int run_corpus(const char *path)
{
    static uint8_t data[LARGEST];
    static char line[2 * LARGEST + 2];
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        fprintf(stderr, "cannot read %s\n", path);
        return 1;
    }
    int failed = 0;
    while (failed == 0 && fgets(line, sizeof line, file) != NULL) {
        size_t size = 0;
        unsigned int byte;
        while (sscanf(line + 2 * size, "%2x", &byte) == 1) {
            data[size++] = (uint8_t)byte;
        }
        failed = run_sample(data, size);
    }
    fclose(file);
    return failed;
}

int main(int argc, char **argv)
{
    uint64_t count = 0, seed = 1;
    for (int i = 1; i < argc; i++) {
        if (strncmp(argv[i], "-random=", 8) == 0) {
            count = strtoull(argv[i] + 8, NULL, 10);
        } else if (strncmp(argv[i], "-seed=", 6) == 0) {
            seed = strtoull(argv[i] + 6, NULL, 10);
        } else if (strncmp(argv[i], "-corpus=", 8) == 0) {
            if (run_corpus(argv[i] + 8) != 0) {
                return 1;
            }
        } else if (run_file(argv[i]) != 0) {
            return 1;
        }
    }
    chance = seed * UINT64_C(0x9E3779B97F4A7C15) + 1;
    for (uint64_t i = 0; i < count; i++) {
        run_random();
    }
    printf("%zu samples, %" PRIu64 " random inputs\n", sample_count, count);
    return 0;
}
