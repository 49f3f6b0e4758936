/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The services that read parameters: their values, types and descriptions, and their names.
 */
#include <string.h>

#include "epg/finite.h"
#include "parameter_request.h"

/* Values, types, descriptions ---------------------------------------------------------------------------------- */

/** Takes a request for parameters by name.  If one of them is unknown, the reply is empty, as that of rclcpp. */
static bool take_names(epg_node_t *node, epg_cdr_reader_t *request)
{
    epg_service_state_t *state = node->target->service_state;
    const epg_parameters_t *parameters = epg_parameters_of(node);
    if (!epg_parameter_entries_check(node, request, false)) {
        return false;
    }
    for (size_t i = 0; i < state->entries; i++) {
        if (epg_parameter_entry_read(node, i, false).index == SIZE_MAX) {
            state->entries = 0;
        }
    }
    memcpy(state->copy, parameters->values, parameters->count * sizeof *state->copy);
    return true;
}

/**
 * Writes part `part` of a sequence: first the number of elements, then the elements.  Returns the index of the
 * parameter that must be written as an element, or SIZE_MAX if there is none; `*more` tells if there is such a part.
 */
static size_t next_element(epg_node_t *node, epg_reply_t *reply, size_t part, bool *more)
{
    const epg_service_state_t *state = node->target->service_state;
    *more = part <= state->entries;
    if (part == 0) {
        epg_reply_u32(reply, (uint32_t)state->entries);
    }
    return part == 0 || !*more ? SIZE_MAX : epg_parameter_entry_read(node, part - 1, false).index;
}

static bool write_values(epg_node_t *node, epg_reply_t *reply, size_t part)
{
    bool more;
    const size_t index = next_element(node, reply, part, &more);
    if (index != SIZE_MAX) {
        epg_parameter_write_value(reply, node->target->service_state->copy[index]);
    }
    return more;
}

static bool write_types(epg_node_t *node, epg_reply_t *reply, size_t part)
{
    bool more;
    if (next_element(node, reply, part, &more) != SIZE_MAX) {
        epg_reply_u8(reply, EPG_PARAMETER_TYPE_DOUBLE);
    }
    return more;
}

/** Writes a rcl_interfaces/msg/ParameterDescriptor. */
static bool write_descriptions(epg_node_t *node, epg_reply_t *reply, size_t part)
{
    bool more;
    const size_t index = next_element(node, reply, part, &more);
    if (index == SIZE_MAX) {
        return more;
    }
    const epg_parameter_text_t *text = &node->target->service_state->texts[index];
    const epg_parameter_limits_t *limits = epg_parameters_of(node)->limits;
    const bool limited =
        limits != NULL && (epg_is_finite(limits[index].minimum) || epg_is_finite(limits[index].maximum));
    epg_reply_string(reply, text->name);
    epg_reply_u8(reply, EPG_PARAMETER_TYPE_DOUBLE);
    epg_reply_string(reply, text->description);
    epg_reply_string(reply, ""); /* additional_constraints */
    epg_reply_u8(reply, 0);      /* read_only */
    epg_reply_u8(reply, 0);      /* dynamic_typing */
    epg_reply_u32(reply, limited ? 1 : 0);
    if (limited) {
        epg_reply_f64(reply, limits[index].minimum);
        epg_reply_f64(reply, limits[index].maximum);
        epg_reply_f64(reply, 0.0); /* step: any */
    }
    epg_reply_u32(reply, 0); /* integer_range */
    return more;
}

const epg_service_kind_t epg_service_get_parameters = {
    .request = {.type = "rcl_interfaces::srv::dds_::GetParameters_Request_",
                .hash = EPG_TYPE_HASH("RIHS01_135a9e1c3d7cebef792f6687d7ddf99949b21a0bd9a320d863a9110a3f5cf4d6")},
    .reply = {.type = "rcl_interfaces::srv::dds_::GetParameters_Response_",
              .hash = EPG_TYPE_HASH("RIHS01_9fa773b46e39cc5d02db6224d8fd520bb9caeeffc2b27c96c1e59431baba9f2a")},
    .take = take_names,
    .write = write_values,
};

const epg_service_kind_t epg_service_get_parameter_types = {
    .request = {.type = "rcl_interfaces::srv::dds_::GetParameterTypes_Request_",
                .hash = EPG_TYPE_HASH("RIHS01_87d7ec5ef545d4daa289d500025d31fb2437bc8b8365ca367161c4dac4be33fd")},
    .reply = {.type = "rcl_interfaces::srv::dds_::GetParameterTypes_Response_",
              .hash = EPG_TYPE_HASH("RIHS01_ac1335dce67c478e669434f6ac2fbff34fcd529580f272d3006785ba8b54e47f")},
    .take = take_names,
    .write = write_types,
};

