/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The functions of H-bridges that not every control cycle calls.
 */
#include "epg/bridge.h"

void epg_bridge_rest(epg_bridge_t *bridge, const epg_bridge_config_t *config, uint32_t clocks, epg_bridge_state_t state)
{
    bridge->duty = 0.0;
    bridge->level = state == EPG_BRIDGE_BRAKE ? clocks : 0;
    bridge->state = state;
    if (state != EPG_BRIDGE_COAST) {
        bridge->coasted = 0;
    } else if (bridge->coasted < config->dead_writes) {
        bridge->coasted++;
    }
}

bool epg_bridge_turn(epg_bridge_t *bridge, const epg_bridge_config_t *config, epg_bridge_state_t direction)
{
    const bool same = bridge->driven == direction || bridge->driven == EPG_BRIDGE_COAST;
    if (!same && bridge->coasted < config->dead_writes) {
        epg_bridge_rest(bridge, config, 0, EPG_BRIDGE_COAST);
        return false;
    }
    bridge->state = direction;
    bridge->driven = direction;
    bridge->coasted = 0;
    return true;
}
