// Settled bed for other engines, and haptolith's speed with it: see speed and README.md.
//
//     haptolith_peer_speed PARTICLES icra2021|contact THREADS FOLDER
//
// Writes FOLDER/bed.data (LAMMPS) and FOLDER/law.table (contact force over distance), and prints one line of JSON that
// describes the bed. Then, for every line "STEPS" of standard input, it prints the duration of this number of steps in
// s.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <iostream>
#include <string>

#include "haptolith/bed/bed.h"
#include "haptolith/bed/critical_step.h"
#include "haptolith/bed/start/bed_start.h"
#include "haptolith/core/error.h"
#include "haptolith/core/platform/clock.h"
#include "haptolith/soil/presets.h"

namespace haptolith {
namespace {

BedParameters sandbox(int particles, FrictionModel friction, int threads) {
  BedParameters bed;
  bed.soil = findPreset("P3").soil;
  bed.soil.friction = friction;
  bed.soil.contact_friction = 0.5;
  bed.soil.attraction_ratio = 1;  // the other engines have no attraction
  bed.soil.size_spread = 0;
  bed.sleep = false;
  bed.threads = threads;
  bed.start = BedStart::kPacked;
  return withRoomFor(particles, bed);
}

void step(Bed& bed, double dt_s, long steps) {
  for (long i = 0; i < steps; ++i) {
    if (const StepStatus status = bed.step(dt_s); status != StepStatus::kOk) {
      throw Failure(text(status));
    }
  }
}

void writeData(const Bed& bed, const std::string& path) {
  const BedParameters& box = bed.parameters();
  const double radius = box.soil.radius_m;
  const double density = bed.mass() / (4.0 / 3 * 3.14159265358979323846 * radius * radius * radius);
  std::ofstream file(path);
  file << fmt::format(
      "haptolith\n\n{} atoms\n1 atom types\n{} {} xlo xhi\n{} {} ylo yhi\n0 1 zlo zhi\n\nAtoms # sphere\n\n",
      bed.particles(), -box.width_m / 2, box.width_m / 2, -box.length_m / 2, box.length_m / 2);
  for (std::size_t i = 0; i < bed.particles(); ++i) {
    const Float4& p = bed.state().position[i];
    file << fmt::format("{} 1 {} {} {} {} {}\n", i + 1, 2 * radius, density, p.x, p.y, p.z);
  }
  if (!file.flush()) {
    throw Failure("cannot write " + path);
  }
}

void writeTable(const Bed& bed, const std::string& path) {
  constexpr int kRows = 4000;
  const ContactLaw& law = bed.law();
  const double last = law.cutoff_m;
  const double first = 0.5 * last;
  std::ofstream file(path);
  file << fmt::format("# contact law of icra2021\n\nLAW\nN {} R {} {}\n\n", kRows, first, last);
  for (int row = 0; row < kRows; ++row) {
    const double a = first + (last - first) * row / (kRows - 1);
    file << fmt::format("{} {} {} {}\n", row + 1, a, contactEnergy(law, a), contactForce(law, a));
  }
  if (!file.flush()) {
    throw Failure("cannot write " + path);
  }
}

int run(int argc, char** argv) {
  if (argc != 5) {
    fmt::print(stderr, "usage: haptolith_peer_speed PARTICLES icra2021|contact THREADS FOLDER\n");
    return 2;
  }
  const std::string friction = argv[2];
  if (friction != "icra2021" && friction != "contact") {
    throw InvalidParameter("friction", friction, "icra2021 or contact");
  }
  const std::string folder = argv[4];
  Bed bed(sandbox(std::stoi(argv[1]), friction == "icra2021" ? FrictionModel::kIcra2021 : FrictionModel::kContact,
                  std::stoi(argv[3])));
  const BedParameters& parameters = bed.parameters();
  const double dt = parameters.tick_s / substepsFor(parameters.soil, 0, parameters.tick_s, parameters.max_substeps);
  bed.setSettling(true);
  step(bed, dt, 500);
  bed.setSettling(false);
  step(bed, dt, 200);
  writeData(bed, folder + "/bed.data");
  writeTable(bed, folder + "/law.table");
  const nlohmann::ordered_json about{{"particles", bed.particles()},
                                     {"radius_m", parameters.soil.radius_m},
                                     {"mass_kg", bed.mass()},
                                     {"stiffness_n_m", parameters.soil.stiffness_n_m},
                                     {"cutoff_m", bed.law().cutoff_m},
                                     {"contact_friction", parameters.soil.contact_friction},
                                     {"damping_ratio", parameters.soil.damping_ratio},
                                     {"gravity_m_s2", parameters.gravity_m_s2.norm()},
                                     {"dt_s", dt}};
  std::cout << about.dump() << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    const std::int64_t start_ns = monotonicNs();
    step(bed, dt, std::stol(line));
    std::cout << 1e-9 * static_cast<double>(monotonicNs() - start_ns) << std::endl;
  }
  return 0;
}

}  // namespace
}  // namespace haptolith

int main(int argc, char** argv) {
  try {
    return haptolith::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "peer_speed: {}\n", error.what());
    return 1;
  }
}
