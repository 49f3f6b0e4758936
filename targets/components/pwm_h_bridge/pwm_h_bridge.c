/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * An H-bridge with two direction pins: the functions that not every control cycle calls.
 */
#include "pwm_h_bridge.h"

/** Sets the direction pins for the state of the bridge.  The bridge must be off. */
static void set_pins(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config)
{
    const epg_bridge_state_t state = bridge->bridge.state;
    if (state == EPG_BRIDGE_FORWARDS || state == EPG_BRIDGE_BRAKE) {
        epg_port_output_write(config->pin_a, true);
    }
    if (state == EPG_BRIDGE_BACKWARDS || state == EPG_BRIDGE_BRAKE) {
        epg_port_output_write(config->pin_b, true);
    }
    bridge->shown = state;
}

static void off(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config)
{
    epg_port_pwm_write(&config->pwm, 0);
    epg_port_output_write(config->pin_a, false);
    epg_port_output_write(config->pin_b, false);
    bridge->shown = EPG_BRIDGE_COAST;
}

void epg_pwm_h_bridge_start(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config)
{
    *bridge = (epg_pwm_h_bridge_t){0};
    epg_port_output_start(config->pin_a, false);
    epg_port_output_start(config->pin_b, false);
    epg_port_pwm_start(&config->pwm);
    epg_pwm_h_bridge_safe(bridge, config);
}

void epg_pwm_h_bridge_safe(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config)
{
    epg_bridge_make_safe(&bridge->bridge, &config->bridge, config->pwm.top + 1U);
    if (config->bridge.safe == EPG_BRIDGE_BRAKE) {
        set_pins(bridge, config);
        epg_port_pwm_write(&config->pwm, bridge->bridge.level);
    } else {
        off(bridge, config);
    }
}

void epg_pwm_h_bridge_change(epg_pwm_h_bridge_t *bridge, const epg_pwm_h_bridge_config_t *config)
{
    off(bridge, config);
    set_pins(bridge, config);
}
