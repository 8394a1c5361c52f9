#include "haptolith/ros2/ros2_node.h"

#include <dds/dds.h>
#include <fmt/format.h>
#include <ros2_messages.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <utility>
#include <vector>

#include "haptolith/core/plain_text.h"
#include "haptolith/core/platform/this_program.h"

namespace haptolith {

namespace {

constexpr const char* kDiscoveryTopic = "ros_discovery_info";  // the only topic without a prefix
constexpr const char* kDiscoveryType = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

// Cyclone DDS's own defaults come after it, so that CYCLONEDDS_URI has the last word. The loopback interface has no
// multicast on most systems: participants there find each other by the ports of the first of them.
constexpr const char* kLocalhost =
    R"(<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo"/></Interfaces>)"
    R"(<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>)"
    R"(<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers><Peer address="localhost"/></Peers></Discovery>)"
    R"(</Domain></CycloneDDS>)";

/// Neither peers nor multicast, and a tag that no other process has: this participant finds none and is found by none.
std::string discoveryOff() {
  return fmt::format(
      R"(<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo"/></Interfaces>)"
      R"(<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>none</ParticipantIndex>)"
      R"(<Tag>haptolith-discovery-off-{}</Tag></Discovery></Domain></CycloneDDS>)",
      processNumber());
}

// DDS reports each malformed message, and any sender may send any number of those.
constexpr int kMostLines = 20;

/// The newest line of DDS's log: why it does not make something.
struct LastLine {
  std::mutex mutex;
  std::string text;
};
LastLine& lastLine() {
  static LastLine line;
  return line;
}

void printFirstLines(void* /*unused*/, const dds_log_data_t* line) {
  static std::atomic<int> lines{0};
  std::string text = plainText({line->message, line->size}, Lines::kSeveral);
  while (text.ends_with('\n')) {
    text.pop_back();
  }
  if (const int before = lines.fetch_add(1); before < kMostLines) {
    fmt::print(stderr, "DDS: {}\n{}", text, before + 1 == kMostLines ? "DDS: further messages are not shown\n" : "");
  }
  const std::lock_guard lock(lastLine().mutex);
  lastLine().text = std::move(text);
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

int domainFrom(const std::optional<int>& asked) {
  if (asked) {
    requireInRange("domain", *asked, Ros2Ranges::domain);
    return *asked;
  }
  const std::string text = environment("ROS_DOMAIN_ID");
  if (text.empty()) {
    return 0;
  }
  int domain = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
  if (error != std::errc{} || end != text.data() + text.size() || !Ros2Ranges::domain.contains(domain)) {
    throw InvalidParameter("ROS_DOMAIN_ID", inQuotes(text),
                           fmt::format("a whole number, {}", Ros2Ranges::domain.text()));
  }
  return domain;
}

/// Cyclone DDS's configuration for what may be discovered; empty: all that the network reaches. Words are read as ROS 2
/// writes them; another one would open the node to the network without a word. @throws InvalidParameter for it.
std::string discovery(const Ros2Parameters& parameters) {
  const std::string only_local = environment("ROS_LOCALHOST_ONLY");
  const std::string range = environment("ROS_AUTOMATIC_DISCOVERY_RANGE");
  if (!only_local.empty() && only_local != "0" && only_local != "1") {
    throw InvalidParameter("ROS_LOCALHOST_ONLY", inQuotes(only_local), "0 or 1");
  }
  constexpr std::array<std::string_view, 5> kRanges{"", "SUBNET", "SYSTEM_DEFAULT", "LOCALHOST", "OFF"};
  if (std::ranges::find(kRanges, range) == kRanges.end()) {
    throw InvalidParameter("ROS_AUTOMATIC_DISCOVERY_RANGE", inQuotes(range),
                           "OFF, LOCALHOST, SUBNET or SYSTEM_DEFAULT, in capitals");
  }
  if (parameters.localhost) {
    return kLocalhost;
  }
  if (range == "OFF") {
    return discoveryOff();
  }
  return range == "LOCALHOST" || only_local == "1" ? kLocalhost : "";
}

bool isHumble(const Ros2Parameters& parameters) {
  const std::string distribution = environment("ROS_DISTRO");
  return parameters.humble.value_or(distribution == "humble" || distribution == "galactic" || distribution == "foxy");
}

dds_entity_t made(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    const std::lock_guard lock(lastLine().mutex);
    const std::string& reason = lastLine().text;
    throw Failure(
        fmt::format("DDS cannot make a {}: {}{}{}; check CYCLONEDDS_URI, the network, and the number of nodes in the "
                    "domain (at most 33 with --localhost)",
                    what, dds_strretcode(entity), reason.empty() ? "" : ": ", reason));
  }
  return entity;
}

struct FreeQos {
  void operator()(dds_qos_t* qos) const noexcept { dds_delete_qos(qos); }
};
using QosPointer = std::unique_ptr<dds_qos_t, FreeQos>;

QosPointer qosOf(Ros2Qos kind) {
  constexpr std::int32_t kStreamDepth = 5;  // ROS 2's profile for sensor data
  QosPointer qos(dds_create_qos());
  const bool stream = kind == Ros2Qos::kStream;
  dds_qset_reliability(qos.get(), stream ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_durability(qos.get(), kind == Ros2Qos::kLatched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, stream ? kStreamDepth : 1);
  // The representation of ROS 2 and Fast DDS 2; without it each vendor chooses.
  const dds_data_representation_id_t plain = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &plain);
  return qos;
}

