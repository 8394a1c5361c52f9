#include "fast_dds_peer.h"

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <map>
#include <stdexcept>
#include <thread>
#include <utility>

// Fast DDS leaks memory in its statistics (2.9.1), independent of haptolith.
extern "C" __attribute__((visibility("default"))) const char* __asan_default_options() {  // NOLINT: its name
  return "new_delete_type_mismatch=0";
}

namespace haptolith {

namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

/// Bytes that go by a type's name.
class BytesType final : public dds::TopicDataType {
 public:
  explicit BytesType(const std::string& name) {
    constexpr std::uint32_t kLargest = 1 << 20;
    setName(name.c_str());
    m_typeSize = kLargest;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes(); }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

class Listener final : public dds::DataReaderListener {
 public:
  explicit Listener(std::function<void(const Bytes&)> heard) : heard_(std::move(heard)) {}
  void on_data_available(dds::DataReader* reader) override {
    Bytes bytes;
    dds::SampleInfo info;
    while (reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) {
        heard_(bytes);
      }
    }
  }

 private:
  std::function<void(const Bytes&)> heard_;
};

template <class Qos>
void setQos(Qos& qos, PeerQos kind) {
  qos.reliability().kind =
      kind == PeerQos::kBestEffort ? dds::BEST_EFFORT_RELIABILITY_QOS : dds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind =
      kind == PeerQos::kLatched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 100;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

template <class Thing>
Thing* made(Thing* thing) {
  if (thing == nullptr) {
    throw std::runtime_error("Fast DDS makes no participant, topic, reader or writer");
  }
  return thing;
}

}  // namespace

class FastDdsPeer::Implementation {
 public:
  explicit Implementation(int domain) {
    dds::DomainParticipantQos qos;
    qos.transport().use_builtin_transports =
        false;  // no shared memory: what is to be tested is what goes over a network
    const auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    transport->interfaceWhiteList.emplace_back("127.0.0.1");
    qos.transport().user_transports.push_back(transport);
    rtps::Locator_t here;
    rtps::IPLocator::setIPv4(here, "127.0.0.1");
    qos.wire_protocol().builtin.initialPeersList.push_back(here);
    participant = made(
        dds::DomainParticipantFactory::get_instance()->create_participant(static_cast<std::uint32_t>(domain), qos));
    publisher = made(participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT));
    subscriber = made(participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT));
  }
  ~Implementation() {
    participant->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  dds::Topic* topic(const std::string& name, const std::string& type) {
    dds::Topic*& known = topics[name];
    if (known == nullptr) {
      dds::TypeSupport(new BytesType(type)).register_type(participant);
      known = made(participant->create_topic(name, type, dds::TOPIC_QOS_DEFAULT));
    }
    return known;
  }
  void listen(dds::Topic* topic, PeerQos kind, std::function<void(const Bytes&)> heard) {
    dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
    setQos(qos, kind);
    listeners.push_back(std::make_unique<Listener>(std::move(heard)));
    readers.push_back(made(subscriber->create_datareader(topic, qos, listeners.back().get())));
  }
  std::size_t makeWriter(dds::Topic* topic, PeerQos kind) {
    dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
    setQos(qos, kind);
    writers.push_back(made(publisher->create_datawriter(topic, qos)));
    return writers.size() - 1;
  }

  dds::DomainParticipant* participant = nullptr;
  dds::Publisher* publisher = nullptr;
  dds::Subscriber* subscriber = nullptr;
  std::map<std::string, dds::Topic*> topics;
  std::vector<std::unique_ptr<Listener>> listeners;
  std::vector<dds::DataReader*> readers;
  std::vector<dds::DataWriter*> writers;
};

FastDdsPeer::FastDdsPeer(int domain) : implementation_(std::make_unique<Implementation>(domain)) {}
FastDdsPeer::~FastDdsPeer() = default;

void FastDdsPeer::listen(const std::string& topic, const std::string& type, PeerQos qos,
                         std::function<void(const Bytes&)> heard) {
  implementation_->listen(implementation_->topic(topic, type), qos, std::move(heard));
}

std::size_t FastDdsPeer::makeWriter(const std::string& topic, const std::string& type, PeerQos qos) {
  return implementation_->makeWriter(implementation_->topic(topic, type), qos);
}

void FastDdsPeer::write(std::size_t writer, const Bytes& payload) {
  Bytes bytes = payload;
  implementation_->writers[writer]->write(&bytes);
}

int FastDdsPeer::readersOf(std::size_t writer) const {
  dds::PublicationMatchedStatus status;
  implementation_->writers[writer]->get_publication_matched_status(status);
  return status.current_count;
}

int FastDdsPeer::writersFound() const {
  int found = 0;
  for (dds::DataReader* reader : implementation_->readers) {
    dds::SubscriptionMatchedStatus status;
    reader->get_subscription_matched_status(status);
    found += status.current_count;
  }
  return found;
}

int someDomain() {
  constexpr int kDomains = 100;  // whose ports lie below those that the system gives away
  return 1 + static_cast<int>(::getpid()) % kDomains;
}

bool eventually(const std::function<bool()>& happened) {
  using namespace std::chrono_literals;
  const auto until = std::chrono::steady_clock::now() + 10s;
  while (!happened()) {
    if (std::chrono::steady_clock::now() > until) {
      return false;
    }
    std::this_thread::sleep_for(1ms);
  }
  return true;
}

}  // namespace haptolith
