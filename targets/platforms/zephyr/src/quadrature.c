/**
 * @file
 * Quadrature decoders: devices of the sensor API that give their count (epg/zephyr/qdec.h).
 */
#include <epg/zephyr/qdec.h>

#include "epg/port.h"
#include "parts.h"

/** Decoders of one target; the chips have fewer. */
#define DECODERS 16U

/* By row of the table: what the last reading gave. */
static struct {
    uint32_t count;
    bool healthy;
} newest[DECODERS];

static const epg_zephyr_decoder_t *find(const epg_port_quadrature_t *decoder, size_t *row)
{
    for (size_t i = 0; i < epg_zephyr_hardware.decoder_count && i < DECODERS; i++) {
        const epg_zephyr_decoder_t *candidate = &epg_zephyr_hardware.decoders[i];
        if (candidate->block == decoder->block && candidate->unit == decoder->unit) {
            *row = i;
            return candidate;
        }
    }
    return NULL;
}

uint32_t epg_port_quadrature_count(const epg_port_quadrature_t *decoder)
{
    size_t row = 0;
    const epg_zephyr_decoder_t *found = find(decoder, &row);
    int64_t count = 0;
    if (found == NULL) {
        return 0;
    }
    newest[row].healthy = qdec_get_count(found->device, &count) == 0;
    if (newest[row].healthy) {
        newest[row].count = (uint32_t)count;
    }
    return newest[row].count;
}

void epg_port_quadrature_start(const epg_port_quadrature_t *decoder)
{
    (void)epg_port_quadrature_count(decoder);
    if (!epg_port_quadrature_healthy(decoder)) {
        epg_zephyr_device_refused = true;
    }
}

bool epg_port_quadrature_healthy(const epg_port_quadrature_t *decoder)
{
    size_t row = 0;
    return find(decoder, &row) != NULL && newest[row].healthy;
}
