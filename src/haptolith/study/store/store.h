#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/study/protocol/protocol.h"
#include "haptolith/study/protocol/sequence.h"
#include "haptolith/study/store/provenance.h"

namespace haptolith {

/// Movements in one exploration of a stimulus, and forces on the hand. NaN: unknown.
struct TrialSummary {
  double duration_s = std::numeric_limits<double>::quiet_NaN();
  double path_m = std::numeric_limits<double>::quiet_NaN();  ///< path length of the tool
  double peak_speed_m_s = std::numeric_limits<double>::quiet_NaN();
  double mean_speed_m_s = std::numeric_limits<double>::quiet_NaN();
  double peak_force_n = std::numeric_limits<double>::quiet_NaN();
  double mean_force_n = std::numeric_limits<double>::quiet_NaN();
  double force_sd_n = std::numeric_limits<double>::quiet_NaN();
  double peak_torque_nm = std::numeric_limits<double>::quiet_NaN();
  double work_j = std::numeric_limits<double>::quiet_NaN();  ///< done by the hand on the soil
  int deadline_misses = 0;
};

/// Member of TrialSummary and its column: in the store's table `felt` and, with prefix "first_" or "second_", in
/// exports.
struct SummaryColumn {
  std::string_view name, unit, meaning;
  double TrialSummary::*value;
};

/// Returns all members except deadline_misses.
[[nodiscard]] std::span<const SummaryColumn> summaryColumns();

/// Results of a robot's task in one trial. NaN: unknown.
struct TeleopSummary {
  double done = std::numeric_limits<double>::quiet_NaN();  ///< 1: observed to be complete at the site; 0: not
  double time_s = std::numeric_limits<double>::quiet_NaN();
  double follows_s = std::numeric_limits<double>::quiet_NaN();
  double reached = std::numeric_limits<double>::quiet_NaN();
  double force_error = std::numeric_limits<double>::quiet_NaN();
  double met_rms_n = std::numeric_limits<double>::quiet_NaN();
  double met_peak_n = std::numeric_limits<double>::quiet_NaN();
  double stops = std::numeric_limits<double>::quiet_NaN();
  double friction_angle_deg = std::numeric_limits<double>::quiet_NaN();
  double cohesion_pa = std::numeric_limits<double>::quiet_NaN();
  double tool_friction_angle_deg = std::numeric_limits<double>::quiet_NaN();
};

/// Member of TeleopSummary and its column: in the store's table `teleop` and, with prefix "teleop_", in exports.
struct TeleopColumn {
  std::string_view name, unit, meaning;
  double TeleopSummary::*value;
};

[[nodiscard]] std::span<const TeleopColumn> teleopColumns();

/// Data of a trial at its beginning: its stimuli.
struct TrialBegun {
  std::int64_t participant = 0;  ///< ParticipantRow::id
  std::size_t block = 0;         ///< index in the protocol's blocks
  std::size_t position = 0;      ///< position of the block in this participant's order
  int index = 0;                 ///< index of the trial in the block, counted from 0
  int attempt = 0;               ///< counted from 0; increases when a trial was lost or is repeated
  TrialKind kind = TrialKind::kMain;
  std::string block_name = {}, level = {}, reference = {};
  double value = 0, reference_value = 0;  ///< values on the block's axis
  bool test_first = false;
  std::uint64_t seed = 0;
  std::string recording = {};  ///< file names of its recordings without "-first.h5" and "-second.h5"; empty: none
};

struct TrialAnswer {
  bool positive = false;                    ///< whether the test was judged to have more; undefined if timed_out
  std::optional<bool> correct = {};         ///< none: test and reference are equal, or there was no response
  double reaction_s = 0;                    ///< time from the question to the response
  bool timed_out = false;                   ///< whether there was no response in time
  std::array<TrialSummary, 2> summaries{};  ///< first and second interval
  std::optional<TeleopSummary> teleop =
      {};  ///< result of a robot's task, which has no question; only summaries[0] is then also valid
};

/// State of a trial. kBegun: running, or interrupted by a crash and not yet marked as lost. kRepeated: repeated by the
/// experimenter with a reason; a response is kept but not analysed. kLost: without a response, and repeated.
enum class TrialState { kBegun, kAnswered, kRepeated, kLost };

struct TrialRow : TrialBegun {
  std::int64_t id = 0;
  TrialState state = TrialState::kBegun;
  std::optional<TrialAnswer> answer = {};
  std::string reason = {};                      ///< reason for repeated or lost
  std::string begun_at = {}, answered_at = {};  ///< UTC, "2026-11-21T10:00:00.123Z"
};

/// Assignment of a participant in a study with groups: made once and never changed.
struct Assignment {
  std::string group = {};   ///< name of the protocol's group
  std::size_t stratum = 0;  ///< see stratumText()
  int place = 0;            ///< place in the stratum's sequence, counted from 0
  int row = 0;              ///< row of the Latin square of the group's blocks
};

struct ParticipantRow {
  std::int64_t id = 0;
  int number = 0;          ///< counted from 1; selects the sequence
  std::string code = {};   ///< pseudonym: "S01"
  std::string state = {};  ///< "running", "finished" or "withdrawn"
  std::string begun_at = {}, ended_at = {};
  std::string excluded_for = {};  ///< reason for the exclusion from the analysis; empty: not excluded
  std::optional<Assignment> assignment = {};
};

/// Returns "excluded", or the state.
[[nodiscard]] std::string_view standingOf(const ParticipantRow& participant);
/// Whether the analysis leaves the participant out, because they withdrew or are excluded.
[[nodiscard]] bool isLeftOut(const ParticipantRow& participant);

struct ExclusionRow {
  std::int64_t participant = 0;
  std::string at = {};
  bool excluded = false;  ///< false: exclusion revoked
  std::string reason = {};
};

/// Answer to a question of a form.
struct FormAnswerRow {
  std::int64_t participant = 0;
  std::string form = {}, key = {}, value = {};
  bool personal = false;
};

struct NoteRow {
  std::int64_t id = 0;
  std::int64_t participant = 0;  ///< 0: note on the study
  std::string at = {}, kind = {}, text = {};
};

/// Extent of a removal: all data of a participant, or the answers to personal items.
enum class Removed { kEverything, kPersonal };

/// Treatment of the recordings of a removed participant.
enum class Recordings { kDelete, kKeep };

struct RemovalRow {
  Removed what = Removed::kEverything;
  std::string reason = {};
  std::string at = {};       ///< time of the request
  std::string done_at = {};  ///< time of completion; empty: incomplete
};

/// Study in a file: its protocol, participants and their responses. A call returns after its data are on the disk,
/// where they survive a crash, a kill or a power cut. A call that throws has written nothing and can be repeated.
/// docs/reference/study-files.md describes the tables. Not for the tick; one thread at a time.
///
/// Every member throws Failure for a full disk and for a read-only, locked or damaged file. The message names the cause
/// and the remedy.
class StudyStore {
 public:
  /// Creates a file, with the protocol as text and its scene as sceneFileText().
  /// @param seed  below 2^53.
  /// @throws Failure if the file exists or cannot be written; InvalidParameter for a scene that cannot be written to a
  /// file.
  static void create(const std::filesystem::path& file, const StudyProtocol& protocol, std::string_view protocol_text,
                     std::uint64_t seed);

