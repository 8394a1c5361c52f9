#include "haptolith/teleop/link/command_track.h"

#include <algorithm>
#include <iterator>

namespace haptolith {

namespace {

struct Course {
  Vec3 place, speed;
};

/// At the share s of a time T from 0 to `to`, at the speeds v0 and v1 there.
Course hermite(const Vec3& v0, const Vec3& to, const Vec3& v1, double time_s, double s) noexcept {
  const double s2 = s * s;
  const double s3 = s2 * s;
  return {time_s * (s3 - 2 * s2 + s) * v0 + (3 * s2 - 2 * s3) * to + time_s * (s3 - s2) * v1,
          (3 * s2 - 4 * s + 1) * v0 + 6 * (s - s2) / time_s * to + (3 * s2 - 2 * s) * v1};
}

}  // namespace

void CommandTrack::add(const Keyframe& key) {
  if (!keys_.empty() && key.index > keys_.back().index) {  // as nearly all are
    keys_.push_back(key);
  } else {
    const auto place = std::ranges::lower_bound(keys_, key.index, {}, &Keyframe::index);
    const bool is_there = place != keys_.end() && place->index == key.index;
    const bool forgotten = place == keys_.begin() && !keys_.empty();
    if (!is_there && !forgotten) {
      keys_.insert(place, key);
    }
  }
  if (keys_.size() > kMostKeyframes) {
    keys_.pop_front();
  }
}

void CommandTrack::forgetBefore(double index) {
  while (keys_.size() > 1 && static_cast<double>(keys_[1].index) <= index) {
    keys_.pop_front();
  }
}

std::size_t CommandTrack::after(double index) const noexcept {
  const auto place =
      std::ranges::upper_bound(keys_, index, {}, [](const Keyframe& key) { return static_cast<double>(key.index); });
  return static_cast<std::size_t>(std::distance(keys_.begin(), place));
}

CommandTrack::Stretch CommandTrack::around(double index) const noexcept {
  const std::size_t next = std::clamp<std::size_t>(after(index), 1, keys_.size() - 1);
  return {keys_[next - 1], keys_[next]};
}

HandState CommandTrack::at(double index) const noexcept {
  const std::size_t next = after(index);
  if (next == 0 || next == keys_.size()) {
    HandState still = next == 0 ? keys_.front().hand : keys_.back().hand;
    still.twist = {};
    return still;
  }
  const Keyframe& from = keys_[next - 1];
  const Keyframe& to = keys_[next];
  const double ticks = static_cast<double>(to.index - from.index);
  const double s = (index - static_cast<double>(from.index)) / ticks;
  const double time_s = ticks * tick_s_;
  const Course way = hermite(from.hand.twist.linear_m_s, to.hand.pose.position_m - from.hand.pose.position_m,
                             to.hand.twist.linear_m_s, time_s, s);
  const Course turn =
      hermite(from.hand.twist.angular_rad_s, rotationBetween(from.hand.pose.orientation, to.hand.pose.orientation),
              to.hand.twist.angular_rad_s, time_s, s);
  HandState hand;
  hand.pose = {from.hand.pose.position_m + way.place, turnedBy(turn.place, from.hand.pose.orientation)};
  hand.twist = {way.speed, turn.speed};
  hand.opening = std::lerp(from.hand.opening, to.hand.opening, s);
  return hand;
}

}  // namespace haptolith
