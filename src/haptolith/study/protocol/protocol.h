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

/// One value of the quantity that a block varies, and the corresponding change of the scene.
struct Stimulus {
  std::string name = {};    ///< "P1", "Mars", "0.85"; unique in its block
  double value = 0;         ///< position on the axis of the psychometric function
  SceneChange change = {};  ///< change of the block's scene
};

/// Task of a trial. kReferenceFirst: the reference, then the test; "was the second heavier?" (icra2021). kRandomOrder:
/// this question with randomised order. kTwoInterval: "which of the two was heavier?", the first or the second. In all
/// tasks a stored response is positive if the participant judged that the test has more.
enum class TaskKind { kReferenceFirst, kRandomOrder, kTwoInterval };

/// Selection of levels: from a predefined list (constant), or adapted to the responses so far.
enum class ProcedureKind { kConstant, kStaircase, kQuestPlus };

/// Question of a form.
struct FormItem {
  enum class Kind { kText, kNumber, kChoice, kScale, kYesNo };

  std::string key = {}, label = {};
  Kind kind = Kind::kText;
  std::vector<std::string> choices = {};        ///< options of a choice
  double low = 0, high = 0;                     ///< ends of a scale, or limits of a number; equal: any number
  std::string low_label = {}, high_label = {};  ///< labels of a scale's ends
  std::vector<double> cut_points = {};  ///< ascending limits between strata of a number; each belongs to the upper part
  bool required = false;
  bool personal = false;  ///< stored in a table that exports leave out by default
};

/// Force at the hand during teleoperation. kNone: no force; kModel: a static local soil model; kLearning: a local soil
/// model that adapts to the measurements at the robot.
enum class TeleopForce { kNone, kModel, kLearning };

/// Trials of a block without comparison: a task at the site of a robot, which is teleoperated over a link with delay.
/// The local soil model is the block's scene.
struct TeleopWork {
  SiteTask task = SiteTask::kTrench;
  TeleopForce force = TeleopForce::kLearning;
  double round_trip_s = 0;
  std::string site = "teleop-site";  ///< built-in scene of the robot
};

struct StudyBlock {
  std::string name = {}, title = {}, instructions = {}, question = {};
  std::string hypothesis = {};              ///< hypothesis in the preregistration
  std::array<std::string, 2> answers = {};  ///< labels, left and right; [1] is positive, or "the second"
  std::string axis_label = {};              ///< "friction coefficient"; with its unit, if it has one
  bool log_axis = false;
  SceneChange scene = {};  ///< the block's change of the study's scene
  Stimulus reference = {};
  std::vector<Stimulus> levels = {};      ///< in ascending order of their values
  std::optional<TeleopWork> teleop = {};  ///< if set, reference and the only level are its name and round trip
  TaskKind task = TaskKind::kReferenceFirst;
  ProcedureKind procedure = ProcedureKind::kConstant;
  int repeats = 3;                   ///< constant: repeats of each level
  StaircaseOptions staircase = {};   ///< over the values of `levels`; the seed is different for each participant
  QuestPlusOptions quest_plus = {};  ///< options over the values of `levels`
  int practice_trials = 0;           ///< practice trials, before the others
  std::vector<Stimulus> practice_levels = {};  ///< levels of practice trials; empty: all levels
  int practice_rounds = 1;                     ///< maximum number of rounds of `practice_trials` each
  double practice_criterion = 0;               ///< fraction correct that ends practice
  int catch_trials = 0;                        ///< catch trials, mixed with the others
  std::vector<Stimulus> catch_levels = {};     ///< levels of catch trials; empty: the level farthest from the reference
  double catch_criterion = 0;                  ///< fraction correct below which a participant counts as inattentive
  bool feedback = false;                       ///< whether the page shows if a response was correct
  bool practice_feedback = true;               ///< feedback in practice trials
  bool visual = true;                          ///< false: the participant's page is blank during a stimulus
  double visual_delay_s = 0;                   ///< delay of the visual display after the force; 0 if not visual
  double interval_s = 0;                       ///< maximum time with one stimulus; 0: until the participant continues
  double between_intervals_s = 0.25;           ///< pause between the first and the second stimulus
  double between_trials_s = 0.25;              ///< pause from the response (and its feedback) to the next trial
  double answer_limit_s = 0;                   ///< maximum time for a response; 0: no limit
  int break_every_trials = 0;                  ///< trials between breaks; 0: no breaks
  double break_s = 0;                          ///< minimum duration of a break
  std::vector<FormItem> questionnaire = {};    ///< form after the block
};