  /// Kind of access. kRead: reads, also while another program runs the study, and in a read-only folder. kRun:
  /// exclusive write access; the system frees the lock on FILE-lock at any end of the process.
  enum class Access { kRead, kRun };

  /// @throws InvalidParameter if the file does not exist; Failure for a file of another kind or of a newer version, and
  /// for kRun if another process runs the study.
  StudyStore(const std::filesystem::path& file, Access access);
  ~StudyStore();
  StudyStore(StudyStore&&) noexcept;
  StudyStore& operator=(StudyStore&&) noexcept;

  [[nodiscard]] const std::filesystem::path& file() const noexcept;
  [[nodiscard]] const StudyProtocol& protocol() const noexcept;
  [[nodiscard]] const std::string& protocolText() const noexcept;
  [[nodiscard]] std::uint64_t seed() const noexcept;
  [[nodiscard]] const std::string& title() const noexcept;
  [[nodiscard]] const std::string& createdAt() const noexcept;

  // --- participants -------------------------------------------------------------------------------------------------

  /// Returns the participants in the order of their numbers.
  [[nodiscard]] std::vector<ParticipantRow> participants() const;

  /// @param code  1 to 16 letters and digits, never used before in this study; empty: "S01", "S02", ...
  /// @throws InvalidParameter for an invalid or used code.
  ParticipantRow addParticipant(std::string_view code);

  /// @param state  "finished", "withdrawn", or "running" for a participant who resumes.
  void endParticipant(std::int64_t id, std::string_view state);

