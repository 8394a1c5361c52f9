#include "run/run_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include "haptolith/tool/tool_surface.h"

namespace haptolith {

namespace {

constexpr double kMm = 1e3;
using Rows = std::vector<std::vector<double>>;

/// Returns particles from the tool's centre to the far wall, as seen from the side, the far ones first, with their
/// nearness (0 to 1) for shading; x, z and radius in mm.
Rows particlesBehindTheCut(const SceneSnapshot& scene, const BedParameters& bed) {
  const double cut = scene.scene_T_tool.position_m.y();
  Rows rows;
  for (const Float4& p : scene.position) {
    if (p.y >= cut) {
      rows.push_back(
          {kMm * p.x, kMm * p.z, 1 - (p.y - cut) / (bed.length_m / 2), -p.y, kMm * (bed.soil.radius_m + p.w)});
    }
  }
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a[3] < b[3]; });
  return rows;
}

/// Returns edges of the tool as x, z, dx, dz in mm: bends of its surface by more than 25 degrees, and its outline along
/// y. @param opening_m  opening of its jaws.
Rows toolEdges(const ToolParameters& tool, const Pose& pose, double opening_m) {
  const double bends = std::cos(25 * std::numbers::pi / 180);
  const ToolSurface surface = toolSurface(tool, opening_m);
  const auto at = [&](std::int32_t point) {
    return pose.fromBody(surface.points_tool_m[static_cast<std::size_t>(point)]);
  };
  std::map<std::pair<std::int32_t, std::int32_t>, Vec3> normals;  // normal of the triangle left of each directed edge
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3 normal = (at(b) - at(a)).cross(at(c) - at(a)).normalized();
    normals[{a, b}] = normals[{b, c}] = normals[{c, a}] = normal;
  }
  Rows edges;
  for (const auto& [edge, left] : normals) {
    const auto other = normals.find({edge.second, edge.first});
    if (edge.first > edge.second || other == normals.end()) {
      continue;  // each edge once
    }
    const Vec3& right = other->second;
    if (left.dot(right) < bends || (left.y() > 0) != (right.y() > 0)) {
      const Vec3 from = at(edge.first);
      const Vec3 along = at(edge.second) - from;
      edges.push_back({kMm * from.x(), kMm * from.z(), kMm * along.x(), kMm * along.z()});
    }
  }
  return edges;
}

Rows tickHistogram(const Histogram& ticks) {
  constexpr std::size_t kBucketsPerBar = 8;
  Rows bars;
  for (std::size_t first = 0; first < Histogram::kBuckets; first += kBucketsPerBar) {
    double count = 0;
    for (std::size_t bucket = first; bucket < first + kBucketsPerBar; ++bucket) {
      count += static_cast<double>(ticks.inBucket(bucket));
    }
    if (count > 0) {
      const double from = first == 0 ? ticks.upperEnd(0) / 2 : ticks.upperEnd(first - 1);
      bars.push_back({from, ticks.upperEnd(first + kBucketsPerBar - 1), count});
    }
  }
  return bars;
}

}  // namespace

