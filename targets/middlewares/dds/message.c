/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Messages for CycloneDDS as bytes, with their encapsulation header.
 */
#include "message.h"

#include <stdlib.h>
#include <string.h>

#include "dds/ddsi/q_radmin.h"

enum { HEADER = 4 }; /* bytes of the encapsulation header: an identifier and options, two bytes each */

/** The identifier in all messages of ROS 2; on the wire it is big endian. */
enum { LITTLE_ENDIAN_CDR = 0x0001 };

typedef struct message {
    struct ddsi_serdata base; /* the first member, so that a pointer to the message is also a pointer to it */
    size_t size;              /* size with the header, rounded up to a multiple of 4 */
    unsigned char bytes[];
} message_t;

/** Allocates a message of `size` bytes with its header, all zero.  Returns NULL without memory. */
static message_t *new_message(const struct ddsi_sertype *type, enum ddsi_serdata_kind kind, size_t size)
{
    const size_t rounded = (size + 3U) & ~(size_t)3U;
    message_t *message = calloc(1, sizeof *message + rounded);
    if (message != NULL) {
        ddsi_serdata_init(&message->base, type, kind);
        message->size = rounded;
    }
    return message;
}

/** As new_message(), for a message that has arrived.  Returns NULL, too, if it is too large. */
static message_t *received_message(const struct ddsi_sertype *type, enum ddsi_serdata_kind kind, size_t size)
{
    return size > EPG_DDS_MESSAGE_LARGEST ? NULL : new_message(type, kind, size);
}

static struct ddsi_serdata *base_of(message_t *message)
{
    return message == NULL ? NULL : &message->base;
}

/* Operations of a message -------------------------------------------------------------------------------------- */

/** The types here have no keys, so all messages of a topic belong to one instance. */
static bool equal_keys(const struct ddsi_serdata *a, const struct ddsi_serdata *b)
{
    (void)a;
    (void)b;
    return true;
}

static uint32_t size_of(const struct ddsi_serdata *base)
{
    return (uint32_t)((const message_t *)base)->size;
}

/** Makes a message from the received fragments, which may overlap. */
static struct ddsi_serdata *from_fragments(const struct ddsi_sertype *type, enum ddsi_serdata_kind kind,
                                           const struct nn_rdata *fragment, size_t size)
{
    message_t *message = received_message(type, kind, size);
    uint32_t filled = 0;
    for (; message != NULL && fragment != NULL; fragment = fragment->nextfrag) {
        const uint32_t end = fragment->maxp1 < size ? fragment->maxp1 : (uint32_t)size;
        if (fragment->min > filled) {
            break; /* a gap; CycloneDDS never passes an incomplete message */
        }
        if (end > filled) {
            const unsigned char *payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
            memcpy(message->bytes + filled, payload + (filled - fragment->min), end - filled);
            filled = end;
        }
    }
    if (message != NULL && filled < size) {
        free(message);
        return NULL;
    }
    return base_of(message);
}

static struct ddsi_serdata *from_pieces(const struct ddsi_sertype *type, enum ddsi_serdata_kind kind,
                                        ddsrt_msg_iovlen_t count, const ddsrt_iovec_t *pieces, size_t size)
{
    message_t *message = received_message(type, kind, size);
    size_t filled = 0;
    for (ddsrt_msg_iovlen_t i = 0; message != NULL && i < count && pieces[i].iov_len <= size - filled; i++) {
        memcpy(message->bytes + filled, pieces[i].iov_base, pieces[i].iov_len);
        filled += pieces[i].iov_len;
    }
    return base_of(message);
}

static struct ddsi_serdata *from_keyhash(const struct ddsi_sertype *type, const struct ddsi_keyhash *keyhash)
{
    (void)keyhash;
    return base_of(new_message(type, SDK_KEY, 0));
}

/** Makes a message without content only, because there are no structures for samples here. */
static struct ddsi_serdata *from_sample(const struct ddsi_sertype *type, enum ddsi_serdata_kind kind,
                                        const void *sample)
{
    (void)sample;
    return kind == SDK_DATA ? NULL : base_of(new_message(type, kind, 0));
}

static void to_bytes(const struct ddsi_serdata *base, size_t offset, size_t size, void *bytes)
{
    memcpy(bytes, ((const message_t *)base)->bytes + offset, size);
}

static struct ddsi_serdata *to_reference(const struct ddsi_serdata *base, size_t offset, size_t size,
                                         ddsrt_iovec_t *reference)
{
    /* CycloneDDS only reads these bytes. */
    reference->iov_base = (void *)(uintptr_t)(((const message_t *)base)->bytes + offset);
    reference->iov_len = (ddsrt_iov_len_t)size;
    return ddsi_serdata_ref(base);
}

static void end_reference(struct ddsi_serdata *base, const ddsrt_iovec_t *reference)
{
    (void)reference;
    ddsi_serdata_unref(base);
}

static bool to_sample(const struct ddsi_serdata *base, void *sample, void **buffer, void *limit)
{
    (void)base;
    (void)sample;
    (void)buffer;
    (void)limit;
    return false;
}

