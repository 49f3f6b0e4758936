/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A line protocol over the SDK's stdio: setpoints in, positions out.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "handwritten.h"
#include "pico/stdlib.h"

volatile uint32_t communication_period_us = 33000; /* a debugger or a test may change it */

static char line[128];
static size_t length;
static bool watching;
static double setpoints[AXES];

static void take_setpoints(char *text)
{
    static const char *const names[AXES] = {"pan_subscriber=", "tilt_subscriber="};
    for (char *word = strtok(text, " "); word != NULL; word = strtok(NULL, " ")) {
        for (size_t n = 0; n < AXES; n++) {
            if (strncmp(word, names[n], strlen(names[n])) == 0) {
                setpoints[n] = strtod(word + strlen(names[n]), NULL);
            }
        }
    }
    control_setpoints(setpoints);
    printf("ok setpoint\n");
}

static void show_statistics(void)
{
    statistics_t statistics;
    control_statistics(&statistics);
    printf("stat enabled=%d\nstat cycles=%lu\nstat overruns=%lu\nstat missed=%lu\nok stats\n", statistics.enabled,
           (unsigned long)statistics.cycles, (unsigned long)statistics.overruns, (unsigned long)statistics.missed);
}

static void obey(char *text)
{
    if (strcmp(text, "stats") == 0) {
        show_statistics();
    } else if (strcmp(text, "watch pan_publisher") == 0) {
        watching = true;
        printf("ok watch\n");
    } else if (strcmp(text, "enable") == 0 || strcmp(text, "disable") == 0) {
        control_enable(text[0] == 'e');
        printf("ok %s\n", text);
    } else if (strchr(text, '=') != NULL) {
        take_setpoints(text);
    } else {
        printf("error line there is no command '%s'\n", text);
    }
}

static void read_input(void)
{
    for (int n = 0; n < 64; n++) {
        const int character = getchar_timeout_us(0);
        if (character < 0) {
            return;
        }
        if (character == '\n' || character == '\r') {
            line[length] = '\0';
            if (length > 0) {
                obey(line);
            }
            length = 0;
            return;
        }
        if (length < sizeof line - 1u) {
            line[length++] = (char)character;
        }
    }
}

void communicate(void)
{
    static uint32_t due_us;
    read_input();
    const uint32_t now_us = time_us_32();
    if (watching && (int32_t)(now_us - due_us) >= 0) {
        double positions[AXES];
        due_us = now_us - due_us > communication_period_us ? now_us : due_us;
        due_us += communication_period_us;
        control_positions(positions);
        printf("watch %.6f pan_publisher=%.9g\n", now_us * 1e-6, positions[PAN]);
    }
}
