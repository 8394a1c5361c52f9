#include "haptolith/psychometrics/adaptive/staircase.h"

#include <boost/math/special_functions/erf.hpp>
#include <boost/math/tools/roots.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numbers>
#include <random>
#include <string_view>

#include "haptolith/core/assert.h"
#include "haptolith/core/error.h"

namespace haptolith {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Max. lead of a staircase over another, in responses; then it waits. With less, a participant who counts can predict
/// more turns than 1 in 8. With more, the trials of one side come late.
constexpr int kMostAhead = 4;

/// One staircase. Its ladder begins at the starting level, and correct responses lead along it.
struct Track {
  std::vector<double> ladder = {};
  std::size_t place = 0;
  int answers = 0;
  int right_in_a_row = 0;
  int wrong_in_a_row = 0;
  int direction = 0;  // direction of the last step: 1 forward, -1 back
  std::vector<double> reversals = {};
};

void requireOptions(const StaircaseOptions& options) {
  const auto require = [](std::string_view key, int value, int lowest) {
    requireInRange(key, value, {.lowest = double(lowest)});
  };
  requireInRange("staircases", options.staircases, {1, 10});
  require("down", options.down, options.target == StaircaseTarget::kDifference ? 2 : 1);
  require("up", options.up, 1);
  require("first_step", options.first_step, 1);
  require("step", options.step, 1);
  require("uncounted_reversals", options.uncounted_reversals, 0);
  require("reversals", options.reversals, options.uncounted_reversals + 1);
  require("most_trials", options.most_trials, 1);
}

/// Returns the probability of a correct response at which steps forward and back are equally likely: `down` correct
/// ones in a row come before `up` wrong ones in a row (Feller 1968, An Introduction to Probability Theory, section
/// VIII.1).
double settledShare(int down, int up) {
  HAPTO_ASSERT(down >= 1 && up >= 1);
  const auto excess = [&](double p) {
    const double on = std::pow(p, down - 1);
    const double back = std::pow(1 - p, up - 1);
    return on * (1 - std::pow(1 - p, up)) / (on + back - on * back) - 0.5;
  };
  const auto [low, high] =
      boost::math::tools::bisect(excess, 1e-9, 1 - 1e-9, boost::math::tools::eps_tolerance<double>(40));
  return (low + high) / 2;
}

class Staircase : public AdaptiveProcedure {
 public:
  Staircase(const StaircaseOptions& options, const std::vector<double>& levels, double reference)
      : options_(options), reference_(reference), random_(options.seed) {
    if (options.target == StaircaseTarget::kEquality) {
      addTracks({levels.rbegin(), levels.rend()});
    } else {
      const auto above = std::ranges::upper_bound(levels, reference);
      addTracks({levels.rbegin(), std::reverse_iterator(above)});
      addTracks({levels.begin(), std::ranges::lower_bound(levels, reference)});
    }
    drawTurn();
  }

  [[nodiscard]] std::optional<double> next() const override {
    if (trials_ >= options_.most_trials || turn_ == nullptr) {
      return std::nullopt;
    }
    return turn_->ladder[turn_->place];
  }

  void answer(double x, bool positive) override {
    Track& track = trackOf(x);
    track.place = static_cast<std::size_t>(std::ranges::find(track.ladder, x) - track.ladder.begin());
    const bool below = options_.target == StaircaseTarget::kDifference && x < reference_;
    step(track, positive != below);
    ++track.answers;
    ++trials_;
    drawTurn();
  }

  [[nodiscard]] std::optional<AdaptiveEstimate> estimate() const override {
    std::vector<double> means;  // one per side
    const auto of_a_side = static_cast<std::size_t>(options_.staircases);
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      if (std::ssize(tracks_[i].reversals) <= options_.uncounted_reversals) {
        return std::nullopt;
      }
      if (i % of_a_side == 0) {
        means.push_back(0);
      }
      means.back() += meanReversal(tracks_[i]) / options_.staircases;
    }
    if (options_.target == StaircaseTarget::kEquality) {
      return AdaptiveEstimate{fromAxis(means.front()), kNan};
    }
    const double middle = means.size() == 2 ? (means[0] + means[1]) / 2 : toAxis(reference_);
    const double distance = std::abs(means.front() - middle);
    // The fraction of correct responses is Phi(distance / sigma); the JND is one sigma.
    const double share = settledShare(options_.down, options_.up);
    const double sigma = distance / (std::numbers::sqrt2 * boost::math::erf_inv(2 * share - 1));
    return AdaptiveEstimate{fromAxis(middle), fromAxis(middle + sigma) - fromAxis(middle)};
  }

