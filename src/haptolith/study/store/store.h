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

/// Exploration of a stimulus, and the forces on the hand. NaN: not known.
struct TrialSummary {
  double duration_s = std::numeric_limits<double>::quiet_NaN();
  double path_m = std::numeric_limits<double>::quiet_NaN();  ///< of the tool
  double peak_speed_m_s = std::numeric_limits<double>::quiet_NaN();
  double mean_speed_m_s = std::numeric_limits<double>::quiet_NaN();
  double peak_force_n = std::numeric_limits<double>::quiet_NaN();
  double mean_force_n = std::numeric_limits<double>::quiet_NaN();
  double force_sd_n = std::numeric_limits<double>::quiet_NaN();
  double peak_torque_nm = std::numeric_limits<double>::quiet_NaN();
  double work_j = std::numeric_limits<double>::quiet_NaN();  ///< done by the hand on the soil
  int deadline_misses = 0;
};

/// A number of TrialSummary: its column in the store's table `felt` and, with "first_" or "second_" before it, in
/// exports.
struct SummaryColumn {
  std::string_view name, unit, meaning;
  double TrialSummary::*value;
};

/// All but deadline_misses.
[[nodiscard]] std::span<const SummaryColumn> summaryColumns();

/// How the work of a robot went in one trial. NaN: not known.
struct TeleopSummary {
  double done = std::numeric_limits<double>::quiet_NaN();  ///< 1: it was seen to be done at the site; 0: it was not
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

/// A number of TeleopSummary: its column in the store's table `teleop` and, with "teleop_" before it, in exports.
struct TeleopColumn {
  std::string_view name, unit, meaning;
  double TeleopSummary::*value;
};

[[nodiscard]] std::span<const TeleopColumn> teleopColumns();

/// A trial as it begins: what is to be felt.
struct TrialBegun {
  std::int64_t participant = 0;  ///< ParticipantRow::id
  std::size_t block = 0;         ///< of the protocol's blocks
  std::size_t position = 0;      ///< of the block in this participant's order
  int index = 0;                 ///< of the trial in the block, counted from 0
  int attempt = 0;               ///< counted from 0; another one after a trial that was lost or is repeated
  TrialKind kind = TrialKind::kMain;
  std::string block_name = {}, level = {}, reference = {};
  double value = 0, reference_value = 0;  ///< on the block's axis
  bool test_first = false;
  std::uint64_t seed = 0;
  std::string recording = {};  ///< names of its recordings before "-first.h5" and "-second.h5"; empty: none
};

struct TrialAnswer {
  bool positive = false;                    ///< the test was said to have more; means nothing when timed_out
  std::optional<bool> correct = {};         ///< none: the test has as much as the reference, or no answer came
  double reaction_s = 0;                    ///< from the question to the answer
  bool timed_out = false;                   ///< no answer came in time
  std::array<TrialSummary, 2> summaries{};  ///< in the first and in the second interval
  std::optional<TeleopSummary> teleop =
      {};  ///< of work for a robot, where nothing is asked: only summaries[0] counts beside it
};

/// kBegun: under way, or cut off by a crash, until somebody calls it lost. kRepeated: by the experimenter, who said
/// why; its answer, if it had one, is kept and does not count. kLost: no answer; done again.
enum class TrialState { kBegun, kAnswered, kRepeated, kLost };

struct TrialRow : TrialBegun {
  std::int64_t id = 0;
  TrialState state = TrialState::kBegun;
  std::optional<TrialAnswer> answer = {};
  std::string reason = {};                      ///< why it was repeated or lost
  std::string begun_at = {}, answered_at = {};  ///< UTC, "2026-11-21T10:00:00.123Z"
};

/// Where a participant belongs in a study with groups: decided once and never changed.
struct Assignment {
  std::string group = {};   ///< of the protocol's
  std::size_t stratum = 0;  ///< see stratumText()
  int place = 0;            ///< in the stratum's sequence, counted from 0
  int row = 0;              ///< of the Latin square of the group's blocks
};

struct ParticipantRow {
  std::int64_t id = 0;
  int number = 0;          ///< 1 is the first: chooses the sequence
  std::string code = {};   ///< the pseudonym: "S01"
  std::string state = {};  ///< "running", "finished" or "withdrawn"
  std::string begun_at = {}, ended_at = {};
  std::string excluded_for = {};  ///< why the analysis leaves them out; empty: it does not
  std::optional<Assignment> assignment = {};
};

/// What has become of a participant: "excluded", or the state.
[[nodiscard]] std::string_view standingOf(const ParticipantRow& participant);
/// Whether the analysis leaves them out: they withdrew, or are excluded.
[[nodiscard]] bool isLeftOut(const ParticipantRow& participant);

struct ExclusionRow {
  std::int64_t participant = 0;
  std::string at = {};
  bool excluded = false;  ///< false: taken back
  std::string reason = {};
};

/// An answer to a question of a form.
struct FormAnswerRow {
  std::int64_t participant = 0;
  std::string form = {}, key = {}, value = {};
  bool personal = false;
};

struct NoteRow {
  std::int64_t id = 0;
  std::int64_t participant = 0;  ///< 0: of the study
  std::string at = {}, kind = {}, text = {};
};

/// What is removed of a participant: all there is, or the answers to personal items.
enum class Removed { kEverything, kPersonal };

/// What becomes of the recordings of a participant who is removed.
enum class Recordings { kDelete, kKeep };

struct RemovalRow {
  Removed what = Removed::kEverything;
  std::string reason = {};
  std::string at = {};       ///< when it was asked for
  std::string done_at = {};  ///< empty: it is not at its end
};

/// A study in a file: its protocol, who has taken part and what they answered. What a call has written is on the disk
/// when it returns, and is there after a crash, a kill or a power cut; a call that throws has written nothing, and can
/// be made again. docs/reference/study-files.md describes the tables. Not for the tick; one thread at a time.
///
/// Every member throws Failure for a disk that is full, a file that is read-only, locked or damaged; the message says
/// which, and what to do.
class StudyStore {
 public:
  /// A new file, with the protocol as text and its scene as sceneFileText().
  /// @param seed  below 2^53.
  /// @throws Failure when the file exists or cannot be written; InvalidParameter for a scene that no file can hold.
  static void create(const std::filesystem::path& file, const StudyProtocol& protocol, std::string_view protocol_text,
                     std::uint64_t seed);

