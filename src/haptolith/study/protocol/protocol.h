#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptolith/psychometrics/adaptive/quest_plus.h"
#include "haptolith/psychometrics/adaptive/staircase.h"
#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/site_task.h"
#include "haptolith/session/scene_change.h"

namespace haptolith {

/// One value of what a block varies, and how the scene comes to show it.
struct Stimulus {
  std::string name = {};    ///< "P1", "Mars", "0.85": unique in its block
  double value = 0;         ///< on the axis of the psychometric function
  SceneChange change = {};  ///< of the block's scene
};

/// What a trial asks. kReferenceFirst: the reference, then the test; "was the second heavier?" (the paper's).
/// kRandomOrder: the same question with the order drawn. kTwoInterval: "which of the two was heavier?", the first or
/// the second. Whatever is asked, a stored answer is positive when the test was said to have more.
enum class TaskKind { kReferenceFirst, kRandomOrder, kTwoInterval };

/// Who chooses the levels: a list made beforehand, or the answers so far.
enum class ProcedureKind { kConstant, kStaircase, kQuestPlus };

/// A question of a form.
struct FormItem {
  enum class Kind { kText, kNumber, kChoice, kScale, kYesNo };

  std::string key = {}, label = {};
  Kind kind = Kind::kText;
  std::vector<std::string> choices = {};        ///< of a choice
  double low = 0, high = 0;                     ///< ends of a scale, or of what a number may be; equal: any number
  std::string low_label = {}, high_label = {};  ///< of a scale
  std::vector<double> cut_points = {};  ///< ascending: where a number is cut into strata, each cut in the upper part
  bool required = false;
  bool personal = false;  ///< kept in the table that an export leaves out
};

/// What the hand feels while a robot far away does the work. kNone: nothing; kModel: soil of its own, which stays as it
/// is; kLearning: soil of its own, which becomes like what the robot meets.
enum class TeleopForce { kNone, kModel, kLearning };

/// What the trials of a block are where they compare nothing: a task at the site of a robot, which is led over a link
/// with delay. What is felt is the block's scene.
struct TeleopWork {
  SiteTask task = SiteTask::kTrench;
  TeleopForce force = TeleopForce::kLearning;
  double round_trip_s = 0;
  std::string site = "dig-site";  ///< built-in scene that the robot digs in
};

struct StudyBlock {
  std::string name = {}, title = {}, instructions = {}, question = {};
  std::string hypothesis = {};              ///< for the preregistration
  std::array<std::string, 2> answers = {};  ///< shown left and right; [1] is the positive one, or "the second"
  std::string axis_label = {};              ///< "friction coefficient"; with its unit where it has one
  bool log_axis = false;
  SceneChange scene = {};  ///< what the block changes of the study's scene
  Stimulus reference = {};
  std::vector<Stimulus> levels = {};      ///< in the order of their values, the smallest first
  std::optional<TeleopWork> teleop = {};  ///< then reference and the only level are its name and round trip
  TaskKind task = TaskKind::kReferenceFirst;
  ProcedureKind procedure = ProcedureKind::kConstant;
  int repeats = 3;                             ///< constant: of each level
  StaircaseOptions staircase = {};             ///< over the values of `levels`; its seed is each participant's
  QuestPlusOptions quest_plus = {};            ///< over the values of `levels`
  int practice_trials = 0;                     ///< before the others
  std::vector<Stimulus> practice_levels = {};  ///< what they show; empty: all levels
  int practice_rounds = 1;                     ///< of practice at most, each of so many trials
  double practice_criterion = 0;               ///< share right that ends practice
  int catch_trials = 0;                        ///< among the others
  std::vector<Stimulus> catch_levels = {};     ///< what they show; empty: the level farthest from the reference
  double catch_criterion = 0;                  ///< share right below which a participant does not attend
  bool feedback = false;                       ///< whether a participant is told that an answer was right
  bool practice_feedback = true;               ///< the same in practice trials
  bool visual = true;                          ///< false: the participant's page is blank while a stimulus is felt
  double visual_delay_s = 0;                   ///< how much later than the force its picture is seen; 0 if not visual
  double interval_s = 0;                       ///< longest time with one stimulus; 0: until the participant goes on
  double between_intervals_s = 0.25;           ///< from the end of the first stimulus to the beginning of the second
  double between_trials_s = 0.25;              ///< from the answer (and its feedback) to the next first stimulus
  double answer_limit_s = 0;                   ///< longest time for an answer; 0: none
  int break_every_trials = 0;                  ///< 0: no breaks
  double break_s = 0;                          ///< shortest length of a break
  std::vector<FormItem> questionnaire = {};    ///< after the block
};

/// In what order a participant comes to the blocks. kLatinSquare: each block is in each place equally often, and before
/// and after each other block equally often (Williams 1949).
enum class BlockOrder { kFixed, kLatinSquare, kRandom };

/// Participants who go through the same blocks, and nobody of another group with them.
struct ParticipantGroup {
  std::string name = {};
  std::vector<std::size_t> blocks = {};  ///< of the protocol's, in the order of the group's list
  int share = 1;                         ///< of all participants, over the sum of all groups' shares
};

/// How participants come into groups. kAlternate: in turn. kRandom: in permuted blocks, whose order is drawn.
/// kStratified: the same within each stratum.
enum class AssignmentMethod { kAlternate, kRandom, kStratified };

struct GroupAssignment {
  AssignmentMethod method = AssignmentMethod::kRandom;
  int block_size = 0;                    ///< participants in a permuted block, in which each group has its share
  std::vector<std::string> strata = {};  ///< keys of the demographics items whose answers make the strata
};

/// A user study before anybody has taken part.
struct StudyProtocol {
  std::string title = {}, consent = {}, instructions = {}, thanks = {};
  SceneFile scene = {};
  BlockOrder order = BlockOrder::kFixed;
  std::vector<StudyBlock> blocks = {};
  std::vector<ParticipantGroup> groups = {};  ///< empty: everybody goes through all blocks
  GroupAssignment assignment = {};            ///< where there are groups
  std::vector<FormItem> demographics = {};    ///< before the first block
  std::vector<FormItem> questionnaire = {};   ///< after the last
  int planned_participants = 0;               ///< that shall finish, the stopping rule; 0: the protocol does not say
  bool record = true;                         ///< each trial into a recording of its own
  std::string consent_version = {};           ///< empty: the hash of the text stands for it
  std::string language = "en";                ///< of all texts
  std::vector<std::string> authors = {};
};

/// Reads a protocol; docs/reference/protocol-keys.md and protocol-tables.md list every key.
/// @throws InvalidParameter for an unknown key, a wrong type or a value that is not valid, with file, line, key, value
/// and what would be valid; Failure when the file cannot be read.
[[nodiscard]] StudyProtocol loadProtocol(const std::filesystem::path& path);

/// The same for a text that is no file; messages call it `name`, and a scene's file lies beside what that would be.
/// With a scene given, the one that the text names is not read.
[[nodiscard]] StudyProtocol loadProtocolText(std::string_view toml, std::string_view name,
                                             const SceneFile* scene = nullptr);

/// The text of a protocol, and what messages call it.
struct ProtocolText {
  std::string name, text;
};

/// The built-in protocol of that name, upper and lower case alike; otherwise the file of that name.
/// @throws InvalidParameter listing the built-in names when it is neither; Failure when the file cannot be read.
[[nodiscard]] ProtocolText findProtocol(std::string_view name_or_file);

/// @throws InvalidParameter naming the first text in [BRACKETS] that is left in the consent page.
void requireFilledIn(const StudyProtocol& protocol);

/// The built-in protocols: the files in protocols/.
[[nodiscard]] std::vector<std::string_view> protocolNames();

/// The scene that shows one stimulus of a block. @throws InvalidParameter, Failure: as changed().
[[nodiscard]] SceneFile sceneOf(const StudyProtocol& protocol, const StudyBlock& block, const Stimulus& stimulus);

/// The level farthest from the reference on the block's axis, the smaller one of two.
[[nodiscard]] std::size_t farthestLevel(const StudyBlock& block);

/// The six scales of the NASA Task Load Index, 0 to 100 in steps of 5 (Hart and Staveland 1988).
[[nodiscard]] std::span<const FormItem> nasaTaskLoadIndex();

}  // namespace haptolith