/// Order of the blocks. kLatinSquare: each block is at each position equally often, and directly follows each other
/// block equally often (Williams 1949).
enum class BlockOrder { kFixed, kLatinSquare, kRandom };

/// Group of participants with a common list of blocks. Each participant is in one group.
struct ParticipantGroup {
  std::string name = {};
  std::vector<std::size_t> blocks = {};  ///< indices of the protocol's blocks, in the order of the group's list
  int share = 1;                         ///< weight: the group gets share / (sum of all shares) of the participants
};

/// Assignment of participants to groups. kAlternate: in turn. kRandom: in randomly permuted blocks. kStratified: in
/// randomly permuted blocks within each stratum.
enum class AssignmentMethod { kAlternate, kRandom, kStratified };

struct GroupAssignment {
  AssignmentMethod method = AssignmentMethod::kRandom;
  int block_size = 0;  ///< participants in a permuted block, which contains each group according to its share
  std::vector<std::string> strata = {};  ///< keys of the demographics items whose answers make the strata
};

/// Protocol of a user study.
struct StudyProtocol {
  std::string title = {}, consent = {}, instructions = {}, thanks = {};
  SceneFile scene = {};
  BlockOrder order = BlockOrder::kFixed;
  std::vector<StudyBlock> blocks = {};
  std::vector<ParticipantGroup> groups = {};  ///< empty: all participants have all blocks
  GroupAssignment assignment = {};            ///< assignment to groups, if there are any
  std::vector<FormItem> demographics = {};    ///< form before the first block
  std::vector<FormItem> questionnaire = {};   ///< form after the last block
  int planned_participants = 0;               ///< stopping rule: number of participants who finish; 0: none
  bool record = true;                         ///< whether each trial is recorded, in a separate file
  std::string consent_version = {};           ///< empty: identified by the hash of the text
  std::string language = "en";                ///< language of all texts
  std::vector<std::string> authors = {};
};

/// Reads a protocol; docs/reference/protocol-keys.md and protocol-tables.md list every key.
/// @throws InvalidParameter for an unknown key, a wrong type or an invalid value, with file, line, key, value and valid
/// values; Failure if the file cannot be read.
[[nodiscard]] StudyProtocol loadProtocol(const std::filesystem::path& path);

/// As above, for a text instead of a file. Messages use `name` as its path, and a scene's file is resolved relative to
/// it. If a scene is given, the one named in the text is not read.
[[nodiscard]] StudyProtocol loadProtocolText(std::string_view toml, std::string_view name,
                                             const SceneFile* scene = nullptr);

/// Text of a protocol, and its name in messages.
struct ProtocolText {
  std::string name, text;
};

/// Returns the built-in protocol of this name (case-insensitive), or else the file of this name.
/// @throws InvalidParameter listing the built-in names if neither exists; Failure if the file cannot be read.
[[nodiscard]] ProtocolText findProtocol(std::string_view name_or_file);

/// Checks that the consent page has no [BRACKETS].
/// @throws InvalidParameter naming the first text in [BRACKETS].
void requireFilledIn(const StudyProtocol& protocol);

/// Returns the names of the built-in protocols, which are the files in protocols/.
[[nodiscard]] std::vector<std::string_view> protocolNames();

/// Returns the scene with one stimulus of a block. @throws InvalidParameter, Failure as changed().
[[nodiscard]] SceneFile sceneOf(const StudyProtocol& protocol, const StudyBlock& block, const Stimulus& stimulus);

/// Returns the index of the level farthest from the reference on the block's axis; of two, the lower level.
[[nodiscard]] std::size_t farthestLevel(const StudyBlock& block);

/// Returns the six scales of the NASA Task Load Index, 0 to 100 in steps of 5 (Hart and Staveland 1988).
[[nodiscard]] std::span<const FormItem> nasaTaskLoadIndex();

}  // namespace haptolith