void drawRun(Figure& figure, const SceneFile& scene_file, const RunHistory& history, const LoopStatistics& statistics) {
  Rows forces;
  for (const TickRecord& r : history.records) {
    const Vec3& f = r.sent.wrench.force_n;
    forces.push_back({r.time_s, f.x(), f.y(), f.z(), kMm * r.scene_T_tool.position_m.z(), r.soil.force_n.z()});
  }
  const BedParameters& bed = scene_file.bed;
  const SceneSnapshot& scene = history.strongest;
  const double half_width = kMm * bed.width_m / 2;
  const double wall = half_width + kMm * bed.soil.radius_m;  // walls bound the centres of particles
  const Rows tool = toolEdges(scene_file.tool, scene.scene_T_tool, scene.opening_m);
  double tool_top = kMm * scene.scene_T_tool.position_m.z();
  for (const std::vector<double>& edge : tool) {
    tool_top = std::max({tool_top, edge[1], edge[1] + edge[3]});
  }
  double highest = kMm * scene.scene_T_tool.position_m.z() + 30;
  for (const Float4& p : scene.position) {
    highest = std::max(highest, std::min(kMm * (p.z + bed.soil.radius_m), 2 * half_width));
  }

  figure.data("particles", particlesBehindTheCut(scene, bed));
  figure.data("tool", tool);
  figure.data("forces", forces);
  figure.data("ticks", tickHistogram(statistics.tickUs()));
  figure.data("strongest", {{scene.time_s, scene.device_wrench.force_n.norm()}});
  figure.command(fmt::format(R"gnuplot(
set multiplot layout 2,2 title {title} font ",17"
set lmargin 9
set rmargin 3

set title sprintf('Cut through the tool at t = %.2f s, when the hand felt %.2f N', {time}, {force})
set xlabel 'x (mm)'
set ylabel 'height (mm)'
set size ratio -1
set xrange [{left}:{right}]
set yrange [{bottom}:{top}]
unset key
unset colorbox
set cbrange [0:1]
set palette defined (0 '#55504a', 1 '#cfc8bd')
set object 1 rectangle from {wall_left},{bottom} to {wall_right},0 fc rgb '#333333' fs solid noborder
set arrow 1 from {wall_left},0 to {wall_left},{top} nohead lw 2 lc rgb '#333333'
set arrow 2 from {wall_right},0 to {wall_right},{top} nohead lw 2 lc rgb '#333333'
set label 1 'tool' at {tool_x},{tool_top} center offset 0,0.7 front tc rgb '#d1495b'
set style fill solid 1.0 border lc rgb '#3a3632'
plot $particles using 1:2:5:3 with circles palette, \
     $tool using 1:2:3:4 with vectors nohead lw 2.5 lc rgb '#d1495b'
unset object 1
unset arrow 1
unset arrow 2
unset label 1
set size noratio

set title 'Force on the hand (as sent to the device, device frame)'
set xlabel 'time (s)'
set ylabel 'force (N)'
set autoscale x
set autoscale y
set offsets 0, 0, graph 0.05, graph 0.05
set key top right horizontal
plot $forces using 1:2 with lines lw 1.5 lc rgb '#d1495b' title 'x', \
     $forces using 1:3 with lines lw 1.5 lc rgb '#edae49' title 'y', \
     $forces using 1:4 with lines lw 1.5 lc rgb '#00798c' title 'z'

set title 'Vertical force over the height of the tool'
set xlabel "height of the tool's centre (mm)"
set ylabel 'force (N)'
set key top right vertical
plot $forces using 5:6 with lines lw 1.2 lc rgb '#edae49' title 'of the soil', \
     $forces using 5:4 with lines lw 1.2 lc rgb '#00798c' title 'sent to the device, z'

set title 'How long the work of a tick took'
set xlabel 'microseconds (one tick may last 1000)'
set ylabel 'ticks'
set offsets 0, 0, 0, 0
set logscale xy
set xrange [1:3000]
set yrange [0.5:*]
set style fill solid 0.8 noborder
set arrow 3 from 1000, graph 0 to 1000, graph 1 nohead dt 2 lw 2 lc rgb '#d1495b'
set label 3 '1 ms' at 1000, graph 0.93 right offset -0.5,0 tc rgb '#d1495b'
unset key
plot $ticks using (sqrt($1*$2)):3:1:2:(0.5):3 with boxxyerror lc rgb '#00798c'
unset multiplot
)gnuplot",
                             fmt::arg("title", gnuplotQuoted(scene_file.title)), fmt::arg("time", scene.time_s),
                             fmt::arg("force", scene.device_wrench.force_n.norm()), fmt::arg("left", -half_width - 25),
                             fmt::arg("right", half_width + 25), fmt::arg("bottom", -6), fmt::arg("top", highest + 8),
                             fmt::arg("wall_left", -wall), fmt::arg("wall_right", wall),
                             fmt::arg("tool_x", kMm * scene.scene_T_tool.position_m.x()),
                             fmt::arg("tool_top", tool_top)));
  figure.save();
}

}  // namespace haptolith