static struct ddsi_serdata *to_untyped(const struct ddsi_serdata *base)
{
    struct ddsi_serdata *untyped = base_of(new_message(base->type, SDK_KEY, 0));
    if (untyped != NULL) {
        untyped->type = NULL;
    }
    return untyped;
}

static bool untyped_to_sample(const struct ddsi_sertype *type, const struct ddsi_serdata *base, void *sample,
                              void **buffer, void *limit)
{
    (void)type;
    (void)base;
    (void)sample;
    (void)buffer;
    (void)limit;
    return true;
}

static void free_message(struct ddsi_serdata *base)
{
    free(base);
}

static size_t print(const struct ddsi_sertype *type, const struct ddsi_serdata *base, char *text, size_t size)
{
    (void)type;
    (void)base;
    (void)size;
    text[0] = '\0';
    return 0;
}

static void get_keyhash(const struct ddsi_serdata *base, struct ddsi_keyhash *keyhash, bool force_md5)
{
    (void)base;
    (void)force_md5;
    memset(keyhash, 0, sizeof *keyhash);
}

static const struct ddsi_serdata_ops message_operations = {
    .eqkey = equal_keys,
    .get_size = size_of,
    .from_ser = from_fragments,
    .from_ser_iov = from_pieces,
    .from_keyhash = from_keyhash,
    .from_sample = from_sample,
    .to_ser = to_bytes,
    .to_ser_ref = to_reference,
    .to_ser_unref = end_reference,
    .to_sample = to_sample,
    .to_untyped = to_untyped,
    .untyped_to_sample = untyped_to_sample,
    .free = free_message,
    .print = print,
    .get_keyhash = get_keyhash,
    /* Shared memory is switched off (domain.c), so its operations, if this version has any, can be NULL. */
};

/* Operations of a type ----------------------------------------------------------------------------------------- */

static void free_type(struct ddsi_sertype *type)
{
    ddsi_sertype_fini(type);
    free(type);
}

/** This function and the next two are for structures, loans and filters, which are not used here. */
static void zero_samples(const struct ddsi_sertype *type, void *samples, size_t count)
{
    (void)type;
    (void)samples;
    (void)count;
}

static void realloc_samples(void **samples, const struct ddsi_sertype *type, void *old, size_t old_count, size_t count)
{
    (void)type;
    (void)old_count;
    for (size_t i = 0; i < count; i++) {
        samples[i] = old;
    }
}

static void free_samples(const struct ddsi_sertype *type, void **samples, size_t count, dds_free_op_t operation)
{
    (void)type;
    (void)samples;
    (void)count;
    (void)operation;
}

/** CycloneDDS compares only types with the same operations and the same name; these are equal. */
static bool equal_types(const struct ddsi_sertype *a, const struct ddsi_sertype *b)
{
    (void)a;
    (void)b;
    return true;
}

static uint32_t hash_of(const struct ddsi_sertype *type)
{
    (void)type;
    return 0;
}

static const struct ddsi_sertype_ops type_operations = {
    .version = ddsi_sertype_v0,
    .free = free_type,
    .zero_samples = zero_samples,
    .realloc_samples = realloc_samples,
    .free_samples = free_samples,
    .equal = equal_types,
    .hash = hash_of,
};

/* Functions for the other files -------------------------------------------------------------------------------- */

dds_entity_t epg_dds_topic(dds_entity_t participant, const char *name, const char *type_name,
                           struct ddsi_sertype **type)
{
    *type = calloc(1, sizeof **type);
    if (*type == NULL) {
        return DDS_RETCODE_OUT_OF_RESOURCES;
    }
    ddsi_sertype_init_flags(*type, type_name, &type_operations, &message_operations,
                            DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
    (*type)->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1; /* as in ROS 2 */
    struct ddsi_sertype *own = *type;
    const dds_entity_t topic = dds_create_topic_sertype(participant, name, type, NULL, NULL, NULL);
    if (topic < 0) {
        ddsi_sertype_unref(own);
    }
    return topic;
}

dds_return_t epg_dds_write(dds_entity_t writer, const struct ddsi_sertype *type, const void *data, size_t size)
{
    message_t *message = new_message(type, SDK_DATA, HEADER + size);
    if (message == NULL) {
        return DDS_RETCODE_OUT_OF_RESOURCES;
    }
    message->bytes[1] = LITTLE_ENDIAN_CDR;
    memcpy(message->bytes + HEADER, data, size);
    return dds_writecdr(writer, &message->base); /* from here on, the message belongs to CycloneDDS */
}

const void *epg_dds_content(const struct ddsi_serdata *base, size_t *size)
{
    const message_t *message = (const message_t *)base;
    if (base->kind != SDK_DATA || message->size < HEADER) {
        return NULL;
    }
    const unsigned int identifier = ((unsigned int)message->bytes[0] << 8U) | message->bytes[1];
    const size_t padding = message->bytes[3] & 3U;
    if (identifier != LITTLE_ENDIAN_CDR || message->size < HEADER + padding) {
        return NULL;
    }
    *size = message->size - HEADER - padding;
    return message->bytes + HEADER;
}
