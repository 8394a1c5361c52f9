#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "haptolith/bed/measure/surface_height.h"
#include "haptolith/core/error.h"
#include "haptolith/haptics/tick_record.h"
#include "haptolith/ros2/ros2_node.h"
#include "haptolith/ros2/target_device.h"

namespace haptolith {

/// Topics that a scene publishes to a ROS 2 graph, and reads from it.
struct ScenePublisherParameters {
  std::string bed_frame = "haptolith_bed";    ///< the scene's frame: z up, its origin in the middle of the box's floor
  std::string tool_frame = "haptolith_tool";  ///< the tool's
  bool takes_target = false;                  ///< whether ~/target_pose is read, and ~/felt_wrench published
};

/// Counts of messages by result.
struct SceneMessageCounts {
  std::uint64_t ticks = 0;      ///< published ticks: a pose and a wrench each
  std::uint64_t not_told = 0;   ///< unpublished ticks: this thread was delayed for too long, or DDS accepted none
  std::uint64_t surfaces = 0;   ///< pictures of the soil
  std::uint64_t targets = 0;    ///< accepted targets
  std::uint64_t strangers = 0;  ///< targets from another writer than the one that holds the tool
  std::uint64_t nonsense = 0;   ///< NaN, infinite, an orientation not of unit length, or another frame
};

/// Publishes a scene to a ROS 2 graph, and receives targets of the tool from it, on a separate thread:
///
///     ~/tool_pose     geometry_msgs/PoseStamped    each tick; bed's frame
///     ~/wrench        geometry_msgs/WrenchStamped  each tick; of the soil on the tool about its origin; tool's frame
///     ~/felt_wrench   geometry_msgs/WrenchStamped  each tick; the same, as a hand may feel it; with takes_target
///     ~/surface       sensor_msgs/PointCloud2      with show(); bed's frame
///     /tf             tf2_msgs/TFMessage           50 times a second: the tool's frame in the bed's
///     ~/target_pose   geometry_msgs/PoseStamped    taken; bed's frame; with takes_target
///
/// The first writer of targets holds the tool until it has been silent for a second.
class ScenePublisher {
 public:
  /// @throws Failure as Ros2Node, and when there is no thread.
  ScenePublisher(Ros2Node& node, const ScenePublisherParameters& parameters, double tick_s);
  ~ScenePublisher();
  ScenePublisher(const ScenePublisher&) = delete;
  ScenePublisher& operator=(const ScenePublisher&) = delete;

  /// Ticks one after the other, from one thread at a time; waits for nothing and allocates nothing.
  void add(std::span<const TickRecord> ticks) noexcept;

  /// Publishes the soil: a picture takes a few milliseconds, on a separate thread; returns false without effect while
  /// one is being made.
  bool show(SeenSoil soil, const HeightGrid& grid);

  /// Inbox of the targets.
  [[nodiscard]] std::shared_ptr<TargetInbox> inbox() const noexcept;
  /// Counts of all ticks added so far, for which it waits at most a second. From any thread but the tick's.
  [[nodiscard]] SceneMessageCounts counts() const noexcept;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Cells for pictures of a bed: as wide as a grain, but no more than 128 along a side.
[[nodiscard]] HeightGrid surfaceGrid(const BedParameters& bed);

}  // namespace haptolith
