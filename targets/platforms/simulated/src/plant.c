/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A plant of a simulated system: one model.  CMake defines the name and the header of its library.
 */
#include EPG_PLANT_HEADER

#include "epg/unit.h"

#define JOIN_(name, end) name##end
#define JOIN(name, end) JOIN_(name, end)

static JOIN(EPG_PLANT, _inputs_t) inputs;
static JOIN(EPG_PLANT, _outputs_t) outputs;

static void init(void)
{
    JOIN(EPG_PLANT, _init)(JOIN(EPG_PLANT, _instance)(0), &inputs, &outputs);
}

static void step(void)
{
    JOIN(EPG_PLANT, _step)(JOIN(EPG_PLANT, _instance)(0), &inputs, &outputs);
}

extern const epg_plant_module_t epg_plant_module __attribute__((EPG_EXPORTED));
const epg_plant_module_t epg_plant_module = {
    .version = EPG_UNIT_VERSION,
    .inputs = &inputs,
    .inputs_size = sizeof inputs,
    .outputs = &outputs,
    .outputs_size = sizeof outputs,
    .init = init,
    .step = step,
};
