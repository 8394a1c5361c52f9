#include "haptolith/lab/tests/blade.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/core/statistics.h"
#include "haptolith/figure/figure.h"
#include "haptolith/lab/staged_progress.h"
#include "haptolith/lab/tests/soil_strength.h"
#include "haptolith/tool/tool_shape.h"

namespace haptolith {

namespace {

/// Stiffness over that of the particles; the blade must not deform before they do.
constexpr double kBladeStiffness = 2;
constexpr double kBladeThickness_m = 2e-3;
constexpr double kAboveDepths = 1.5;     // height of the blade above the surface
constexpr double kBladeInertia = 0.008;  // v^2/(g d): equal on all bodies, so that forces scale with gravity
constexpr double kBehindDepths = 1.2;    // soil behind the blade; its force on the back is a few per cent

/// Initial blade and soil. The blade moves along x.
struct Setup {
  LabBox box;
  ToolParameters tool;
  Pose start;
  double soil_volume_m3;
};

Setup setUp(const LabConditions& conditions, const BladeOptions& options) {
  const double d = options.depth_m;
  const bool as_wide_as_box = options.side_room_depths == 0;
  const double leaning = d / std::tan(options.rake_rad);  // backward offset of the blade at the surface
  const double behind = kBehindDepths * d + std::max(leaning, 0.0);
  const double ahead = (options.travel_depths + options.ahead_depths) * d;
  const double tip_height = options.below_depths * d;

  Setup setup;
  setup.box.width_m = behind + ahead;
  setup.box.length_m = options.width_m + 2 * options.side_room_depths * d;
  setup.box.periodic_y = as_wide_as_box;
  setup.soil_volume_m3 = setup.box.width_m * setup.box.length_m * (tip_height + d);

  const double length = (1 + kAboveDepths) * d / std::sin(options.rake_rad);
  setup.tool.shape = ToolShape::kBox;
  setup.tool.size_m = {length, as_wide_as_box ? 2 * options.width_m : options.width_m, kBladeThickness_m};
  setup.tool.stiffness_n_m = kBladeStiffness * conditions.soil.stiffness_n_m;
  setup.tool.friction = options.tool_friction;

  const Vec3 up_the_blade(-std::cos(options.rake_rad), 0, std::sin(options.rake_rad));
  const Vec3 forwards(std::sin(options.rake_rad), 0, std::cos(options.rake_rad));  // normal of its front
  Eigen::Matrix3d axes;
  axes << up_the_blade, forwards.cross(up_the_blade), forwards;
  const Vec3 edge(behind - setup.box.width_m / 2, 0, tip_height);  // lower edge of the front
  setup.start = {edge + length / 2 * up_the_blade - kBladeThickness_m / 2 * forwards, Quat(axes)};
  return setup;
}

/// Force of the soil on the blade at one moment.
struct Moment {
  double travel_m, draft_n, vertical_n;
  double front_draft_n, front_vertical_n;
};

/// Returns the force of the soil on the blade's flat front, from the tool's contact forces in the last step.
Vec3 forceOnFront(LabBed& bed, const ToolParameters& blade) {
  constexpr double kFlat = 0.95;  // cosine of the angle between a contact's normal and the front's
  const std::vector<Float4>& on_particles = bed.bed().externalForces();
  const double radius_m = bed.bed().parameters().soil.radius_m;
  Vec3 force_n = Vec3::Zero();
  for (std::size_t i = 0; i < bed.soil(); ++i) {
    const Vec3 on_particle_n(on_particles[i].x, on_particles[i].y, on_particles[i].z);
    if (!on_particle_n.isZero(0) &&
        penetration(blade, bed.toolPose().toBody(bed.centre(i)), radius_m, 0).outward.z() > kFlat) {
      force_n -= on_particle_n;
    }
  }
  return force_n;
}

struct Mean {
  double value = 0, standard_error = 0;
};

/// Returns the mean of the moments, and its standard error from means over ten blocks.
Mean meanOf(const std::vector<Moment>& moments, double Moment::*quantity) {
  constexpr std::size_t kBlocks = 10;
  std::array<double, kBlocks> blocks{};
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::size_t first = moments.size() * block / kBlocks;
    const std::size_t last = moments.size() * (block + 1) / kBlocks;
    for (std::size_t i = first; i < last; ++i) {
      blocks[block] += moments[i].*quantity / static_cast<double>(last - first);
    }
  }
  return {mean(blocks), standardDeviation(blocks) / std::sqrt(kBlocks)};
}

LabTrace traceOf(const std::vector<Moment>& moments, double stretch_m) {
  LabTrace trace{.columns = {"travel_m", "draft_n", "vertical_n"}, .rows = {}};
  for (std::size_t first = 0; first < moments.size();) {
    std::vector<double> sums(3, 0);
    std::size_t i = first;
    for (; i < moments.size() && moments[i].travel_m < moments[first].travel_m + stretch_m; ++i) {
      sums[0] += moments[i].travel_m;
      sums[1] += moments[i].draft_n;
      sums[2] += moments[i].vertical_n;
    }
    for (double& sum : sums) {
      sum /= static_cast<double>(i - first);
    }
    trace.rows.push_back(sums);
    first = i;
  }
  return trace;
}

/// Plan view of the soil that breaks out by one of the equations.
struct HeapZone {
  double ahead_m = 0;       ///< distance from the lower edge to the end of the wedge
  double reach_m = 0;       ///< r, distance on the surface from the front
  double crescent_rad = 0;  ///< eta, angle of the crescent on either side; 0: none
};

/// Zones for the equations with one strength: earthmoving, upright sides, crescents.
using ThreeZones = std::array<HeapZone, 3>;

ThreeZones zonesOf(const BladeCase& blade, const BladeEquations& equations) {
  const auto zone = [&](double beta_rad, double crescent_rad) {
    const double ahead_m = blade.depth_m / std::tan(beta_rad);
    return HeapZone{ahead_m, ahead_m + blade.depth_m / std::tan(blade.rake_rad), crescent_rad};
  };
  const HeapZone plane = zone(equations.earthmoving.beta_rad, 0);
  return {plane, equations.upright_wedge ? zone(equations.upright_wedge->beta_rad, 0) : plane,
          equations.wedge ? zone(equations.wedge->beta_rad, equations.wedge->crescent_angle_rad) : plane};
}

/// Surcharge: the soil that has accumulated in front of a blade since it began to move.
class Heap {
 public:
  /// @param edge_height_m  height of the blade's lower edge
  Heap(const LabBed& bed, const BladeOptions& options, double edge_height_m, const ThreeZones& zones)
      : bed_(bed),
        edge_height_m_(edge_height_m),
        half_width_m_(options.width_m / 2),
        has_sides_(options.side_room_depths > 0),
        most_ahead_m_(options.ahead_depths * options.depth_m),
        zones_(zones) {
    add(-1, first_);
  }

