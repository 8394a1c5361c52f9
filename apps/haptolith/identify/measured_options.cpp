#include "identify/measured_options.h"

#include <CLI/App.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "haptolith/core/error.h"
#include "haptolith/identify/next_measurement.h"
#include "haptolith/identify/training/training_file.h"
#include "haptolith/soil/bodies.h"

#include "shared/common_options.h"
#include "shared/option_checks.h"

namespace haptolith {

void MeasuredOptions::addTo(CLI::App& command, bool needed) {
  command
      .add_option("measured", files,
                  "Tables of tool pose and soil force along the movement or parts of it: t_s, x_m, y_m, z_m, qw, qx, "
                  "qy, qz, soil_fx_n, soil_fy_n, soil_fz_n")
      ->option_text("FILE.csv ...")
      ->required(needed);
  command.add_option("--training", training_file, "Training file of this tool and movement")
      ->option_text("FILE.json [the probe's]");
  addOrigin(command, origin_mm);
  command.add_option("--body", body, kBodyHelp)->capture_default_str();
}

void addOrigin(CLI::App& command, std::vector<double>& origin_mm) {
  command.add_option("--origin-mm", origin_mm, "Centre of the soil's surface in the frame of the table, z up")
      ->option_text("X,Y,Z [0,0,0]")
      ->delimiter(',')
      ->expected(3)
      ->check(numberIn({-1e5, 1e5}));
}

namespace {

/// Returns the message that the movement was not found, with hints at wrong units.
std::string nowhereText(const std::string& file, const std::vector<MeasuredSample>& samples) {
  std::vector<double> steps_s;
  Vec3 low_m = samples.front().pose.position_m, high_m = low_m;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    steps_s.push_back(samples[i].time_s - samples[i - 1].time_s);
    low_m = low_m.cwiseMin(samples[i].pose.position_m);
    high_m = high_m.cwiseMax(samples[i].pose.position_m);
  }
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::ranges::nth_element(steps_s, middle);
  return fmt::format(
      "{}: the tool is never within 3 mm and 3 degrees of the trained movement; check --origin-mm. Rows are {:.3g} s "
      "apart, and the tool moves within {:.3g} x {:.3g} x {:.3g} m: t_s must be in seconds, positions in metres, and "
      "quaternions must begin with w",
      file, *middle, high_m.x() - low_m.x(), high_m.y() - low_m.y(), high_m.z() - low_m.z());
}

}  // namespace

Measured measuredBy(const MeasuredOptions& options) {
  const std::optional<Training> read =
      options.training_file.empty() ? std::nullopt : std::optional(readTraining(options.training_file));
  const Training& training = read ? *read : probeTraining();
  std::vector<std::vector<MeasuredSample>> courses;
  std::vector<double> first_s;
  for (const std::string& file : options.files) {
    courses.push_back(readMeasured(file));
    first_s.push_back(courses.back().front().time_s);
    if (matchForces(training.movement, courses.back(), options.originM()).windows == 0) {
      throw Failure(nowhereText(file, courses.back()));
    }
  }
  SoilIdentifier identifier(training);
  std::vector<MovementPart> parts = partsOf(training.movement, identifier.emulator());
  MatchedParts matched = matchParts(training.movement, parts, courses, options.originM());
  return {std::move(identifier), std::move(parts), std::move(matched), std::move(first_s),
          findBody(options.body).gravity_m_s2};
}

std::vector<bool> Measured::partsMeasured() const {
  std::vector<bool> measured;
  for (const MovementPart& part : parts) {
    measured.push_back(isMeasured(part, identifier.emulator(), matched.forces));
  }
  return measured;
}

std::string Measured::text(const MeasuredOptions& options) const {
  const std::vector<bool> measured = partsMeasured();
  const auto count = std::ranges::count(measured, true);
  const std::size_t numbers = identifier.emulator().observed(matched.forces, gravity_m_s2).which.size();
  std::string text = fmt::format("{} of {} parts are measured: {} of {} windows match, {} numbers are used\n", count,
                                 parts.size(), matched.windows, matched.forces.size(), numbers);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (measured[i]) {
      text += fmt::format("  {:20} from {:.2f} s in {}\n", parts[i].name,
                          std::max(first_s[matched.parts[i].course], matched.parts[i].begin_s),
                          options.files[matched.parts[i].course]);
    }
  }
  return text;
}

nlohmann::ordered_json Measured::json(const MeasuredOptions& options) const {
  const std::vector<bool> measured = partsMeasured();
  nlohmann::ordered_json json{{"measured", options.files},
                              {"windows", matched.windows},
                              {"windows_of_movement", matched.forces.size()},
                              {"gravity_m_s2", gravity_m_s2}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    nlohmann::ordered_json part{{"name", parts[i].name}, {"measured", bool(measured[i])}};
    if (measured[i]) {
      part["file"] = options.files[matched.parts[i].course];
      part["begin_s"] = matched.parts[i].begin_s;
    }
    json["parts"].push_back(part);
  }
  return json;
}

void writePoses(const OutputFile& file, const ToolMovement& movement, const Vec3& origin_m) {
  constexpr double kTick_s = 1e-3;
  AtomicFile out(file);
  out.write("t_s,x_m,y_m,z_m,qw,qx,qy,qz\n");
  const auto ticks = static_cast<int>(movement.duration() / kTick_s);
  for (int tick = 0; tick <= ticks; ++tick) {
    const Pose pose = movement.at(tick * kTick_s);
    const Vec3 p = pose.position_m + origin_m;
    const Quat& q = pose.orientation;
    out.write(fmt::format("{:.3f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n", tick * kTick_s, p.x(), p.y(),
                          p.z(), q.w(), q.x(), q.y(), q.z()));
  }
  out.commit();
}

}  // namespace haptolith
