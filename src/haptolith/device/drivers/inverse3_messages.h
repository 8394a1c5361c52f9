#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/vec.h"

namespace haptolith {

/// Key of the Haply service for a force: "vector" since 3.5, under "values" before.
enum class HaplyDialect { kVector, kValues };

/// The first message of a session: what is plugged in.
struct HaplyInventory {
  std::vector<std::string> devices;  ///< the Inverse3s' ids, in the service's order
  std::vector<std::string> grips;    ///< the wireless VerseGrips' ids
  HaplyDialect dialect = HaplyDialect::kValues;
};

/// State of one Inverse3 in a message, in its own right-handed frame, z up.
struct Inverse3State {
  Vec3 position_m = Vec3::Zero();
  Vec3 velocity_m_s = Vec3::Zero();
  std::optional<Quat> orientation;       ///< orientation of the grip; empty without a grip or a unit quaternion
  std::optional<std::uint32_t> buttons;  ///< buttons of the grip: bits 0, 1, 2 for a, b, c
};

/// Reads an inventory; empty when it is not a JSON object. An entry without an id of at most 64 characters is left out.
/// The dialect follows from keys that version 3.5 added: a configured basis, mount, preset or filters, and the
/// session's number; without any of them, or in doubt, the older dialect is used. Source: docs.haply.co, Inverse
/// Service 3.5, "WebSocket Protocol" and the change log of 3.5.0. Not for the tick.
[[nodiscard]] std::optional<HaplyInventory> parseHaplyInventory(std::string_view json);

/// Reads the state of a device, and of a grip when `grip` is not empty; none when the message is no JSON, does not name
/// the device, or has no position or velocity of three finite numbers within 2 m and 50 m/s: an Inverse3's arm reaches
/// a quarter of the one. Not for the tick.
[[nodiscard]] std::optional<Inverse3State> parseInverse3State(std::string_view json, std::string_view device,
                                                              std::string_view grip);

/// The command that shows a force until the next one. Not for the tick.
[[nodiscard]] std::string inverse3Command(std::string_view device, const Vec3& force_n, HaplyDialect dialect);

}  // namespace haptolith