 private:
  void addTracks(const std::vector<double>& ladder) {
    for (int i = 0; i < options_.staircases && !ladder.empty(); ++i) {
      Track& track = tracks_.emplace_back(Track{.ladder = ladder});
      if (options_.target == StaircaseTarget::kDifference) {
        continue;
      }
      if (options_.start) {
        const auto nearest = std::ranges::min_element(
            ladder, {}, [&](double level) { return std::abs(toAxis(level) - toAxis(*options_.start)); });
        track.place = static_cast<std::size_t>(nearest - ladder.begin());
      } else if (i % 2 == 1) {
        track.place = ladder.size() - 1;
      }
    }
  }

  [[nodiscard]] bool runs(const Track& track) const { return std::ssize(track.reversals) < options_.reversals; }

  void drawTurn() {
    int fewest = std::numeric_limits<int>::max();
    for (const Track& track : tracks_) {
      fewest = runs(track) ? std::min(fewest, track.answers) : fewest;
    }
    std::vector<Track*> may;
    for (Track& track : tracks_) {
      if (runs(track) && track.answers < fewest + kMostAhead) {
        may.push_back(&track);
      }
    }
    const std::uint64_t number = random_();
    turn_ = may.empty() ? nullptr : may[number % may.size()];
  }

  /// Returns the staircase for a response to level `x`: the one whose turn it is. A response out of turn, from a study
  /// with another order of turns, goes to the first staircase with that level, so to the right side.
  Track& trackOf(double x) {
    if (turn_ != nullptr && turn_->ladder[turn_->place] == x) {
      return *turn_;
    }
    for (Track& track : tracks_) {
      if (std::ranges::find(track.ladder, x) != track.ladder.end()) {
        return track;
      }
    }
    throw InvalidParameter("level of a response", fmt::format("{}", x), "a level of the staircase");
  }

  void step(Track& track, bool right) {
    track.right_in_a_row = right ? track.right_in_a_row + 1 : 0;
    track.wrong_in_a_row = right ? 0 : track.wrong_in_a_row + 1;
    const bool on = track.right_in_a_row == options_.down;
    if (!on && track.wrong_in_a_row != options_.up) {
      return;
    }
    track.right_in_a_row = track.wrong_in_a_row = 0;
    const int direction = on ? 1 : -1;
    if (track.direction == -direction) {
      track.reversals.push_back(track.ladder[track.place]);
    }
    track.direction = direction;
    const std::ptrdiff_t by = track.reversals.empty() ? options_.first_step : options_.step;
    track.place = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
        static_cast<std::ptrdiff_t>(track.place) + direction * by, 0, std::ssize(track.ladder) - 1));
  }

  [[nodiscard]] double meanReversal(const Track& track) const {
    double sum = 0;
    for (auto it = track.reversals.begin() + options_.uncounted_reversals; it != track.reversals.end(); ++it) {
      sum += toAxis(*it);
    }
    return sum / double(std::ssize(track.reversals) - options_.uncounted_reversals);
  }

  [[nodiscard]] double toAxis(double x) const { return options_.log_axis ? std::log(x) : x; }
  [[nodiscard]] double fromAxis(double place) const { return options_.log_axis ? std::exp(place) : place; }

  StaircaseOptions options_;
  double reference_;
  std::vector<Track> tracks_;  // for kDifference first those above the reference, then those below it
  std::mt19937_64 random_;
  Track* turn_ = nullptr;  // element of tracks_; null when all have ended
  int trials_ = 0;
};

}  // namespace

std::unique_ptr<AdaptiveProcedure> makeStaircase(const StaircaseOptions& options, const std::vector<double>& levels,
                                                 double reference) {
  requireOptions(options);
  requireInRange("reference", reference, {});
  for (const double level : levels) {
    requireInRange("level", level, options.log_axis ? Range{.lowest = 0, .ends = Ends::kOpen} : Range{});
  }
  if (levels.size() < 2 || std::ranges::adjacent_find(levels, std::ranges::greater_equal{}) != levels.end()) {
    throw InvalidParameter("levels", fmt::format("{} of them", levels.size()), "two or more in ascending order");
  }
  return std::make_unique<Staircase>(options, levels, reference);
}

}  // namespace haptolith
