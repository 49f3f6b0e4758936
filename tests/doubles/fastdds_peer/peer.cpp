/**
 * A peer with Fast DDS on the loopback interface.
 *
 *   fastdds_peer DOMAIN SECONDS reader|writer|best_effort_reader|best_effort_writer TOPIC ...
 *
 * Readers report the messages they receive, writers write 0.25 every 33 ms, as std_msgs/msg/Float64 with the QoS of
 * rmw_fastrtps.  Prints at the end, one per line:
 *
 *   heard rt/pan_publisher 59 0.001        number of messages, and the last value
 *   matched rt/pan_subscriber 1            largest number of readers of a writer, or of writers of a reader
 *   discovered writer rt/pan_publisher std_msgs::msg::dds_::Float64_ typehash=RIHS01_...;
 *   discovery_info ...                     the newest message of topic ros_discovery_info, in hexadecimal digits
 */
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

using Bytes = std::vector<unsigned char>;

/** Messages of any type: the bytes after the encapsulation header. */
class BytesType : public TopicDataType
{
  public:
    explicit BytesType(const char *name)
    {
        setName(name);
        m_typeSize = 65536;
        m_isGetKeyDefined = false;
    }

    bool serialize(void *data, SerializedPayload_t *payload) override
    {
        const Bytes &bytes = *static_cast<Bytes *>(data);
        const unsigned char header[4] = {0, 1, 0, 0};
        std::memcpy(payload->data, header, sizeof header);
        std::memcpy(payload->data + sizeof header, bytes.data(), bytes.size());
        payload->encapsulation = CDR_LE;
        payload->length = static_cast<uint32_t>(sizeof header + bytes.size());
        return true;
    }

    bool deserialize(SerializedPayload_t *payload, void *data) override
    {
        static_cast<Bytes *>(data)->assign(payload->data + 4, payload->data + payload->length);
        return true;
    }

    std::function<uint32_t()> getSerializedSizeProvider(void *data) override
    {
        const auto size = static_cast<uint32_t>(static_cast<Bytes *>(data)->size() + 4);
        return [size] { return size; };
    }

    void *createData() override
    {
        return new Bytes;
    }

    void deleteData(void *data) override
    {
        delete static_cast<Bytes *>(data);
    }

    bool getKey(void *, InstanceHandle_t *, bool) override
    {
        return false;
    }
};

class Discovery : public DomainParticipantListener
{
  public:
    std::mutex mutex;
    std::set<std::string> lines;

    void on_publisher_discovery(DomainParticipant *, eprosima::fastrtps::rtps::WriterDiscoveryInfo &&info) override
    {
        add("writer", info.info.topicName().to_string(), info.info.typeName().to_string(), info.info.m_qos.m_userData);
    }

    void on_subscriber_discovery(DomainParticipant *, eprosima::fastrtps::rtps::ReaderDiscoveryInfo &&info) override
    {
        add("reader", info.info.topicName().to_string(), info.info.typeName().to_string(), info.info.m_qos.m_userData);
    }

  private:
    void add(const char *kind, const std::string &topic, const std::string &type, const UserDataQosPolicy &data)
    {
        const std::lock_guard<std::mutex> guard(mutex);
        const std::string text(data.begin(), data.end());
        lines.insert(std::string("discovered ") + kind + " " + topic + " " + type + " " + text);
    }
};

struct End {
    std::string topic;
    DataReader *reader = nullptr;
    DataWriter *writer = nullptr;
    int heard = 0;
    int matched = 0;
    double last = 0.0;
};

/** Loopback only, no shared memory, like the robots of the tests. */
static DomainParticipantQos participant_qos()
{
    DomainParticipantQos qos;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.push_back("127.0.0.1");
    qos.transport().user_transports.push_back(udp);
    qos.transport().use_builtin_transports = false;
    return qos;
}

