/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A plant while it is simulated: of one target, or of the whole system.
 */
#include "plant.h"

#include "files/number.h"
#include "loop/diverged.h"

/** Moves the time of the next step on by one step.  The time is exact, so that errors do not add up. */
static void count(plant_t *plant)
{
    plant->next_ns += plant->step_ns / plant->divisor;
    plant->rest += plant->step_ns % plant->divisor;
    if (plant->rest >= plant->divisor) {
        plant->rest -= plant->divisor;
        plant->next_ns++;
    }
}

bool plant_open(plant_t *plant, const char *folder, const char *file, uint64_t step_ns, uint64_t divisor,
                bool starts_by_step)
{
    plant->step_ns = step_ns;
    plant->divisor = divisor;
    if (!module_load(&plant->module, folder, file, EPG_PLANT_SYMBOL)) {
        return false;
    }
    plant->model = plant->module.symbol;
    plant->model->init();
    count(plant);
    if (starts_by_step) {
        plant->model->step();
        count(plant);
    }
    return true;
}

static double value_of(const void *ports, const epg_system_port_t *port)
{
    return *(const double *)((const char *)ports + port->offset);
}

static void write_row(const plant_t *plant, uint64_t time_ns)
{
    epg_host_write_number(plant->file, epg_host_seconds(time_ns));
    for (size_t i = 0; i < plant->facts->input_count; i++) {
        fputc(',', plant->file);
        epg_host_write_number(plant->file, value_of(plant->model->inputs, &plant->facts->inputs[i]));
    }
    for (size_t i = 0; i < plant->facts->output_count; i++) {
        fputc(',', plant->file);
        epg_host_write_number(plant->file, value_of(plant->model->outputs, &plant->facts->outputs[i]));
    }
    fputc('\n', plant->file);
}

void plant_record(plant_t *plant, FILE *file)
{
    plant->file = file;
    fputs("time", file);
    for (size_t i = 0; i < plant->facts->input_count; i++) {
        fprintf(file, ",inputs.%s", plant->facts->inputs[i].name);
    }
    for (size_t i = 0; i < plant->facts->output_count; i++) {
        fprintf(file, ",outputs.%s", plant->facts->outputs[i].name);
    }
    fputc('\n', file);
    write_row(plant, 0);
}

void plant_write_outputs(const plant_t *plant, FILE *file)
{
    for (size_t i = 0; i < plant->facts->output_count; i++) {
        fprintf(file, "%s\"%s\": ", i > 0 ? ", " : "", plant->facts->outputs[i].name);
        epg_host_write_number(file, value_of(plant->model->outputs, &plant->facts->outputs[i]));
    }
}

/** Reports the first output that is not finite or too large. */
static void check(plant_t *plant, uint64_t time_ns)
{
    for (size_t i = 0; i < plant->facts->output_count && !plant->has_diverged; i++) {
        const double value = value_of(plant->model->outputs, &plant->facts->outputs[i]);
        if (epg_host_has_diverged(value)) {
            plant->has_diverged = true;
            char name[256];
            snprintf(name, sizeof name, "outputs.%s", plant->facts->outputs[i].name);
            epg_host_tell_diverged("plant", name, value, time_ns);
        }
    }
}

void plant_advance(plant_t *plant, uint64_t time_ns)
{
    for (;;) {
        const uint64_t step_ns = plant->next_ns + (plant->rest > 0 ? 1U : 0U);
        if (step_ns > time_ns || plant->has_diverged) {
            return;
        }
        plant->model->step();
        count(plant);
        if (plant->facts != NULL) {
            check(plant, step_ns);
        }
        if (plant->file != NULL) {
            write_row(plant, step_ns);
        }
    }
}

void plant_close(plant_t *plant)
{
    module_unload(&plant->module);
    plant->model = NULL;
}
