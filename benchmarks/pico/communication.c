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

static void take_setpoints(char *text)
{
    static const char *const names[AXES] = {"pan_subscriber=", "tilt_subscriber="};
    for (char *word = strtok(text, " "); word != NULL; word = strtok(NULL, " ")) {
        for (uint32_t n = 0; n < AXES; n++) {
            if (strncmp(word, names[n], strlen(names[n])) == 0) {
                control_setpoint(n, strtod(word + strlen(names[n]), NULL));
            }
        }
    }
    printf("ok setpoint\n");
}

static void show_statistics(void)
{
    report_t report = {0};
    (void)control_report(&report);
    const statistics_t *statistics = &report.status.statistics;
    printf("stat enabled=%d\nstat fault=%u axis %u\nstat cycles=%lu\nstat overruns=%lu\nstat missed=%lu\n",
           report.status.enabled, report.status.fault, report.status.axis, (unsigned long)statistics->cycles,
           (unsigned long)statistics->overruns, (unsigned long)statistics->missed);
    printf("stat lateness_max=%lu us\nstat computation_max=%lu us\nstat clamped=%lu\nok stats\n",
           (unsigned long)(statistics->lateness_max / CLOCKS_PER_US),
           (unsigned long)(statistics->computation_max / CLOCKS_PER_US), (unsigned long)statistics->clamped);
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
    control_alive();
    read_input();
    const uint32_t now_us = time_us_32();
    if (watching && (int32_t)(now_us - due_us) >= 0) {
        report_t report = {0};
        due_us = now_us - due_us > communication_period_us ? now_us : due_us;
        due_us += communication_period_us;
        (void)control_report(&report);
        printf("watch %.6f pan_publisher=%.9g\n", now_us * 1e-6, report.outputs[LOGGING_PAN]);
    }
}
