/**
 * @file
 * A minimal framework for C tests: named tests, and checks that report their position.
 *
 * A file ends with RUN().  The program runs the test that its argument names.  pytest calls it once for each TEST() in the
 * source.
 */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct check_entry {
    const char *name;
    void (*run)(void);
    struct check_entry *next;
} check_entry_t;

/** The newest test of the file, which leads to all others. */
static inline check_entry_t **check_newest(void)
{
    static check_entry_t *newest = NULL;
    return &newest;
}

/** Begins a test, which adds itself to the tests of its file before main(). */
#define TEST(name)                                                                                                     \
    static void name(void);                                                                                            \
    __attribute__((constructor)) static void check_add_##name(void)                                                    \
    {                                                                                                                  \
        static check_entry_t entry = {#name, name, NULL};                                                              \
        entry.next = *check_newest();                                                                                  \
        *check_newest() = &entry;                                                                                      \
    }                                                                                                                  \
    static void name(void)

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);                                    \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

/** Checks that two numbers are exactly equal; prints both if they are not. */
#define CHECK_EQUAL(actual, expected)                                                                                  \
    do {                                                                                                               \
        const double check_actual = (double)(actual);                                                                  \
        const double check_expected = (double)(expected);                                                              \
        if (!(check_actual == check_expected)) {                                                                       \
            fprintf(stderr, "%s:%d: %s is %.17g, not %.17g\n", __FILE__, __LINE__, #actual, check_actual,              \
                    check_expected);                                                                                   \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

#define RUN()                                                                                                          \
    int main(int argc, char **argv)                                                                                    \
    {                                                                                                                  \
        for (const check_entry_t *each = *check_newest(); argc == 2 && each != NULL; each = each->next) {              \
            if (strcmp(each->name, argv[1]) == 0) {                                                                    \
                each->run();                                                                                           \
                return 0;                                                                                              \
            }                                                                                                          \
        }                                                                                                              \
        fprintf(stderr, "there is no such test\n");                                                                    \
        return 2;                                                                                                      \
    }

#endif
