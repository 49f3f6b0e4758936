/**
 * @file
 * A minimal framework for C tests: named tests, and checks that report their position.
 *
 * A file ends with RUN(ENTRY(first), ENTRY(second), ...).  The program runs the test that its argument names.  pytest
 * calls it once for each TEST() in the source; a test without an ENTRY() therefore fails.
 */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEST(name) static void name(void)

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

typedef struct check_entry {
    const char *name;
    void (*run)(void);
} check_entry_t;

#define ENTRY(name)                                                                                                    \
    {                                                                                                                  \
#name, name                                                                                                    \
    }

#define RUN(...)                                                                                                       \
    int main(int argc, char **argv)                                                                                    \
    {                                                                                                                  \
        static const check_entry_t entries[] = {__VA_ARGS__};                                                          \
        for (size_t i = 0; argc == 2 && i < sizeof entries / sizeof entries[0]; i++) {                                 \
            if (strcmp(entries[i].name, argv[1]) == 0) {                                                               \
                entries[i].run();                                                                                      \
                return 0;                                                                                              \
            }                                                                                                          \
        }                                                                                                              \
        fprintf(stderr, "there is no such test\n");                                                                    \
        return 2;                                                                                                      \
    }

#endif