  /// kRead: reads, also while another program runs the study and in a folder that cannot be written. kRun: the only one
  /// that writes; the lock on FILE-lock is freed by the system when its process ends, however that comes.
  enum class Access { kRead, kRun };

  /// @throws InvalidParameter when there is no such file; Failure for a file of another kind or of a newer version, and
  /// for kRun when the study is run by somebody else.
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

  /// In the order of their numbers.
  [[nodiscard]] std::vector<ParticipantRow> participants() const;

  /// @param code  1 to 16 letters and digits, which nobody has or had; empty: "S01", "S02", ...
  /// @throws InvalidParameter for another code.
  ParticipantRow addParticipant(std::string_view code);

  /// @param state  "finished", "withdrawn", or "running" for somebody who comes back.
  void endParticipant(std::int64_t id, std::string_view state);

  /// Decides the group of a participant whose answers to the demographics are there: the next place of their stratum's
  /// sequence is theirs, for good. Whoever has a group keeps it.
  /// @throws InvalidParameter for a participant who has not answered what makes the strata.
  Assignment assignGroup(std::int64_t participant);
  /// How many places of each stratum's sequence have been given, also to those who were removed.
  [[nodiscard]] std::vector<int> placesGiven() const;

  /// Excludes a participant from the analysis, or takes that back; both are kept for good.
  /// @param reason  some words. @throws InvalidParameter for none, and when the participant stands so already.
  void setExcluded(std::int64_t participant, bool excluded, std::string_view reason);
  /// In the order in which they were made.
  [[nodiscard]] std::vector<ExclusionRow> exclusions() const;