const epg_service_kind_t epg_service_describe_parameters = {
    .request = {.type = "rcl_interfaces::srv::dds_::DescribeParameters_Request_",
                .hash = EPG_TYPE_HASH("RIHS01_05dd1c2bc87dec2627105c8070d6f9725c781a4f2ab852975bf105462b82b644")},
    .reply = {.type = "rcl_interfaces::srv::dds_::DescribeParameters_Response_",
              .hash = EPG_TYPE_HASH("RIHS01_ad6747319613c6131589e062e095b469a46cc764f7d0f12a001a49e6cd893995")},
    .take = take_names,
    .write = write_descriptions,
};

/* Names -------------------------------------------------------------------------------------------------------- */

/** Returns true if `name` has less than `depth` separators; 0 is any depth. */
static bool less_deep(const char *name, uint64_t depth)
{
    uint64_t separators = 0;
    for (const char *place = strchr(name, '.'); place != NULL; place = strchr(place + 1, '.')) {
        separators++;
    }
    return depth == 0 || separators < depth;
}

/** Whether the reply lists a parameter, and if its prefix is listed with it.  A number in `copy` for each parameter. */
enum { NOT_LISTED, LISTED, LISTED_WITH_PREFIX };

/** Returns true if a checked request asks for the parameter `name`: by its prefixes, or by depth if there are none. */
static bool is_asked(const epg_service_state_t *state, const char *name, uint64_t depth)
{
    epg_cdr_reader_t reader = {.data = state->request, .size = state->length};
    const uint32_t prefixes = epg_cdr_read_u32(&reader);
    bool asked = prefixes == 0 && less_deep(name, depth);
    for (uint32_t i = 0; i < prefixes && !asked; i++) {
        const char *prefix = epg_cdr_read_string(&reader);
        const size_t length = strlen(prefix);
        asked = strncmp(name, prefix, length) == 0 &&
                (name[length] == '\0' || (name[length] == '.' && less_deep(name + length + 1, depth)));
    }
    return asked;
}

/** Returns the length of the part of `name` before its last separator; 0 if it has none. */
static size_t prefix_of(const char *name)
{
    const char *last = strrchr(name, '.');
    return last == NULL ? 0 : (size_t)(last - name);
}

/** Returns true if parameter `index` is the first one in the list with its prefix. */
static bool has_new_prefix(const epg_service_state_t *state, size_t index)
{
    const char *name = state->texts[index].name;
    const size_t length = prefix_of(name);
    for (size_t i = index; i > 0; i--) {
        const char *before = state->texts[i - 1].name;
        if (state->copy[i - 1] > (double)NOT_LISTED && prefix_of(before) == length &&
            strncmp(before, name, length) == 0) {
            return false;
        }
    }
    return length > 0;
}

static bool take_list(epg_node_t *node, epg_cdr_reader_t *request)
{
    epg_service_state_t *state = node->target->service_state;
    const size_t count = epg_parameters_of(node)->count;
    const uint32_t prefixes = epg_cdr_read_u32(request);
    for (uint32_t i = 0; i < prefixes && !request->failed; i++) {
        (void)epg_cdr_read_string(request);
    }
    const uint64_t depth = epg_cdr_read_bits(request, sizeof(uint64_t));
    for (size_t i = 0; i < count && !request->failed; i++) {
        const bool asked = is_asked(state, state->texts[i].name, depth);
        state->copy[i] = !asked ? NOT_LISTED : has_new_prefix(state, i) ? LISTED_WITH_PREFIX : LISTED;
    }
    return !request->failed;
}

/** Writes the number of names, each name, the number of prefixes, each prefix. */
static bool write_list(epg_node_t *node, epg_reply_t *reply, size_t part)
{
    const epg_service_state_t *state = node->target->service_state;
    const size_t count = epg_parameters_of(node)->count;
    const bool names = part <= count;
    const size_t number = names ? part : part - count - 1;
    const double least = names ? LISTED : LISTED_WITH_PREFIX;
    if (number > count) {
        return false;
    }
    if (number == 0) {
        uint32_t elements = 0;
        for (size_t i = 0; i < count; i++) {
            elements += state->copy[i] >= least ? 1U : 0U;
        }
        epg_reply_u32(reply, elements);
    } else if (state->copy[number - 1] >= least) {
        const char *name = state->texts[number - 1].name;
        epg_reply_text(reply, name, names ? strlen(name) : prefix_of(name));
    }
    return true;
}

const epg_service_kind_t epg_service_list_parameters = {
    .request = {.type = "rcl_interfaces::srv::dds_::ListParameters_Request_",
                .hash = EPG_TYPE_HASH("RIHS01_a1b0b5d6b967a5b8ac5bc8563c3ea678f349e312a6a4967227c5a96bc5ce38df")},
    .reply = {.type = "rcl_interfaces::srv::dds_::ListParameters_Response_",
              .hash = EPG_TYPE_HASH("RIHS01_31b937b82de3612426be79f231e386259f97e8dc843e3f2845288b4bfa296bdd")},
    .take = take_list,
    .write = write_list,
};
