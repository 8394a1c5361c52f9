#pragma once

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/device/hand/virtual_hand.h"
#include "haptolith/haptics/loop/haptic_loop.h"
#include "haptolith/haptics/loop/loop_thread.h"
#include "haptolith/haptics/safety/last_resort.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/session/scene_change.h"
#include "haptolith/tool/tool_mesh.h"

namespace haptolith {

/// A scene that runs, and may be changed while it does: soil, world, tool and hand. Beds are made on a thread of their
/// own while the one before goes on, and replace it without the hand feeling a jump. All calls from one thread,
/// which is not the loop's; none of them can delay a tick.
class Session {
 public:
  /// Makes the first bed, telling `progress`, and opens the scene file's device, unless it is given another.
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
  /// What the loop's thread was granted; nothing where it has none.
  [[nodiscard]] RealTime realTime() const { return thread_ ? thread_->realTime() : RealTime{}; }

  /// Moves on what others have finished: call it some hundred times a second. True when something has changed that
  /// sceneFile() and scenes() tell.
  bool poll();

  /// Moves on to the newest snapshot; false when there is none newer than snapshot().
  bool update();
  [[nodiscard]] const SceneSnapshot& snapshot() const { return snapshots_->latest(); }

  // --- changes: @throws InvalidParameter, Failure as changed(), Failure when there is no thread or no memory for
  // another bed; then nothing has changed. What cannot be done at once, because a bed is on its way, is done when that
  // has come.

  void change(const SceneChange& change);
  /// Another mesh as the tool, made on a thread of its own: it comes with a later poll(), or problem() says why not.
  void takeToolMesh(ToolMeshSource source);
  void reset();  ///< the scene as it was started
  /// The scene as it was started with these changes, one after the other, and a bed of its own, level and untouched.
  void show(std::span<const SceneChange> changes);
  void level();  ///< the same soil, level again
  /// The same soil one step coarser (makeCoarser()), level; reset() and show() keep it so. Another step may be asked
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
  void setSpeed(double factor);  ///< of a simulated hand's time; a person's runs as it does

  // While the virtual hand has the tool:
  void hold(const Pose& scene_T_tool);
  void release();  ///< the tool stays where it is
  void play(Manoeuvre manoeuvre);

  // --- what there is

  /// The scene as it is wanted; the bed of it may still be on its way.
  [[nodiscard]] const SceneFile& sceneFile() const noexcept { return wanted_; }
  /// The scene that is shown.
  [[nodiscard]] const SceneFile& shown() const noexcept { return current_.scene_file; }
  [[nodiscard]] const Scene& scene() const noexcept { return *current_.scene; }
  /// How many beds have been shown: particles of one are not those of another.
  [[nodiscard]] std::uint32_t scenes() const noexcept { return scenes_; }
  /// Height of the soil's surface when the bed that is shown was made, in m.
  [[nodiscard]] double surface() const noexcept { return current_.fresh->surface_m; }
  [[nodiscard]] double speed() const noexcept { return speed_; }
  [[nodiscard]] const std::optional<Pose>& held() const noexcept { return command_.held; }
  [[nodiscard]] Manoeuvre manoeuvre() const noexcept { return command_.manoeuvre; }
  /// Where the tool may be pulled to, in m.
  [[nodiscard]] Vec3 workspaceLow() const noexcept;
  [[nodiscard]] Vec3 workspaceHigh() const noexcept;
  /// Whether the bed that was wanted last is there.
  [[nodiscard]] bool settled() const noexcept { return bed_wanted_.empty() && !making_ && !coming_; }
  /// What takes a while just now, in words; empty when nothing does.
  [[nodiscard]] std::string busy() const;
  /// What undo() would take back; empty when nothing.
  [[nodiscard]] std::string_view undoable() const noexcept { return previous_ ? previous_->replaced_by : ""; }
  /// Whether undo() would bring back what the last undo() took back.
  [[nodiscard]] bool undoRedoes() const noexcept { return previous_ && previous_->taken_back; }
  /// Why the last bed or mesh could not be made; empty when it could.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
  [[nodiscard]] std::string_view deviceName() const noexcept { return device_->name(); }
  [[nodiscard]] const HapticDevice& device() const noexcept { return *device_; }
  /// Whether a person is at a device that shows forces, and has not been let go: what changes the scene changes what
  /// they feel. Also in a pause.
  [[nodiscard]] bool personFeels() const noexcept;

  /// How many ticks the newest snapshot knows of; 0 before the first.
  [[nodiscard]] std::uint64_t loopTicks() const noexcept { return snapshot().ticks; }

  [[nodiscard]] HapticLoop& loop() noexcept { return *loop_; }
  [[nodiscard]] const HapticLoop& loop() const noexcept { return *loop_; }

 private:
  /// How a bed lay when it was new: level, and at rest.
  struct Fresh {
    BedParameters bed;  ///< what it was made of
    SavedScene saved;
    std::size_t held = 0;  ///< of its particles, see LyingSoil
    double surface_m = 0;
  };
  /// A bed that is, was or will be shown.
  struct Showing {
    SceneFile scene_file;   ///< what has been asked for of this bed, and done
    BedParameters made_of;  ///< what its lists and steps are good for
    std::shared_ptr<const Fresh> fresh;
    std::unique_ptr<Scene> scene;
    std::unique_ptr<ShownScene> own_shown;  ///< none for the first: the loop has that
    ShownScene* shown = nullptr;
    std::string_view replaced_by;
    bool taken_back = false;  ///< by undo()
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
  void make(std::string_view why, bool as_it_lies);
  [[nodiscard]] std::shared_ptr<const Fresh> freshFor(const SceneFile& scene_file) const;
  void keepFresh(std::shared_ptr<const Fresh> fresh);
  bool takeMade();
  bool takeMadeMesh();
  bool takeStage();
  void bringOnStage(Showing next);
  void ask(const LoopRequest& request);
  void openHand(std::unique_ptr<HapticDevice> device);
  void requireVirtualHand(const char* asked) const;
  void commandHand();
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
  HandCommand command_;
  std::string problem_;

  std::unique_ptr<HapticDevice> device_;
  VirtualHand* hand_ = nullptr;  ///< the device, when it is one
  std::optional<LastResort> last_resort_;
  std::unique_ptr<HapticLoop> loop_;
  LatestValue<SceneSnapshot>* snapshots_ = nullptr;
  std::unique_ptr<LoopThread> thread_;  // the last member: it ends before what it uses
};

}  // namespace haptolith