int main(int argc, char **argv)
{
    if (argc < 3) {
        return 2;
    }
    Discovery discovery;
    const auto domain = static_cast<uint32_t>(std::stoul(argv[1]));
    const double seconds = std::stod(argv[2]);
    DomainParticipant *participant = DomainParticipantFactory::get_instance()->create_participant(
        domain, participant_qos(), &discovery, StatusMask::none());
    TypeSupport number(new BytesType("std_msgs::msg::dds_::Float64_"));
    TypeSupport info(new BytesType("rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"));
    participant->register_type(number);
    participant->register_type(info);
    Subscriber *subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
    Publisher *publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);

    DataReaderQos info_qos = DATAREADER_QOS_DEFAULT;
    info_qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    info_qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
    info_qos.history().kind = KEEP_ALL_HISTORY_QOS;
    Topic *info_topic = participant->create_topic("ros_discovery_info", info.get_type_name(), TOPIC_QOS_DEFAULT);
    DataReader *info_reader = subscriber->create_datareader(info_topic, info_qos);

    std::vector<End> ends;
    std::map<std::string, Topic *> topics;
    for (int i = 3; i + 1 < argc; i += 2) {
        const std::string kind = argv[i];
        const auto reliability =
            kind.rfind("best_effort", 0) == 0 ? BEST_EFFORT_RELIABILITY_QOS : RELIABLE_RELIABILITY_QOS;
        End end;
        end.topic = argv[i + 1];
        Topic *&topic = topics[end.topic];
        if (topic == nullptr) {
            topic = participant->create_topic(end.topic, number.get_type_name(), TOPIC_QOS_DEFAULT);
        }
        if (kind.find("reader") != std::string::npos) {
            DataReaderQos qos = DATAREADER_QOS_DEFAULT;
            qos.reliability().kind = reliability;
            qos.history().depth = 10;
            end.reader = subscriber->create_datareader(topic, qos);
        } else {
            DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
            qos.reliability().kind = reliability;
            qos.history().depth = 10;
            end.writer = publisher->create_datawriter(topic, qos);
        }
        ends.push_back(end);
    }

    Bytes newest_info;
    SampleInfo sample;
    Bytes bytes;
    for (int turn = 0; turn < seconds / 0.033; turn++) {
        for (End &end : ends) {
            if (end.writer != nullptr) {
                Bytes message(8);
                const double value = 0.25;
                std::memcpy(message.data(), &value, sizeof value);
                end.writer->write(&message);
                PublicationMatchedStatus status;
                end.writer->get_publication_matched_status(status);
                end.matched = std::max(end.matched, status.current_count);
                continue;
            }
            SubscriptionMatchedStatus status;
            end.reader->get_subscription_matched_status(status);
            end.matched = std::max(end.matched, status.current_count);
            while (end.reader->take_next_sample(&bytes, &sample) == ReturnCode_t::RETCODE_OK) {
                if (sample.valid_data && bytes.size() >= sizeof end.last) {
                    std::memcpy(&end.last, bytes.data(), sizeof end.last);
                    end.heard++;
                }
            }
        }
        while (info_reader->take_next_sample(&bytes, &sample) == ReturnCode_t::RETCODE_OK) {
            if (sample.valid_data) {
                newest_info = bytes;
            }
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(33)); // the period of the peer
    }
    for (const End &end : ends) {
        std::printf("matched %s %d\n", end.topic.c_str(), end.matched);
        if (end.reader != nullptr) {
            std::printf("heard %s %d %.17g\n", end.topic.c_str(), end.heard, end.last);
        }
    }
    participant->set_listener(nullptr); /* from here on, events are not reported */
    for (const std::string &line : discovery.lines) {
        std::printf("%s\n", line.c_str());
    }
    std::printf("discovery_info ");
    for (const unsigned char byte : newest_info) {
        std::printf("%02x", byte);
    }
    std::printf("\n");
    std::fflush(stdout);
    participant->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant);
    return 0;
}
