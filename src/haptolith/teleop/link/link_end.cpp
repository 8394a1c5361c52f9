#include "haptolith/teleop/link/link_end.h"

#include <random>

#include "haptolith/core/error.h"
#include "haptolith/core/plain_text.h"
#include "haptolith/teleop/link/udp_address.h"

namespace haptolith {

std::uint32_t newConnection() {
  std::random_device random;
  std::uint32_t connection = 0;
  while (connection == 0) {
    connection = random();
  }
  return connection;
}

void requireSafe(const char* key, const std::string& address, const EndOptions& options) {
  const bool here = endpointOf(key, address).address().is_loopback();
  if (!here && options.key.empty() && !options.insecure) {
    throw InvalidParameter(
        key, inQuotes(address),
        "an address of this machine only, such as 127.0.0.1:7410, unless packets are signed (--key-file, "
        "docs/how-to/teleoperate.md) or all users of the network are trusted (--insecure)");
  }
}

}  // namespace haptolith