  /// Assigns a group permanently: the next place of the sequence of the participant's stratum. An existing assignment
  /// is returned unchanged.
  /// @throws InvalidParameter if answers that determine the stratum are missing.
  Assignment assignGroup(std::int64_t participant);
  /// Returns the number of assigned places of each stratum's sequence, including those of removed participants.
  [[nodiscard]] std::vector<int> placesGiven() const;

  /// Excludes a participant from the analysis, or revokes that; both are logged permanently.
  /// @param reason  not empty. @throws InvalidParameter for an empty reason, and if nothing would change.
  void setExcluded(std::int64_t participant, bool excluded, std::string_view reason);
  /// Returns the exclusions in the order of their times.
  [[nodiscard]] std::vector<ExclusionRow> exclusions() const;

  /// Stores that a participant has agreed to the protocol's consent text, as shown. Once.
  void giveConsent(std::int64_t participant);
  [[nodiscard]] std::vector<ConsentRow> consents() const;

  /// Stores the beginning of a session. @return its id.
  std::int64_t beginSession(std::int64_t participant, const SessionBegun& session);
  void endSession(std::int64_t id, const std::optional<SessionCounts>& counts);
  /// Returns the sessions in the order of their beginnings.
  [[nodiscard]] std::vector<SessionRow> sessions() const;

  /// Stores that a participant has finished a step: "consent", "block 0 done". Repeated calls have no effect.
  void markStep(std::int64_t participant, std::string_view step);
  [[nodiscard]] std::set<std::string> steps(std::int64_t participant) const;

  /// Stores the answers to a form, replacing earlier ones; answers to personal items are in a separate table.
  /// @throws InvalidParameter for an unknown item, a value that the item does not allow, and a missing required value.
  void setAnswers(std::int64_t participant, std::string_view form, const std::vector<FormItem>& items,
                  const std::map<std::string, std::string>& values);

  /// @param personal  whether to include answers to personal items.
  [[nodiscard]] std::vector<FormAnswerRow> formAnswers(bool personal) const;

  // Deleted data leave no trace in the file. Each of the two functions removes everything or, if another program has
  // the study open, nothing. A removal interrupted by a crash is completed when the study is next opened with kRun.

  /// Deletes a participant's answers to personal items. @return their number.
  /// @throws Failure if another program has the study open.
  int forgetPersonal(std::int64_t participant, std::string_view reason = "");

  /// Deletes all data of a participant, and the code in notes and reasons of others. removals() keeps an entry, and
  /// number and code are not assigned again.
  /// @throws Failure if another program has the study open, or if a recording cannot be deleted. The removal is then
  /// incomplete, as after a crash.
  void removeParticipant(std::int64_t participant, std::string_view reason = "",
                         Recordings recordings = Recordings::kDelete);

  /// Returns the removals in the order of their requests.
  [[nodiscard]] std::vector<RemovalRow> removals() const;
  /// Returns the time at which a participant with this code was removed; empty if there was none.
  [[nodiscard]] std::string removedAt(std::string_view code) const;

  // --- trials -------------------------------------------------------------------------------------------------------

  /// @return its id. @throws Failure if another trial of the participant is running, or if this one has a response.
  std::int64_t beginTrial(const TrialBegun& trial);

  /// @throws Failure if the trial is not running, because it already has a response or was marked as lost.
  void answerTrial(std::int64_t id, const TrialAnswer& answer);

  /// Marks a running trial as lost or repeated, or an answered one as repeated.
  /// @param state  kRepeated or kLost.
  void voidTrial(std::int64_t id, TrialState state, std::string_view reason);

  /// Returns the trials in the order of their beginnings.
  [[nodiscard]] std::vector<TrialRow> trials(std::int64_t participant) const;
  [[nodiscard]] std::vector<TrialRow> trials() const;

  // --- notes --------------------------------------------------------------------------------------------------------

  /// @param participant  0: note on the study.
  /// @param kind  "note", "pause", "resume", "break", "program" or another word.
  void addNote(std::int64_t participant, std::string_view text, std::string_view kind);
  [[nodiscard]] std::vector<NoteRow> notes() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

// Words in the store and in exports: "practice", "main", "catch"; "begun", "answered", "repeated", "lost".
[[nodiscard]] std::string_view wordOf(TrialKind kind);
[[nodiscard]] std::string_view wordOf(TrialState state);

}  // namespace haptolith