  /// Adds the current surcharge to the mean.
  void look() {
    add(1, sum_);
    ++looks_;
  }

  struct Pressures {
    double ahead_pa = 0, beside_pa = 0;
  };
  /// Returns the mean weight on the wedge and on both crescents, over their areas.
  [[nodiscard]] std::array<Pressures, 3> pressures() const {
    std::array<Pressures, 3> all;
    const double grain_n = -bed_.bed().parameters().gravity_m_s2.z() * bed_.bed().mass();
    for (std::size_t i = 0; i < zones_.size(); ++i) {
      const auto& [ahead_m, reach_m, crescent_rad] = zones_[i];
      const auto over = [&](double Grains::*where, double area_m2) {
        return std::max(0.0, grain_n * (sum_[i].*where / looks_ + first_[i].*where) / area_m2);
      };
      all[i] = {over(&Grains::ahead, 2 * half_width_m_ * reach_m),
                crescent_rad > 0 ? over(&Grains::beside, reach_m * reach_m * crescent_rad) : 0};
    }
    return all;
  }

 private:
  struct Grains {
    double ahead = 0, beside = 0;
  };

  void add(double each, std::array<Grains, 3>& to) const {
    const Pose& blade = bed_.toolPose();
    const Vec3 forwards = blade.orientation * Vec3::UnitZ();
    const Vec3 on_front = blade.position_m + kBladeThickness_m / 2 * forwards;
    // x of the front at the height of the edge.
    const double edge_m = on_front.x() + (on_front.z() - edge_height_m_) * forwards.z() / forwards.x();
    for (std::size_t grain = 0; grain < bed_.soil(); ++grain) {
      const Vec3 centre = bed_.centre(grain);
      const double ahead_m = centre.x() - edge_m;
      const double beside_m = std::abs(centre.y()) - half_width_m_;
      if (centre.z() < edge_height_m_ || ahead_m > most_ahead_m_ || (centre - on_front).dot(forwards) < 0) {
        continue;
      }
      for (std::size_t i = 0; i < zones_.size(); ++i) {
        const HeapZone& zone = zones_[i];
        if (!has_sides_ || beside_m < 0) {  // in a periodic bed particles may have crossed the boundary
          to[i].ahead += ahead_m < zone.ahead_m ? each : 0;
        } else {
          const double from_front_m = ahead_m + zone.reach_m - zone.ahead_m;  // on the surface
          const bool is_in = std::hypot(from_front_m, beside_m) < zone.reach_m &&
                             std::atan2(beside_m, from_front_m) < zone.crescent_rad;
          to[i].beside += is_in ? each : 0;
        }
      }
    }
  }

