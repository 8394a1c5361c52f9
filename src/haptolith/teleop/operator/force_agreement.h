#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "haptolith/core/vec.h"

namespace haptolith {

/// Sums of the displayed force of each tick, before the limits of the device, because a hand limited to 12 N cannot
/// judge a model: its mean over any stretch of the last half minute costs two reads. Not for
/// the tick.
class DisplayedForceTrack {
 public:
  static constexpr std::uint64_t kTicks = 1U << 15U;

  /// Adds the force of tick `index`; consecutive, from 0.
  void add(std::uint64_t index, const Vec3& force_n);
  /// Mean over the ticks from + 1 to `to`; none: it is over, not yet, or of no length.
  [[nodiscard]] std::optional<Vec3> mean(std::uint64_t from, std::uint64_t to) const;

 private:
  std::vector<Vec3> sums_ = std::vector<Vec3>(kTicks, Vec3::Zero());
  std::uint64_t next_ = 0;
};

/// Displayed and remote force at one command.
struct AgreementPoint {
  double time_s = 0;  ///< central time of the commands
  Vec3 displayed_n, met_n;
};

/// Agreement of both: in windows of a fifth of a second, because single impacts of particles differ between
/// realisations of one soil.
///
///     share = sqrt(sum |felt - met|^2 / sum |met|^2)         over windows of which at least half is known
class ForceAgreement {
 public:
  static constexpr double kWindow_s = 0.2;

  /// Means over a stretch of commands; stretches may come in any order, each once.
  void add(double end_s, double stretch_s, const Vec3& displayed_n, const Vec3& met_n);

  /// In order of time.
  [[nodiscard]] std::vector<AgreementPoint> windows() const;
  /// RMS of the difference over RMS of what was met, of the windows between two times; NaN: nothing was met.
  [[nodiscard]] double share(double from_s, double to_s) const;
  [[nodiscard]] double rmsMet(double from_s, double to_s) const;         ///< N
  [[nodiscard]] double rmsDifference(double from_s, double to_s) const;  ///< N

 private:
  struct Window {
    double known_s = 0;
    Vec3 displayed_ns = Vec3::Zero(), met_ns = Vec3::Zero();
  };
  std::map<std::int64_t, Window> windows_;  ///< by their number
};

}  // namespace haptolith
