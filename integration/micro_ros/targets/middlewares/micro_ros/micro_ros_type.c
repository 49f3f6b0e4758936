/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A type support for messages that are already serialised.
 */
#include "micro_ros_type.h"

#include <string.h>

#include <rosidl_typesupport_microxrcedds_c/identifier.h>
#include <ucdr/microcdr.h>

static bool serialize(const void *untyped, ucdrBuffer *buffer)
{
    const epg_micro_ros_sent_t *message = untyped;
    *message->taken = ucdr_serialize_array_uint8_t(buffer, message->data, message->size);
    return *message->taken;
}

static bool deserialize(ucdrBuffer *buffer, void *untyped)
{
    epg_micro_ros_received_t *message = untyped;
    const size_t size = ucdr_buffer_remaining(buffer);
    if (size > message->capacity) {
        return false;
    }
    message->size = size;
    return ucdr_deserialize_array_uint8_t(buffer, message->data, size);
}

static uint32_t size_of(const void *untyped)
{
    return (uint32_t)((const epg_micro_ros_sent_t *)untyped)->size;
}

static size_t size_behind(const void *untyped, size_t alignment)
{
    (void)alignment; /* the alignment inside a message is counted from its own start */
    return size_of(untyped);
}

/** Not needed: libmicroros asks for a size only when there is a message. */
static size_t largest_size(void)
{
    return 0;
}

static const rosidl_message_type_support_t *support_for(const rosidl_message_type_support_t *support,
                                                        const char *identifier)
{
    return strcmp(identifier, support->typesupport_identifier) == 0 ? support : NULL;
}

bool epg_micro_ros_type_make(epg_micro_ros_type_t *type, const epg_message_t *message)
{
    static const char MARK[] = "::dds_::";
    const char *mark = strstr(message->type, MARK);
    const size_t length = strlen(message->type);
    if (mark == NULL || length >= sizeof type->name || message->type[length - 1] != '_') {
        return false;
    }
    memcpy(type->name, message->type, length);
    const size_t space = (size_t)(mark - message->type);
    type->name[space] = '\0';
    type->name[length - 1] = '\0';
    type->callbacks = (message_type_support_callbacks_t){
        .message_namespace_ = type->name,
        .message_name_ = type->name + space + sizeof MARK - 1,
        .cdr_serialize = serialize,
        .cdr_deserialize = deserialize,
        .get_serialized_size = size_of,
        .get_serialized_size_with_initial_alignment = size_behind,
        .max_serialized_size = largest_size,
    };
    type->support = (rosidl_message_type_support_t){
        .typesupport_identifier = ROSIDL_TYPESUPPORT_MICROXRCEDDS_C__IDENTIFIER_VALUE,
        .data = &type->callbacks,
        .func = support_for,
    };
    return true;
}
