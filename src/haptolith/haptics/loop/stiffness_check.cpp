#include "haptolith/haptics/loop/stiffness_check.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "haptolith/tool/tool_shape.h"

namespace haptolith {

namespace {

/// Number of particles that fit next to each other on the tool's largest cross-section.
double contactsAtOnce(const ToolParameters& tool, double radius_m) {
  const double reach_m = enclosingRadius(tool);
  return std::ceil(std::numbers::pi * reach_m * reach_m / (4 * radius_m * radius_m));
}

}  // namespace

StiffnessCheck checkStiffness(const HandlingParameters& handling, const ToolParameters& tool, double radius_m,
                              const DeviceLimits& device, double tick_s) {
  const CouplingParameters& coupling = handling.coupling;
  const bool is_virtual = couplesVirtually(coupling.kind, suitsDirectly(device));
  const double scale = handling.mapping.force_scale * handling.mapping.scale;
  const double contacts = contactsAtOnce(tool, radius_m);
  StiffnessCheck check;
  check.stiffness_n_m = scale * (is_virtual ? coupling.spring.stiffness_n_m : contacts * tool.stiffness_n_m);
  check.needed_n_s_m = check.stiffness_n_m * tick_s / 2 + (is_virtual ? scale * coupling.spring.damping_n_s_m : 0);
  check.declared_n_s_m = device.damping_n_s_m;
  check.text = fmt::format(
      "the tool can be as stiff as {:.0f} N/m at the device ({}), which takes {:.2g} N s/m of damping; the device has "
      "{:.2g}: it can vibrate when held loosely. {}",
      check.stiffness_n_m,
      is_virtual ? std::string("the virtual coupling")
                 : fmt::format("{:.0f} simultaneous contacts of {:g} N/m", contacts, tool.stiffness_n_m),
      check.needed_n_s_m, check.declared_n_s_m,
      is_virtual ? "A softer [coupling] helps"
                 : "A smaller [mapping] force_scale helps, or [coupling] kind = \"virtual\"");
  return check;
}

}  // namespace haptolith
