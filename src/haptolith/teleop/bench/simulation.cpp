#include "haptolith/teleop/bench/simulation.h"

#include <fmt/format.h>

#include "haptolith/core/error.h"
#include "haptolith/teleop/bench/simulation_parts.h"
#include "haptolith/teleop/operator/surface_mender.h"

namespace haptolith {

TeleopResult simulateTeleop(const TeleopSetup& setup, const TeleopProgress& progress) {
  requireInRange("duration_s", setup.duration_s, TeleopRanges::duration_s);
  requireInRange("period_s", setup.sending.period_s, TeleopRanges::period_s);
  requireInRange("site_period_s", setup.sending.site_period_s, TeleopRanges::site_period_s);
  requireInRange("bilateral_period_s", setup.bilateral_period_s, TeleopRanges::period_s);
  requireInRange("release_s", setup.release_s.value_or(0), TeleopRanges::release_s);
  if (setup.release_s && (setup.task || setup.feedback != Feedback::kModel)) {
    throw InvalidParameter("release_s", fmt::format("{:g}", *setup.release_s),
                           "given with a rendered model and without a task");
  }
  requireInRange("robot_clock_share", setup.robot_clock_share, TeleopRanges::clock_share);
  if (setup.model.loop.tick_s != setup.site.loop.tick_s) {
    throw InvalidParameter("site.loop.tick_s", fmt::format("{:g}", setup.site.loop.tick_s),
                           fmt::format("the model's {:g}", setup.model.loop.tick_s));
  }
  if (setup.mends && (setup.feedback != Feedback::kModel || !canMend(setup.model.bed))) {
    throw InvalidParameter("mends", "", "left out without a rendered model, or with particles of several sizes");
  }
  if (setup.learns && setup.feedback != Feedback::kModel) {
    throw InvalidParameter("learns", "", "left out without a rendered model");
  }
  return setup.feedback == Feedback::kBilateral ? simulation::simulateBilateral(setup, progress)
                                                : simulation::simulateModel(setup, progress);
}

}  // namespace haptolith