  const LabBed& bed_;
  double edge_height_m_, half_width_m_;
  bool has_sides_;
  double most_ahead_m_;  ///< distance to the end of the box
  ThreeZones zones_;
  std::array<Grains, 3> first_{}, sum_{};  ///< the initial ones are subtracted
  double looks_ = 0;
};

/// @param heap  null: no surcharge.
BladeEquations equationsFor(const BladeCase& blade, bool has_sides, const Heap* heap) {
  const std::array<Heap::Pressures, 3> load = heap != nullptr ? heap->pressures() : std::array<Heap::Pressures, 3>();
  const auto under = [&](std::size_t equation) {
    BladeCase loaded = blade;
    loaded.surcharge_pa = load[equation].ahead_pa;
    loaded.surcharge_beside_pa = load[equation].beside_pa;
    return loaded;
  };
  BladeEquations equations{.earthmoving = earthmovingForce(under(0)), .upright_wedge = {}, .wedge = {}};
  if (has_sides) {
    equations.upright_wedge = uprightWedgeForce(under(1));
    try {
      equations.wedge = wedgeForce(under(2));
    } catch (const InvalidParameter&) {
      // Leaning forward, or too flat for its width: the simulated result is still valid.
    }
  }
  return equations;
}

BladeCase caseOf(const LabConditions& conditions, const BladeOptions& options, const BladeResult& result) {
  return {.width_m = result.width_m,
          .depth_m = result.depth_m,
          .rake_rad = options.rake_rad,
          .density_kg_m3 = result.bulk_density_kg_m3,
          .gravity_m_s2 = conditions.gravity_m_s2,
          .friction_angle_rad = options.friction_angle_rad,
          .tool_friction_rad = std::atan(options.tool_friction),
          .cohesion_pa = options.cohesion_pa};
}

/// Returns the case with the residual strength of the soil.
BladeCase sheared(BladeCase blade, const MohrCoulomb& residual) {
  blade.friction_angle_rad = residual.friction_angle_rad;
  blade.cohesion_pa = residual.cohesion_pa;
  return blade;
}

}  // namespace