  /// Remembers that a participant has agreed to the protocol's consent text, as it is shown. Once.
  void giveConsent(std::int64_t participant);
  [[nodiscard]] std::vector<ConsentRow> consents() const;

  /// Remembers what runs a part of the study. @return its id.
  std::int64_t beginSession(std::int64_t participant, const SessionBegun& session);
  void endSession(std::int64_t id, const std::optional<SessionCounts>& counts);
  /// In the order in which they began.
  [[nodiscard]] std::vector<SessionRow> sessions() const;

  /// Remembers that a participant has come so far: "consent", "block 0 done". Marking twice is marking once.
  void markStep(std::int64_t participant, std::string_view step);
  [[nodiscard]] std::set<std::string> steps(std::int64_t participant) const;

  /// The answers to a form; those to personal items go to their own table. A form that is filled in again replaces its
  /// answers.
  /// @throws InvalidParameter for a value whose item does not exist or does not allow it, and for a missing one that is
  /// required.
  void setAnswers(std::int64_t participant, std::string_view form, const std::vector<FormItem>& items,
                  const std::map<std::string, std::string>& values);

  /// @param personal  whether to read those of personal items, too.
  [[nodiscard]] std::vector<FormAnswerRow> formAnswers(bool personal) const;

  // What is deleted leaves no trace in the file. Each of the two removes all of it or, when another program has the
  // study open, nothing; one that a crash cuts off is brought to its end when the study is opened to be run.

  /// Deletes what a participant's personal items hold. @return how many.
  /// @throws Failure when another program has the study open.
  int forgetPersonal(std::int64_t participant, std::string_view reason = "");

  /// Deletes all there is of a participant. Notes and reasons of others lose the code. What stays is in removals(), and
  /// that nobody gets the number or the code again.
  /// @throws Failure when another program has the study open; when a recording cannot be deleted: then it is not at its
  /// end, as after a crash.
  void removeParticipant(std::int64_t participant, std::string_view reason = "",
                         Recordings recordings = Recordings::kDelete);

  /// In the order in which they were asked for.
  [[nodiscard]] std::vector<RemovalRow> removals() const;
  /// When a participant with that code was removed; empty: none was.
  [[nodiscard]] std::string removedAt(std::string_view code) const;

  // --- trials -------------------------------------------------------------------------------------------------------

  /// @return its id. @throws Failure when the participant has another trial under way, or has answered this one.
  std::int64_t beginTrial(const TrialBegun& trial);

  /// @throws Failure when the trial is not under way: it has an answer already, or was called lost.
  void answerTrial(std::int64_t id, const TrialAnswer& answer);

  /// Calls a trial under way lost or repeated, or an answered one repeated.
  /// @param state  kRepeated or kLost.
  void voidTrial(std::int64_t id, TrialState state, std::string_view reason);

  /// In the order in which they began.
  [[nodiscard]] std::vector<TrialRow> trials(std::int64_t participant) const;
  [[nodiscard]] std::vector<TrialRow> trials() const;

  // --- notes --------------------------------------------------------------------------------------------------------

  /// @param participant  0: of the study.
  /// @param kind  "note", "pause", "resume", "break", "program" or another word.
  void addNote(std::int64_t participant, std::string_view text, std::string_view kind);
  [[nodiscard]] std::vector<NoteRow> notes() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The words of the store and of exports: "practice", "main", "catch"; "begun", "answered", "repeated", "lost".
[[nodiscard]] std::string_view wordOf(TrialKind kind);
[[nodiscard]] std::string_view wordOf(TrialState state);

}  // namespace haptolith
