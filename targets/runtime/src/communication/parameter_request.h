/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Requests that concern parameters: their elements, one after the other.
 */
#ifndef EPG_PARAMETER_REQUEST_H
#define EPG_PARAMETER_REQUEST_H

#include "epg/parameter_services.h"
#include "reply.h"

/** The types of parameters: rcl_interfaces/msg/ParameterType. */
enum { EPG_PARAMETER_TYPE_INTEGER = 2, EPG_PARAMETER_TYPE_DOUBLE = 3, EPG_PARAMETER_TYPES = 10 };

/** An element of a request: a name, or a name with a value.  `name` points into the request. */
typedef struct epg_parameter_entry {
    const char *name;
    size_t index; /**< index of the parameter; SIZE_MAX: there is none with this name */
    uint8_t type;
    double value; /**< only valid if `type` is that of a double or an integer */
} epg_parameter_entry_t;

/** Returns the parameters of the node's target. */
static inline epg_parameters_t *epg_parameters_of(const epg_node_t *node)
{
    return node->target->application->parameters;
}

/**
 * Checks that the request is a sequence of names, with values if `values` is true.  Returns false if it is malformed.
 * Otherwise `state->entries` is their number.
 */
bool epg_parameter_entries_check(epg_node_t *node, epg_cdr_reader_t *request, bool values);

/** Reads element `entry` of a checked request.  Ascending elements are fastest. */
epg_parameter_entry_t epg_parameter_entry_read(epg_node_t *node, size_t entry, bool values);

/** Writes a rcl_interfaces/msg/ParameterValue of a double. */
void epg_parameter_write_value(epg_reply_t *reply, double value);

#endif
