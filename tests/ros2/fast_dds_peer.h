#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cdr.h"

namespace haptolith {

enum class PeerQos { kBestEffort, kReliable, kLatched };

/// Another program in a DDS domain, by another vendor's DDS (eProsima Fast DDS), on this machine alone. It knows our
/// types by their names only: messages go in and out as bytes.
class FastDdsPeer {
 public:
  explicit FastDdsPeer(int domain);
  ~FastDdsPeer();
  FastDdsPeer(const FastDdsPeer&) = delete;
  FastDdsPeer& operator=(const FastDdsPeer&) = delete;

  /// @param topic, type  as DDS calls them: "rt/tf", "tf2_msgs::msg::dds_::TFMessage_".
  /// @param heard  is called with the whole payload, on a thread of Fast DDS.
  void listen(const std::string& topic, const std::string& type, PeerQos qos, std::function<void(const Bytes&)> heard);
  /// A writer; write() by its number.
  std::size_t makeWriter(const std::string& topic, const std::string& type, PeerQos qos);
  void write(std::size_t writer, const Bytes& payload);
  /// Number of readers found by a writer, and of writers found by all readers.
  [[nodiscard]] int readersOf(std::size_t writer) const;
  [[nodiscard]] int writersFound() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// A domain that other tests on this machine are unlikely to use at the same time.
[[nodiscard]] int someDomain();

/// Waits for it, 10 s at most.
[[nodiscard]] bool eventually(const std::function<bool()>& happened);

}  // namespace haptolith