void validate(const LabConditions& conditions, const BladeOptions& options) {
  const Range positive{0, 10, Ends::kOpenBelow};
  validate(conditions.soil);
  requireInRange("gravity_m_s2", conditions.gravity_m_s2, {0, 1000, Ends::kOpenBelow});
  requireInRange("width_m", options.width_m, positive);
  requireInRange("depth_m", options.depth_m, {4 * conditions.soil.radius_m, 10});
  requireInRange("rake_rad", options.rake_rad, {std::numbers::pi / 6, std::numbers::pi * 2 / 3});
  constexpr double kMostInertia = 0.1;
  if (options.speed_m_s) {
    requireInRange("speed_m_s", *options.speed_m_s,
                   {0, std::sqrt(kMostInertia * conditions.gravity_m_s2 * options.depth_m), Ends::kOpenBelow});
  }
  requireInRange("tool_friction", options.tool_friction, {0, std::tan(std::numbers::pi / 3)});
  requireInRange("level_depths", options.level_depths, {0, 100});
  requireInRange("travel_depths", options.travel_depths, {options.level_depths, 100, Ends::kOpenBelow});
  requireInRange("side_room_depths", options.side_room_depths, {0, 100});
  requireInRange("ahead_depths", options.ahead_depths, {0.5, 100});
  requireInRange("below_depths", options.below_depths, {0.1, 100});
  requireInRange("friction_angle_rad", options.friction_angle_rad, {0, std::numbers::pi / 3});
  requireInRange("cohesion_pa", options.cohesion_pa, {0, 1e6});
  if (options.residual) {
    requireInRange("residual.friction_angle_rad", options.residual->friction_angle_rad, {0, std::numbers::pi / 3});
    requireInRange("residual.cohesion_pa", options.residual->cohesion_pa, {0, 1e6});
  }
  (void)particlesFor(conditions.soil, setUp(conditions, options).soil_volume_m3);
}

BladeResult bladeTest(const LabConditions& conditions, const BladeOptions& options) {
  validate(conditions, options);
  const SoilParameters& soil = conditions.soil;
  const double speed_m_s =
      options.speed_m_s.value_or(std::sqrt(kBladeInertia * conditions.gravity_m_s2 * options.depth_m));
  const Setup setup = setUp(conditions, options);
  const double largest = soil.radius_m * (1 + soil.size_spread);
  const auto beside_blade = [&](const Vec3& centre) {
    return penetration(setup.tool, setup.start.toBody(centre), largest, 0).depth_m < 0;
  };
  // Gaps at the floor, the walls and the surface take up volume; poured soil has larger gaps everywhere.
  const double filled = options.preparation == Preparation::kDense ? 0.93 : 0.8;
  const std::size_t wanted = particlesFor(soil, filled * setup.soil_volume_m3);
  constexpr double kMoves = 0.3;  // fraction of the test's time before the movement
  StagedProgress progress(conditions.progress);
  progress.enter(0, kMoves);
  LabConditions staged = conditions;
  staged.progress = progress.inner();
  LabBed bed(staged, setup.box,
             looseSoil(soil, setup.box, wanted, 0, conditions.seed, beside_blade, options.preparation), {}, setup.tool);
  bed.placeTool(setup.start);
  bed.settle(options.preparation);

  BladeResult result;
  const double surface = bed.surfaceHeight(options.depth_from);
  result.particles = bed.soil();
  result.depth_m = surface - options.below_depths * options.depth_m;
  result.width_m = options.width_m;
  result.bulk_density_kg_m3 = bed.bulkDensity(0.2 * surface, 0.8 * surface);
  result.inertia = speed_m_s * speed_m_s / (conditions.gravity_m_s2 * result.depth_m);

  const bool has_sides = options.side_room_depths > 0;
  const BladeCase undisturbed = caseOf(conditions, options, result);
  const double edge_height_m = options.below_depths * options.depth_m;
  result.expected.undisturbed = equationsFor(undisturbed, has_sides, nullptr);
  Heap heap(bed, options, edge_height_m, zonesOf(undisturbed, result.expected.undisturbed));
  std::optional<Heap> heap_of_residual;
  if (options.residual) {
    const BladeCase residual = sheared(undisturbed, *options.residual);
    result.expected.residual = equationsFor(residual, has_sides, nullptr);
    heap_of_residual.emplace(bed, options, edge_height_m, zonesOf(residual, *result.expected.residual));
  }

  std::vector<Moment> moments;
  bed.moveTool({{speed_m_s, 0, 0}, Vec3::Zero()});
  progress.enter(kMoves, 1);
  bed.run(options.travel_depths * options.depth_m / speed_m_s, "the blade moves", [&] {
    const Vec3& force = bed.toolWrench().force_n;
    const Vec3 on_front = forceOnFront(bed, setup.tool);
    moments.push_back({bed.toolPose().position_m.x() - setup.start.position_m.x(), -force.x(), -force.z(),
                       -on_front.x(), -on_front.z()});
    if (moments.back().travel_m >= options.level_depths * options.depth_m) {
      heap.look();
      if (heap_of_residual) {
        heap_of_residual->look();
      }
    }
  });
  result.trace = traceOf(moments, options.depth_m / 50);
  std::erase_if(moments,
                [&](const Moment& moment) { return moment.travel_m < options.level_depths * options.depth_m; });
  const Mean draft = meanOf(moments, &Moment::draft_n);
  const Mean vertical = meanOf(moments, &Moment::vertical_n);
  result.draft_n = draft.value;
  result.draft_se_n = draft.standard_error;
  result.vertical_n = vertical.value;
  result.vertical_se_n = vertical.standard_error;
  result.front_draft_n = meanOf(moments, &Moment::front_draft_n).value;
  result.front_vertical_n = meanOf(moments, &Moment::front_vertical_n).value;
  result.expected_heaped.undisturbed = equationsFor(undisturbed, has_sides, &heap);
  if (options.residual) {
    result.expected_heaped.residual =
        equationsFor(sheared(undisturbed, *options.residual), has_sides, &*heap_of_residual);
  }
  result.heap_pa = heap.pressures()[result.expected.undisturbed.wedge ? 2 : 0].ahead_pa;
  result.heap_beside_pa = heap.pressures()[2].beside_pa;
  return result;
}