/// Announcement of one node to the graph, in either layout.
template <class Info, class Node, class Gid>
Info infoOf(const Ros2Name& name, dds_entity_t participant, std::vector<Gid>& readers, std::vector<Gid>& writers,
            Node& node) {
  const auto sequence = [](auto& into, std::vector<Gid>& from) {
    into._maximum = into._length = static_cast<std::uint32_t>(from.size());
    into._buffer = from.data();
    into._release = false;
  };
  Info info{};
  dds_guid_t guid{};
  dds_get_guid(participant, &guid);
  std::memcpy(info.gid.data, guid.v, sizeof guid.v);
  // DDS only reads the data it writes.
  node.node_namespace =
      const_cast<char*>(name.node_namespace.c_str());     // NOLINT(cppcoreguidelines-pro-type-const-cast)
  node.node_name = const_cast<char*>(name.node.c_str());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  sequence(node.reader_gid_seq, readers);
  sequence(node.writer_gid_seq, writers);
  info.node_entities_info_seq._maximum = info.node_entities_info_seq._length = 1;
  info.node_entities_info_seq._buffer = &node;
  info.node_entities_info_seq._release = false;
  return info;
}

template <class Gid>
std::vector<Gid> gidsOf(const std::vector<dds_entity_t>& endpoints) {
  std::vector<Gid> gids;
  for (const dds_entity_t endpoint : endpoints) {
    dds_guid_t guid{};
    dds_get_guid(endpoint, &guid);
    Gid& gid = gids.emplace_back();
    std::memcpy(gid.data, guid.v, sizeof guid.v);  // the rest, up to Humble, is zero
  }
  return gids;
}

}  // namespace

struct Ros2Node::Graph {
  dds_entity_t domain = 0, participant = 0, discovery = 0;
  std::vector<dds_entity_t> readers, writers;
  bool humble = false;
};

Ros2Node::Ros2Node(const Ros2Parameters& parameters)
    : parameters_(parameters), domain_(domainFrom(parameters.domain)), graph_(std::make_unique<Graph>()) {
  validate(parameters_.name);
  dds_set_log_sink(printFirstLines, nullptr);
  graph_->humble = isHumble(parameters_);
  const auto domain = static_cast<dds_domainid_t>(domain_);
  if (const std::string found = discovery(parameters_); !found.empty()) {
    const std::string own = environment("CYCLONEDDS_URI");
    const std::string configuration = own.empty() ? found : fmt::format("{},{}", found, own);
    const dds_entity_t made_domain = dds_create_domain(domain, configuration.c_str());
    if (made_domain != DDS_RETCODE_PRECONDITION_NOT_MET) {  // else another node of this program has made it
      graph_->domain = made(made_domain, "domain");
    }
  }
  const QosPointer qos(dds_create_qos());
  constexpr std::string_view kEnclave = "enclave=/;";  // without it ROS 2 does not accept a participant as its own
  dds_qset_userdata(qos.get(), kEnclave.data(), kEnclave.size());
  graph_->participant = made(dds_create_participant(domain, qos.get(), nullptr), "participant");
  dds_topic_descriptor type = graph_->humble ? haptolith_humble_ParticipantEntitiesInfo__desc
                                             : rmw_dds_common_msg_dds__ParticipantEntitiesInfo__desc;
  type.m_typename = kDiscoveryType;
  const dds_entity_t topic = makeTopic(type, kDiscoveryTopic);
  graph_->discovery =
      made(dds_create_writer(graph_->participant, topic, qosOf(Ros2Qos::kLatched).get(), nullptr), "writer");
}

Ros2Node::~Ros2Node() {
  dds_delete(graph_->participant);
  if (graph_->domain > 0) {
    dds_delete(graph_->domain);
  }
}

std::int32_t Ros2Node::makeTopic(const dds_topic_descriptor& type, const std::string& name) {
  return made(dds_create_topic(graph_->participant, &type, name.c_str(), nullptr, nullptr), "topic");
}

std::int32_t Ros2Node::makeWriter(const dds_topic_descriptor& type, std::string_view topic, Ros2Qos qos) {
  const dds_entity_t made_topic = makeTopic(type, ddsTopic(parameters_.name.topic(topic)));
  graph_->writers.push_back(
      made(dds_create_writer(graph_->participant, made_topic, qosOf(qos).get(), nullptr), "writer"));
  return graph_->writers.back();
}

std::int32_t Ros2Node::makeReader(const dds_topic_descriptor& type, std::string_view topic, Ros2Qos qos) {
  const dds_entity_t made_topic = makeTopic(type, ddsTopic(parameters_.name.topic(topic)));
  graph_->readers.push_back(
      made(dds_create_reader(graph_->participant, made_topic, qosOf(qos).get(), nullptr), "reader"));
  return graph_->readers.back();
}

void Ros2Node::announce() {
  const auto tell = [&](auto node, auto info, auto gid) {
    using Gid = decltype(gid);
    auto readers = gidsOf<Gid>(graph_->readers);
    auto writers = gidsOf<Gid>(graph_->writers);
    info = infoOf<decltype(info)>(parameters_.name, graph_->participant, readers, writers, node);
    return dds_write(graph_->discovery, &info);
  };
  const dds_return_t told =
      graph_->humble ? tell(haptolith_humble_NodeEntitiesInfo_{}, haptolith_humble_ParticipantEntitiesInfo_{},
                            haptolith_humble_Gid_{})
                     : tell(rmw_dds_common_msg_dds__NodeEntitiesInfo_{},
                            rmw_dds_common_msg_dds__ParticipantEntitiesInfo_{}, rmw_dds_common_msg_dds__Gid_{});
  if (told < 0) {
    throw Failure(fmt::format("DDS does not publish the graph of this node: {}", dds_strretcode(told)));
  }
}

std::string Ros2Node::text() const {
  const std::string& above = parameters_.name.node_namespace;
  return fmt::format("{}{}{} in domain {}", above, above == "/" ? "" : "/", parameters_.name.node, domain_);
}

}  // namespace haptolith
