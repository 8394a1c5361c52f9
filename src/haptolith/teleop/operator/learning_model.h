#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <map>
#include <optional>

#include "haptolith/core/process/async.h"
#include "haptolith/identify/model_learner.h"
#include "haptolith/identify/training/strength_map.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/teleop/link/robot_report.h"

namespace haptolith {

/// Whether a model's soil can adapt: not with ICRA 2021 friction, whose strength cannot be estimated from
/// digging.
[[nodiscard]] inline bool canLearn(const SceneFile& model) {
  return model.bed.soil.friction == FrictionModel::kContact;
}

/// A model that may learn: contacts without cohesion get a millionth of a newton of it, for a bed whose soil has none
/// does not look for neighbours as far away as cohesion reaches.
/// @throws InvalidParameter unless it canLearn().
[[nodiscard]] SceneFile readyToLearn(SceneFile model);

/// An operator's model whose soil becomes like that which the robot meets, while both dig.
///
/// 0.4 s of commands make a stretch, which counts where both soils push the tool back, as soil that is cut does. Each
/// time there is a new one, contact friction, cohesion and soil-tool friction set out for what all stretches nearby
/// say, in steps of a fiftieth of a second, while the tool is lifted: so that no force changes that a hand feels. In a
/// stroke of more than ten seconds they do so, too, then twenty times as slowly, so that the force should change by 1 %
/// in a tenth of a second. The soil lies as it lies: no bed has to be made, and none is cross-faded with another. Not
/// for the tick.
class LearningModel {
 public:
  /// @param model  readyToLearn().
  /// @param work  where what was met is thought about, which takes some hundredths of a second.
  LearningModel(const SceneFile& model, const StrengthMap& strengths, Work work = Work::kAtOnce);

  /// A report of the robot, and the mean of what was felt over the same commands. In any order, each once.
  void met(const RobotReport& report, const Vec3& displayed_n);

  /// Change of the model at tick `index`; empty: none now. Call it often, with a growing index.
  /// @param in_air  whether the hand feels no soil.
  [[nodiscard]] std::optional<SoilAdjustment> at(std::uint64_t index, bool in_air);
  /// The last step of at() could not be made: it is repeated.
  void refused();

  [[nodiscard]] const ModelSoil& learned() const noexcept { return learned_; }
  [[nodiscard]] const SoilState& state() const noexcept {
    return states_.back().state;
  }  ///< current state of the model
  [[nodiscard]] std::uint64_t updates() const noexcept { return updates_; }

  static constexpr std::uint64_t kStretchTicks = 400, kLongStrokeTicks = 10000;
  static constexpr double kChange_s = 0.1;  ///< change of ln F in a second, in a long stroke

 private:
  struct Window {
    double ticks = 0;
    Vec3 displayed = Vec3::Zero(), met = Vec3::Zero();  ///< sums over ticks
    RobotReport first, last;
  };
  struct StateFrom {
    std::uint64_t index;
    SoilState state;
  };
  void close(const Window& window);
  void setOutFor(const ModelSoil& learned);
  [[nodiscard]] SoilState stateOf(const SoilAdjustment& contacts) const;
  [[nodiscard]] const SoilState& stateAt(std::uint64_t index) const;

  StrengthMap strengths_;
  double tick_s_;
  ToolSurface tool_;
  SoilParameters soil_;  ///< as the model began
  SoilAdjustment now_, from_, to_;
  SoilAdjustment before_;     ///< the last step
  double gone_before_s_ = 0;  ///< its elapsed time
  ModelLearner learner_;
  std::deque<StateFrom> states_;
  std::map<std::uint64_t, Window> windows_;  ///< by their number
  std::uint64_t newest_ = 0;
  Vec3 place_m_ = Vec3::Zero();
  ToolCut cut_{.depth_m = 0.03, .rake_rad = 1.5};
  bool has_new_ = false;
  Work work_;
  std::future<ModelSoil> coming_;
  std::uint64_t looked_ = 0, stepped_ = 0, touched_ = 0, lifted_ = 0;
  double way_s_ = 0, gone_s_ = 0;  ///< from `from_` to `to_`, and of that so far
  ModelSoil learned_;
  std::uint64_t updates_ = 0;
};

}  // namespace haptolith
