#pragma once

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/core/platform/last_resort.h"
#include "haptolith/device/device_group.h"
#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/haptics/loop/loop_thread.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/session/scene_change.h"
#include "haptolith/tool/tool_mesh.h"

namespace haptolith {

/// A scene that runs, and may be changed while it does: soil, world, tool and hand. Beds are made on a separate
/// thread while the current one continues, and replace it without a jump of force. All calls from one thread,
/// which is not the loop's; none of them can delay a tick.
class Session {
 public:
  /// Makes the first bed, reporting to `progress`, and opens the scene file's device, unless it is given another.
  /// @throws InvalidParameter, Failure: as Scene, VirtualHand, openDevice() and HapticLoop.
  Session(SceneFile scene_file, bool keep_records, const SettleProgress& progress = {},
          std::unique_ptr<HapticDevice> device = nullptr);
  ~Session();

  /// Starts the loop; `stop` ends it. @throws InvalidParameter as requireUsableCpu(). Where there are no threads, the
  /// caller ticks loop() instead.
  void start(std::atomic<bool>& stop);
  [[nodiscard]] bool done() const { return thread_ && thread_->done(); }
  /// Waits for the loop's end.
  LoopEnd join();
  /// Privileges of the loop's thread; empty without one.
  [[nodiscard]] RealTime realTime() const { return thread_ ? thread_->realTime() : RealTime{}; }

  /// Completes work of other threads: call it at about 100 Hz. True when sceneFile() or scenes() has
  /// changed.
  bool poll();

  /// Takes the newest snapshot; false when snapshot() is the newest.
  bool update();
  [[nodiscard]] const SceneSnapshot& snapshot() const { return snapshots_->latest(); }

  // --- changes: @throws InvalidParameter, Failure as changed(), Failure when there is no thread or no memory for
  // another bed; then nothing has changed. Changes that must wait for a bed under construction are made when it
  // arrives.

  void change(const SceneChange& change);
  /// Uses another mesh as the tool, made on a separate thread: it arrives with a later poll(), or problem() has the
  /// reason.
  void takeToolMesh(ToolMeshSource source);
  void reset();  ///< the scene as it was started
  /// Shows the initial scene with these changes, applied in order, and a separate bed, level and untouched.
  void show(std::span<const SceneChange> changes);
  void level();  ///< makes the soil level again
  /// Makes the soil one step coarser (makeCoarser()), level; reset() and show() keep it so. Another step may be asked
  /// for while a bed is being made.
  void coarsen();
  void undo();  ///< the bed as it was before the last new one; a second undo brings that back

  /// Changes the soil that is shown and the tool's friction in it a little, at once. False, and nothing is changed,
  /// while the loop takes no more, or another bed, soil or tool is on its way; or where soil coheres that did not
  /// before. @throws InvalidParameter outside their ranges.
  [[nodiscard]] bool adjust(const SoilAdjustment& adjustment);

  /// Lets a grain lie elsewhere, if it may (Scene::moveGrain()). False, and nothing is asked for, while the run is
  /// paused or the loop takes no more, or another bed is on its way.
  [[nodiscard]] bool moveGrain(const GrainMove& move);

  /// Whether the tool touches the soil: it fades out of it in a tenth of a second, and into it again. A bed that comes
  /// shown meanwhile is not touched.
  void touch(bool on);

  void pause();
  void resume();
  void advance(int ticks);       ///< only while paused
  void setSpeed(double factor);  ///< speed of a simulated hand's time; a person's is real time

  // While a virtual hand has the tool of that number:
  void hold(const Pose& scene_T_tool, std::size_t tool = 0);
  void release(std::size_t tool = 0);  ///< the tool stays where it is
  void play(HandMotion motion, std::size_t tool = 0);

  // --- what there is

