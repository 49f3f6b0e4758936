/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Warnings about incompatible QoS.
 */
#include "matching.h"

#include <stdio.h>

#include "epg/host_log.h"

/** Returns ROS 2's name of the incompatible policy. */
static const char *policy_name(uint32_t policy)
{
    switch (policy) {
    case DDS_RELIABILITY_QOS_POLICY_ID:
        return "reliability";
    case DDS_DURABILITY_QOS_POLICY_ID:
        return "durability";
    case DDS_DEADLINE_QOS_POLICY_ID:
        return "deadline";
    case DDS_LIVELINESS_QOS_POLICY_ID:
        return "liveliness";
    case DDS_OWNERSHIP_QOS_POLICY_ID:
        return "ownership";
    case DDS_DATA_REPRESENTATION_QOS_POLICY_ID:
        return "data representation";
    default:
        return "quality of service";
    }
}

void epg_dds_check_writer(dds_entity_t writer, const char *name)
{
    dds_offered_incompatible_qos_status_t status;
    if (dds_get_offered_incompatible_qos_status(writer, &status) == DDS_RETCODE_OK && status.total_count_change > 0 &&
        epg_host_logs(EPG_HOST_LOG_WARN)) {
        const bool reliability = status.last_policy_id == DDS_RELIABILITY_QOS_POLICY_ID;
        fprintf(stderr,
                "warning: a subscription of %s requests another %s than this node offers: it receives no messages\n%s",
                name, policy_name(status.last_policy_id),
                reliability ? "hint: it requests 'reliable': let it request 'best effort', or remove "
                              "'qos: best_effort' from the publisher in the .tcf\n"
                            : "");
    }
}

void epg_dds_check_reader(dds_entity_t reader, const char *name)
{
    dds_requested_incompatible_qos_status_t status;
    if (dds_get_requested_incompatible_qos_status(reader, &status) == DDS_RETCODE_OK && status.total_count_change > 0 &&
        epg_host_logs(EPG_HOST_LOG_WARN)) {
        const bool reliability = status.last_policy_id == DDS_RELIABILITY_QOS_POLICY_ID;
        fprintf(
            stderr,
            "warning: a publication of %s offers another %s than this node requests: its messages do not arrive\n%s",
            name, policy_name(status.last_policy_id),
            reliability ? "hint: it offers 'best effort': let it offer 'reliable', or write 'qos: best_effort' for "
                          "the subscriber in the .tcf\n"
                        : "");
    }
}