BladeStrength strengthBeforeBlade(const LabConditions& conditions, Preparation preparation) {
  const std::vector<double> stresses_pa = {200, 400, 800};
  if (preparation != Preparation::kDense) {
    return {.undisturbed = undisturbedStrength(conditions, preparation, stresses_pa), .residual = {}};
  }
  constexpr double kStrain = 3;
  const DenseStrength strength = denseStrength(conditions, stresses_pa, kStrain);
  return {.undisturbed = strength.undisturbed, .residual = strength.residual};
}

void drawBlade(const OutputFile& file, const BladeResult& result, std::string_view title) {
  constexpr double kMmPerM = 1000;
  Figure figure(file, 1100, 500);
  std::vector<std::vector<double>> rows = result.trace.rows;
  for (std::vector<double>& row : rows) {
    row[0] *= kMmPerM;
  }
  figure.data("trace", rows);
  figure.command(
      "set xlabel 'travel / mm'; set ylabel 'force / N'; set key outside right center Left reverse; set xrange [0:*]");
  figure.command(fmt::format("set title {}", gnuplotQuoted(title)));
  std::string curves =
      "plot $trace using 1:2 with lines linewidth 2.5 linecolor rgb '#0072b2' title 'draft', "
      "$trace using 1:3 with lines linewidth 2.5 linecolor rgb '#009e73' title 'vertical'";
  const auto level = [&](double force_n, std::string_view look, std::string_view name) {
    curves += fmt::format(", {} with lines {} title '{}'", force_n, look, name);
  };
  const BladeEquations& bare = result.expected.undisturbed;
  const BladeEquations& heaped = result.expected_heaped.undisturbed;
  level(result.draft_n, "dashtype (2,3) linewidth 1.5 linecolor rgb '#888888'",
        fmt::format("mean draft ± {:.2g} N", result.draft_se_n));
  level(bare.earthmoving.draft_n, "dashtype (8,5) linewidth 1.5 linecolor rgb '#d55e00'", "earthmoving equation");
  if (bare.upright_wedge) {
    level(bare.upright_wedge->draft_n, "dashtype (2,5) linewidth 2 linecolor rgb '#cc79a7'",
          "wedge between upright sides");
  }
  if (bare.wedge) {
    level(bare.wedge->draft_n, "dashtype (8,5) linewidth 1.5 linecolor rgb '#e69f00'", "wedge with crescents");
  }
  level(heaped.wedge ? heaped.wedge->draft_n : heaped.earthmoving.draft_n,
        fmt::format("linewidth 1.5 linecolor rgb '{}'", heaped.wedge ? "#e69f00" : "#d55e00"),
        "wedge or equation, with surcharge");
  level(bare.earthmoving.vertical_n, "dashtype (8,5) linewidth 1.5 linecolor rgb '#009e73'",
        "vertical, earthmoving equation");
  figure.command(curves);
  figure.save();
}

}  // namespace haptolith
