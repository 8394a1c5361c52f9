#include "haptolith/ros2/scene_publisher.h"

#include <boost/lockfree/spsc_queue.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <future>
#include <thread>
#include <utility>

#include "haptolith/core/platform/clock.h"
#include "haptolith/core/platform/start_thread.h"
#include "haptolith/core/process/async.h"
#include "haptolith/ros2/dds_endpoint.h"

namespace haptolith {

namespace {

using namespace std::chrono_literals;

constexpr auto kLook = 500us;                 // sleep of the thread between two polls
constexpr std::size_t kTicksInFlight = 1024;  // a second of them
constexpr double kTransform_s = 0.02;
constexpr std::int64_t kHolder_ns = 1'000'000'000;  // as the network device's

/// The published part of a tick.
struct ToldTick {
  double time_s = 0;
  Pose scene_T_tool;
  Wrench soil, device;
};

/// Times of ticks by the wall clock: evenly spaced, although they are received in bursts. The tick with the smallest
/// delay gives the offset of the two clocks; it changes after a pause or in slow motion.
class TickStamps {
 public:
  std::int64_t of(double time_s, std::int64_t now_ns) noexcept {
    constexpr std::int64_t kOtherwise_ns = 50'000'000;
    const std::int64_t tick_ns = std::llround(1e9 * time_s);
    const std::int64_t ahead_ns = now_ns - tick_ns;
    if (!known_ || ahead_ns < ahead_ns_ || ahead_ns - ahead_ns_ > kOtherwise_ns) {
      known_ = true;
      ahead_ns_ = ahead_ns;
    }
    last_ns_ = std::max(last_ns_ + 1, ahead_ns_ + tick_ns);  // ROS 2 takes stamps that go back for a new beginning
    return last_ns_;
  }

