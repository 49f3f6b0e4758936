/* The station: a lamp, and the turntable. */
#include <zephyr/kernel.h>
#include <zephyr/logging/log.h>

#include "lamp.h"

/* --- the encoder's decoder, by EPG --- */
#include <epg/zephyr/qdec.h>

static const struct device *const turntable = DEVICE_DT_GET(DT_NODELABEL(turntable));
/* --- */

/* --- the turntable's controller, by EPG --- */
#include "turntable.h"
/* --- */

LOG_MODULE_REGISTER(station);

int main(void)
{
    if (lamp_start() < 0) {
        LOG_ERR("there is no lamp");
        return 0;
    }
    /* --- the turntable's controller, by EPG --- */
    if (!turntable_start()) {
        LOG_ERR("the turntable's controller cannot be started");
    }
    /* --- */
    for (unsigned seconds = 0;; seconds++) {
        lamp_set(seconds % 2 == 0);
        /* --- the encoder's decoder, by EPG --- */
        int64_t count = 0;

        if (epg_qdec_get_count(turntable, &count) == 0) {
            LOG_INF("the turntable is at %lld counts", (long long)count);
        }
        /* --- */
        k_sleep(K_SECONDS(1));
    }
}