  /// The scene as it is wanted; the bed of it may still be on its way.
  [[nodiscard]] const SceneFile& sceneFile() const noexcept { return wanted_; }
  /// The scene that is shown.
  [[nodiscard]] const SceneFile& shown() const noexcept { return current_.scene_file; }
  [[nodiscard]] const Scene& scene() const noexcept { return *current_.scene; }
  /// Number of beds so far: particle indices are valid within one bed.
  [[nodiscard]] std::uint32_t scenes() const noexcept { return scenes_; }
  /// Height of the soil's surface when the bed that is shown was made, in m.
  [[nodiscard]] double surface() const noexcept { return current_.fresh->surface_m; }
  [[nodiscard]] double speed() const noexcept { return speed_; }
  [[nodiscard]] const std::optional<Pose>& held(std::size_t tool = 0) const { return hands_.at(tool).command.held; }
  [[nodiscard]] HandMotion motion(std::size_t tool = 0) const { return hands_.at(tool).command.motion; }
  [[nodiscard]] std::size_t tools() const noexcept { return hands_.size(); }
  /// Range of the tool's targets, in m.
  [[nodiscard]] Vec3 workspaceLow() const noexcept;
  [[nodiscard]] Vec3 workspaceHigh() const noexcept;
  /// Whether the bed that was wanted last is there.
  [[nodiscard]] bool settled() const noexcept { return bed_wanted_.empty() && !making_ && !coming_; }
  /// Description of the current long work; empty without any.
  [[nodiscard]] std::string busy() const;
  /// Change that undo() would revert; empty without one.
  [[nodiscard]] std::string_view undoable() const noexcept { return previous_ ? previous_->replaced_by : ""; }
  /// Whether undo() would bring back what the last undo() took back.
  [[nodiscard]] bool undoRedoes() const noexcept { return previous_ && previous_->taken_back; }
  /// Why the last bed or mesh could not be made; empty when it could.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
  [[nodiscard]] std::string_view deviceName() const { return device().name(); }
  [[nodiscard]] const HapticDevice& device(std::size_t tool = 0) const { return *hands_.at(tool).device; }
  /// Whether a person is at a device with force feedback that has not tripped: changes of the scene change their
  /// force. Also in a pause.
  [[nodiscard]] bool personFeels() const;

  /// Number of ticks in the newest snapshot; 0 before the first.
  [[nodiscard]] std::uint64_t loopTicks() const noexcept { return snapshot().ticks; }

  [[nodiscard]] HapticLoop& loop() noexcept { return *loop_; }
  [[nodiscard]] const HapticLoop& loop() const noexcept { return *loop_; }

 private:
  /// State of a new bed: level, and at rest.
  struct Fresh {
    BedParameters bed;  ///< its parameters
    SavedScene saved;
    std::size_t held = 0;  ///< number of held particles, see LyingSoil
    double surface_m = 0;
  };
  /// A bed that is, was or will be shown.
  struct Showing {
    SceneFile scene_file;   ///< requested and applied state of this bed
    BedParameters made_of;  ///< parameters that its lists and steps suit
    std::shared_ptr<const Fresh> fresh;
    std::unique_ptr<Scene> scene;
    std::unique_ptr<ShownScene> own_shown;  ///< none for the first: the loop has that
    ShownScene* shown = nullptr;
    std::string_view replaced_by;
    bool taken_back = false;  ///< by undo()
  };
  /// The device that moves a tool.
  struct Hand {
    std::unique_ptr<HapticDevice> device;
    VirtualHand* virtual_hand = nullptr;  ///< the device, when it is one
    HandCommand command;
  };
  struct Making;
  struct MakingMesh;

  [[nodiscard]] static Showing showNew(const SceneFile& scene_file, const SettleProgress& progress);
  [[nodiscard]] static Showing showFresh(const SceneFile& scene_file, std::shared_ptr<const Fresh> fresh);
  [[nodiscard]] static Showing showLying(const SceneFile& scene_file, const LyingSoil& lying,
                                         std::shared_ptr<const Fresh> fresh);
  void wantBed(std::string_view why);
  void pursue();
  void changeWhatIsThere();
  bool replaceTools();
  void make(std::string_view why, bool as_it_lies);
  [[nodiscard]] std::shared_ptr<const Fresh> freshFor(const SceneFile& scene_file) const;
  void keepFresh(std::shared_ptr<const Fresh> fresh);
  bool takeMade();
  bool takeMadeMesh();
  bool takeStage();
  void bringOnStage(Showing next);
  void ask(const LoopRequest& request);
  void openHands(std::unique_ptr<HapticDevice> device);
  [[nodiscard]] Hand openHand(std::unique_ptr<HapticDevice> device) const;
  [[nodiscard]] std::vector<ToolHandling> handlings();
  [[nodiscard]] Hand& requireVirtualHand(const char* asked, std::size_t tool);
  static void commandHand(Hand& hand);
  void tellMotion(SceneFile& scene_file) const;

  SceneFile initial_, wanted_;
  Showing current_;
  std::optional<Showing> previous_, coming_;
  bool coming_is_asked_for_ = false;
  std::unique_ptr<Making> making_;
  std::unique_ptr<MakingMesh> making_mesh_;
  std::string_view bed_wanted_;  ///< why another bed is wanted when nothing is on its way any more; empty: it is not
  std::vector<std::shared_ptr<const Fresh>> fresh_;  ///< beds that need not settle again, the newest last
  bool paused_ = false;
  std::uint32_t scenes_ = 1;
  double speed_ = 1;
  std::string problem_;

  std::vector<Hand> hands_;  ///< one per tool
  std::optional<DeviceGroup> at_people_;
  std::optional<LastResort> last_resort_;
  std::unique_ptr<HapticLoop> loop_;
  LatestValue<SceneSnapshot>* snapshots_ = nullptr;
  std::unique_ptr<LoopThread> thread_;  // the last member: it ends before what it uses
};

}  // namespace haptolith
