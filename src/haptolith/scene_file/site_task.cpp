#include "haptolith/scene_file/site_task.h"

#include <fmt/format.h>

#include <cmath>

namespace haptolith {

namespace {

constexpr double kTaskMm = 1e-3;  // m

}  // namespace

std::string goalOf(SiteTask task) {
  using Goals = SiteTaskGoals;
  switch (task) {
    case SiteTask::kTrench:
      return fmt::format("Dig a trench, {:g} mm deep and {:g} mm long", Goals::trench_depth_m / kTaskMm,
                         Goals::trench_length_m / kTaskMm);
    case SiteTask::kPress: return fmt::format("Press on the soil with {:g} N, and hold that", Goals::press_n);
    case SiteTask::kScoop: return fmt::format("Lift a load of {:g} N, and hold it up", Goals::load_n);
  }
  return "";
}

std::string reachedText(SiteTask task, double reached) {
  using Goals = SiteTaskGoals;
  if (std::isnan(reached)) {
    return "nothing seen yet";
  }
  switch (task) {
    case SiteTask::kTrench: return fmt::format("{:.0f} of {:g} mm", reached / kTaskMm, Goals::trench_depth_m / kTaskMm);
    case SiteTask::kPress: return fmt::format("{:.1f} of {:g} N", reached, Goals::press_n);
    case SiteTask::kScoop: return fmt::format("{:.2f} of {:g} N", reached, Goals::load_n);
  }
  return "";
}

}  // namespace haptolith