 private:
  bool known_ = false;
  std::int64_t ahead_ns_ = 0, last_ns_ = 0;
};

Wrench inTool(const Wrench& scene, const Pose& scene_T_tool) noexcept {
  const Quat back = scene_T_tool.orientation.conjugate();
  return {back * scene.force_n, back * scene.torque_nm};
}

}  // namespace

class ScenePublisher::Implementation {
 public:
  Implementation(Ros2Node& node, const ScenePublisherParameters& parameters, double tick_s)
      : parameters_(parameters),
        transform_ticks_(std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(kTransform_s / tick_s)))),
        pose_(node, "~/tool_pose", Ros2Qos::kStream),
        wrench_(node, "~/wrench", Ros2Qos::kStream),
        surface_(node, "~/surface", Ros2Qos::kMap),
        transform_(node, "/tf", Ros2Qos::kMap) {
    if (parameters.takes_target) {
      felt_.emplace(node, "~/felt_wrench", Ros2Qos::kStream);
      target_.emplace(node, "~/target_pose");
    }
    node.announce();
    thread_ = startThread("the ROS 2 publisher", [this] {
      while (!ends_) {
        work();
        std::this_thread::sleep_for(kLook);
      }
      work();
    });
  }
  ~Implementation() {
    ends_ = true;
    thread_.join();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void add(std::span<const TickRecord> ticks) noexcept {
    added_.fetch_add(ticks.size(), std::memory_order_relaxed);
    for (const TickRecord& tick : ticks) {
      if (!ticks_.push({tick.time_s, tick.scene_T_tool, tick.soil, tick.sent.wrench})) {
        not_told_.fetch_add(1, std::memory_order_relaxed);
      }
    }
  }

  bool show(SeenSoil soil, const HeightGrid& grid) {
    if (picture_.valid()) {
      if (!isThere(picture_)) {
        return false;
      }
      picture_.get();
    }
    picture_ = setOut(Work::kBeside, [this, soil = std::move(soil), grid] { tellSurface(soil, grid); });
    return true;
  }

  [[nodiscard]] std::shared_ptr<TargetInbox> inbox() const noexcept { return inbox_; }

  [[nodiscard]] SceneMessageCounts counts() const noexcept {
    constexpr std::int64_t kLongest_ns = 1'000'000'000;
    const std::int64_t until_ns = monotonicNs() + kLongest_ns;
    while (told_ + not_told_ < added_ && monotonicNs() < until_ns) {
      std::this_thread::sleep_for(kLook);
    }
    return {told_, not_told_, surfaces_, targets_, strangers_, nonsense_};
  }

 private:
  void work() {
    ticks_.consume_all([this](const ToldTick& tick) { tell(tick); });
    if (target_) {
      target_->take([this](const PoseMessage& message, std::uint64_t writer) { take(message, writer); });
    }
  }

  void tell(const ToldTick& tick) {
    const std::int64_t stamp_ns = stamps_.of(tick.time_s, wallClockNs());
    const PoseMessage pose{headerOf(stamp_ns, parameters_.bed_frame), messageOf(tick.scene_T_tool)};
    const auto wrench_of = [&](const Wrench& scene) {
      return WrenchMessage{headerOf(stamp_ns, parameters_.tool_frame), messageOf(inTool(scene, tick.scene_T_tool))};
    };
    bool told = pose_.write(pose);
    told = wrench_.write(wrench_of(tick.soil)) && told;
    if (felt_) {
      told = felt_->write(wrench_of(tick.device)) && told;
    }
    if (ticks_told_++ % transform_ticks_ == 0) {
      tellTransform(stamp_ns, tick.scene_T_tool);
    }
    (told ? told_ : not_told_).fetch_add(1, std::memory_order_relaxed);
  }

  void tellTransform(std::int64_t stamp_ns, const Pose& scene_T_tool) {
    geometry_msgs_msg_dds__TransformStamped_ stamped{
        headerOf(stamp_ns, parameters_.bed_frame),
        textOf(parameters_.tool_frame),
        {messageOf(scene_T_tool.position_m), messageOf(scene_T_tool.orientation)}};
    const TransformsMessage transforms{{1, 1, &stamped, false}};
    (void)transform_.write(transforms);
  }

  void tellSurface(const SeenSoil& soil, const HeightGrid& grid) {
    const auto rays = static_cast<std::size_t>(std::max(1.0, std::round(2 * grid.cell_m / soil.radius_m)));
    const std::vector<double> heights_m = surfaceHeights(soil, grid, rays);
    constexpr std::uint32_t kPointBytes = 3 * sizeof(float);
    constexpr std::uint8_t kFloat32 = 7;  // sensor_msgs/PointField
    std::vector<std::uint8_t> data(kPointBytes * grid.cells());
    for (std::size_t i = 0; i < grid.cells(); ++i) {
      const std::size_t row_number = i / grid.columns;
      const double column = static_cast<double>(i % grid.columns) + 0.5;
      const double row = static_cast<double>(row_number) + 0.5;
      const std::array point{static_cast<float>(grid.x_m + column * grid.cell_m),
                             static_cast<float>(grid.y_m + row * grid.cell_m), static_cast<float>(heights_m[i])};
      std::memcpy(&data[i * kPointBytes], point.data(), kPointBytes);
    }
    const std::array<std::string, 3> names{"x", "y", "z"};
    std::array<sensor_msgs_msg_dds__PointField_, 3> fields{};
    for (std::uint32_t i = 0; i < fields.size(); ++i) {
      fields[i] = {textOf(names[i]), static_cast<std::uint32_t>(i * sizeof(float)), kFloat32, 1};
    }
    CloudMessage cloud{};
    cloud.header = headerOf(wallClockNs(), parameters_.bed_frame);
    cloud.height = static_cast<std::uint32_t>(grid.rows);
    cloud.width = static_cast<std::uint32_t>(grid.columns);
    cloud.fields = {fields.size(), fields.size(), fields.data(), false};
    cloud.point_step = kPointBytes;
    cloud.row_step = static_cast<std::uint32_t>(kPointBytes * grid.columns);
    cloud.data = {static_cast<std::uint32_t>(data.size()), static_cast<std::uint32_t>(data.size()), data.data(), false};
    cloud.is_dense = true;
    if (surface_.write(cloud)) {
      surfaces_.fetch_add(1, std::memory_order_relaxed);
    }
  }

  void take(const PoseMessage& message, std::uint64_t writer) {
    const std::int64_t now_ns = monotonicNs();
    const std::string_view frame(message.header.frame_id);
    const std::optional<Pose> pose = poseOf(message.pose);
    if (!pose || (!frame.empty() && frame != parameters_.bed_frame)) {
      nonsense_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    if (writer != holder_ && now_ns - held_ns_ < kHolder_ns) {
      strangers_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    holder_ = writer;
    held_ns_ = now_ns;
    targets_.fetch_add(1, std::memory_order_relaxed);
    inbox_->draft() = {*pose, now_ns};
    inbox_->publish();
  }

  ScenePublisherParameters parameters_;
  std::uint64_t transform_ticks_;
  Ros2Writer<PoseMessage> pose_;
  Ros2Writer<WrenchMessage> wrench_;
  Ros2Writer<CloudMessage> surface_;
  Ros2Writer<TransformsMessage> transform_;
  std::optional<Ros2Writer<WrenchMessage>> felt_;
  std::optional<Ros2Reader<PoseMessage>> target_;

  boost::lockfree::spsc_queue<ToldTick> ticks_{kTicksInFlight};
  std::shared_ptr<TargetInbox> inbox_ = std::make_shared<TargetInbox>();
  std::atomic<std::uint64_t> added_{0}, told_{0}, not_told_{0}, surfaces_{0}, targets_{0}, strangers_{0}, nonsense_{0};

  // For the thread.
  TickStamps stamps_;
  std::uint64_t ticks_told_ = 0;
  std::uint64_t holder_ = 0;
  std::int64_t held_ns_ = -kHolder_ns;

  std::future<void> picture_;  // waits, when it goes, for what it uses
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

ScenePublisher::ScenePublisher(Ros2Node& node, const ScenePublisherParameters& parameters, double tick_s)
    : implementation_(std::make_unique<Implementation>(node, parameters, tick_s)) {}
ScenePublisher::~ScenePublisher() = default;

void ScenePublisher::add(std::span<const TickRecord> ticks) noexcept {
  implementation_->add(ticks);
}
bool ScenePublisher::show(SeenSoil soil, const HeightGrid& grid) {
  return implementation_->show(std::move(soil), grid);
}
std::shared_ptr<TargetInbox> ScenePublisher::inbox() const noexcept {
  return implementation_->inbox();
}
SceneMessageCounts ScenePublisher::counts() const noexcept {
  return implementation_->counts();
}

HeightGrid surfaceGrid(const BedParameters& bed) {
  constexpr double kMostAlongSide = 128;
  return gridWithinSides(bed, std::max(2 * bed.soil.radius_m, std::max(bed.width_m, bed.length_m) / kMostAlongSide));
}

}  // namespace haptolith
