// Messages from a robot network: CDR that Cyclone DDS accepts has a pose and a wrench that are refused or finite.

#include <dds/ddsi/ddsi_serdata.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "haptolith/ros2/dds_endpoint.h"

namespace {

void require(bool right) {
  if (!right) {
    std::abort();
  }
}

/// Returns the serialisation of a type in DDS, from a message that a writer sends to a reader in this process.
template <class Message>
const ddsi_sertype* serialised(dds_entity_t participant, const char* topic_name) {
  const dds_topic_descriptor& type = haptolith::typeOf(static_cast<const Message*>(nullptr));
  const dds_entity_t topic = dds_create_topic(participant, &type, topic_name, nullptr, nullptr);
  const dds_entity_t reader = dds_create_reader(participant, topic, nullptr, nullptr);
  const dds_entity_t writer = dds_create_writer(participant, topic, nullptr, nullptr);
  Message message{};
  char frame[] = "map";
  message.header.frame_id = frame;
  require(dds_write(writer, &message) >= 0);
  ddsi_serdata* kept = nullptr;  // never released, so that its type persists
  dds_sample_info_t info;
  require(dds_takecdr(reader, &kept, 1, &info, DDS_ANY_STATE) == 1);
  return kept->type;
}

dds_entity_t participant() {
  constexpr dds_domainid_t kDomain = 229;
  require(dds_create_domain(kDomain,
                            "<General><AllowMulticast>false</AllowMulticast>"
                            "<Interfaces><NetworkInterface name=\"lo\"/></Interfaces></General>") > 0);
  const dds_entity_t made = dds_create_participant(kDomain, nullptr, nullptr);
  require(made > 0);
  return made;
}

/// Calls check(message) if the bytes are a message.
template <class Message, class Check>
void read(const ddsi_sertype* type, const std::uint8_t* data, std::size_t size, const Check& check) {
  const ddsrt_iovec_t bytes{const_cast<std::uint8_t*>(data), size};  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  ddsi_serdata* const serialised = ddsi_serdata_from_ser_iov(type, SDK_DATA, 1, &bytes, size);
  if (serialised == nullptr) {
    return;
  }
  Message message{};
  if (ddsi_serdata_to_sample(serialised, &message, nullptr, nullptr)) {
    require(message.header.frame_id != nullptr && std::strlen(message.header.frame_id) < size);
    check(message);
  }
  dds_sample_free(&message, &haptolith::typeOf(static_cast<const Message*>(nullptr)), DDS_FREE_CONTENTS);
  ddsi_serdata_unref(serialised);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace haptolith;
  static const dds_entity_t kParticipant = participant();
  static const ddsi_sertype* const kPose = serialised<PoseMessage>(kParticipant, "pose");
  static const ddsi_sertype* const kWrench = serialised<WrenchMessage>(kParticipant, "wrench");
  constexpr std::size_t kEncapsulation = 4;
  if (size < kEncapsulation) {
    return 0;  // dropped by DDS
  }
  read<PoseMessage>(kPose, data, size, [](const PoseMessage& message) {
    if (const std::optional<Pose> pose = poseOf(message.pose)) {
      require(pose->position_m.allFinite() && std::abs(pose->orientation.norm() - 1) < 1e-12);
    }
  });
  read<WrenchMessage>(kWrench, data, size, [](const WrenchMessage& message) {
    if (const std::optional<Wrench> wrench = wrenchOf(message.wrench)) {
      require(wrench->force_n.allFinite() && wrench->torque_nm.allFinite());
    }
  });
  return 0;
}
