/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The names of a target, for programs.
 */
#include "interface.h"

#include <inttypes.h>
#include <stdio.h>

void epg_host_print_interface(const epg_host_target_t *host)
{
    const epg_target_t *target = host->target;
    for (size_t i = 0; i < target->subscription_count; i++) {
        const epg_topic_t *subscription = &target->subscriptions[i];
        for (size_t k = 0; k < subscription->count; k++) {
            printf("topic,%s\n", epg_topic_value_name(subscription, k));
        }
    }
    for (size_t i = 0; i < host->input_count; i++) {
        printf("input,%s\n", host->inputs[i].name);
    }
    for (size_t i = 0; i < target->component_count; i++) {
        printf("component,%s\n", target->components[i]);
    }
    for (size_t i = 0; i < host->signal_count; i++) {
        printf("signal,%s\n", host->signals[i].name);
    }
    const epg_parameters_t *parameters = target->application->parameters;
    for (size_t i = 0; parameters != NULL && i < parameters->count; i++) {
        printf("parameter,%s\n", parameters->table[i].name);
    }
    for (size_t i = 0; i < host->function_count; i++) {
        printf("function,%s\n", host->functions[i]);
    }
    printf("model,%s\nperiod,%" PRIu64 "\n", target->model, target->application->period_ns);
}
