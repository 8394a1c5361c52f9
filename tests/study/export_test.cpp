#include "haptolith/study/export/export.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/recording/recording_writer.h"
#include "haptolith/study/store/provenance.h"
#include "haptolith/study/store/study_files.h"

#include "../source_dir.h"
#include "a_study.h"
#include "a_study_with_groups.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using Access = StudyStore::Access;

constexpr const char* kPython = "/usr/bin/python3";  // Debian's own, which has Debian's packages

std::string readFile(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Two participants, of whom the second has quit; a trial of each state and kind, and awkward texts.
class StudyExport : public AStudy {
 protected:
  StudyExport() {
    StudyStore store(file_, Access::kRun);
    const std::int64_t one = store.addParticipant("").id;
    store.setAnswers(one, "demographics", store.protocol().demographics,
                     {{"name", "Ada, \"Countess\""}, {"age", "36"}});
    TrialBegun practice = trial(one, 0);
    practice.kind = TrialKind::kPractice;
    store.answerTrial(store.beginTrial(practice), answer(0.5));
    store.voidTrial(store.beginTrial(trial(one, 1)), TrialState::kLost, "a tab\there, a line\nthere and a \"quote\"");
    const std::int64_t repeated = store.beginTrial(trial(one, 1, 1));
    store.answerTrial(repeated, answer(0.75));
    store.voidTrial(repeated, TrialState::kRepeated, "noise");
    TrialAnswer negative = answer(1.0 / 3);
    negative.positive = false;
    negative.correct = std::nullopt;
    store.answerTrial(store.beginTrial(trial(one, 1, 2)), negative);
    TrialAnswer late = answer(5);
    late.timed_out = true;
    store.answerTrial(store.beginTrial(trial(one, 2)), late);
    const std::int64_t other = store.addParticipant("").id;
    store.beginTrial({.participant = other,
                      .block = 1,
                      .kind = TrialKind::kCatch,
                      .block_name = "gravity",
                      .level = "Earth",
                      .reference = "Moon",
                      .value = 9.807,
                      .reference_value = 1.625,
                      .seed = 12});
    store.endParticipant(other, "withdrawn");
  }

  [[nodiscard]] StudyStore study() const { return {file_, Access::kRead}; }

  /// Runs a Python program in the folder; what it asserts must be so.
  void expectTrueInPython(const std::string& program) const {
    std::ofstream(folder_ / "check.py") << program;
    EXPECT_EQ(std::system(fmt::format("cd '{}' && {} check.py", folder_.string(), kPython).c_str()), 0);
  }
};

TEST_F(StudyExport, PandasReadsEveryTrialFromTheTable) {
  exportCsv(study(), folder_ / "a.csv", {});
  expectTrueInPython(R"(
import pandas
t = pandas.read_csv('a.csv', float_precision='round_trip')
assert len(t) == 6
assert list(t.participant) == ['S01'] * 5 + ['S02']
assert list(t.kind) == ['practice', 'main', 'main', 'main', 'main', 'catch']
assert list(t.state) == ['answered', 'lost', 'repeated', 'answered', 'answered', 'begun']
assert list(t.trial) == [1, 2, 2, 2, 3, 1] and list(t.attempt) == [1, 1, 2, 3, 1, 1]
assert t.block.iloc[5] == 'gravity' and t.level.iloc[5] == 'Earth' and t.x.iloc[5] == 9.807
assert (t.x[:5] == 1.21).all() and (t.x_reference[:5] == 0.835).all()
assert list(t.test_first) == [0, 1, 1, 1, 0, 0]
assert t.response.isna().tolist() == [False, True, False, False, True, True]
assert t.response.iloc[0] == 1 and t.response.iloc[3] == 0
assert t.correct.isna().iloc[3] and t.correct.iloc[0] == 1
assert t.response_time_s.iloc[3] == 1 / 3
assert t.timed_out.iloc[4] == 1
assert t.first_duration_s.iloc[0] == 3.25 and t.second_work_j.iloc[0] == -0.5
assert t.first_work_j.isna().all() and t.second_deadline_misses.iloc[0] == 3
assert t.seed.dtype.kind == 'i' and t.seed.iloc[0] == 2**53 - 1
assert t.reason.iloc[1] == 'a tab\there, a line\nthere and a "quote"'
assert t.recording.iloc[0] == 'S01-friction' and t.recording_state.iloc[0] == 'missing'
assert t.demographics_age.iloc[0] == 36 and t.demographics_age.isna().iloc[5]
assert not any('name' in column for column in t.columns if column.startswith('demographics'))
counting = t[(t.kind == 'main') & (t.state == 'answered') & t.response.notna()]
assert len(counting) == 1
)");
}

TEST_F(StudyExport, PandasReadsTheBidsFolder) {
  exportBids(study(), folder_ / "bids", {});
  expectTrueInPython(R"(
import json, os, pandas
def table(name):
    return pandas.read_csv('bids/' + name, sep='\t', na_values='n/a', keep_default_na=False)
description = json.load(open('bids/dataset_description.json'))
assert description['Name'] == 'A study' and description['BIDSVersion'] and description['DatasetType'] == 'raw'
assert open('bids/README.md').read().startswith('# A study')
people = table('participants.tsv')
assert list(people.columns)[0] == 'participant_id'
assert list(people.participant_id) == ['sub-S01', 'sub-S02'] and list(people.state) == ['running', 'withdrawn']
assert people.demographics_age.iloc[0] == 36 and people.demographics_age.isna().iloc[1]
assert set(people.columns) == set(json.load(open('bids/participants.json')))
files = sorted(os.path.join(at, name)[5:] for at, _, names in os.walk('bids') for name in names if at != 'bids')
assert files == ['code/analysis.R', 'code/analysis.py',
                 'sub-S01/beh/sub-S01_task-friction_beh.json', 'sub-S01/beh/sub-S01_task-friction_beh.tsv',
                 'sub-S02/beh/sub-S02_task-gravity_beh.json', 'sub-S02/beh/sub-S02_task-gravity_beh.tsv'], files
trials = table('sub-S01/beh/sub-S01_task-friction_beh.tsv')
assert list(trials.trial_type) == ['practice', 'main', 'main', 'main', 'main']
assert list(trials.response_time.dropna()) == [0.5, 0.75, 1 / 3, 5.0]
assert trials.reason.iloc[1] == 'a tab here, a line there and a "quote"'
assert trials.answered_at.isna().tolist() == [False, True, False, False, False]
sidecar = json.load(open('bids/sub-S01/beh/sub-S01_task-friction_beh.json'))
assert sidecar['TaskName'] == 'friction'
assert sidecar['x']['LongName'] == 'friction coefficient'
for column in trials.columns:
    assert sidecar[column]['Description'].endswith('.'), column
assert sidecar['response']['Levels']['1'] == 'the participant judged the test to have more'
assert sidecar['first_peak_force_n']['Units'] == 'N'
)");
}

TEST_F(StudyExport, LeavesPersonalAnswersOutUnlessAskedFor) {
  exportCsv(study(), folder_ / "a.csv", {});
  exportBids(study(), folder_ / "bids", {});
  EXPECT_THAT(readFile(folder_ / "a.csv"), Not(HasSubstr("Countess")));
  EXPECT_THAT(readFile(folder_ / "bids/participants.tsv"), Not(HasSubstr("Countess")));
  EXPECT_THAT(readFile(folder_ / "bids/participants.json"), Not(HasSubstr("demographics_name")));
  exportCsv(study(), folder_ / "b.csv", {.personal = true});
  exportBids(study(), folder_ / "bids2", {.personal = true});
  expectTrueInPython(R"(
import pandas
assert pandas.read_csv('b.csv').demographics_name.iloc[0] == 'Ada, "Countess"'
people = pandas.read_csv('bids2/participants.tsv', sep='\t', quoting=3)
assert people.demographics_name.iloc[0] == 'Ada, "Countess"'
)");
}

TEST_F(StudyExport, ReplacesOnlyAnEarlierExportAndOnlyWhenAskedTo) {
  exportCsv(study(), folder_ / "a.csv", {});
  exportBids(study(), folder_ / "bids", {});
  EXPECT_THROW(exportCsv(study(), folder_ / "a.csv", {}), Failure);
  EXPECT_THROW(exportBids(study(), folder_ / "bids", {}), Failure);
  exportCsv(study(), folder_ / "a.csv", {.overwrite = true});
  exportBids(study(), folder_ / "bids", {.overwrite = true});
  fs::create_directory(folder_ / "mine");
  std::ofstream(folder_ / "mine/thesis.txt") << "years";
  EXPECT_THROW(exportBids(study(), folder_ / "mine", {.overwrite = true}), Failure);
  EXPECT_EQ(readFile(folder_ / "mine/thesis.txt"), "years");
}

TEST_F(StudyExport, TextThatASpreadsheetWouldObeyIsMarkedAsText) {
  {
    StudyStore store(file_, Access::kRun);
    const std::int64_t id = store.participants()[0].id;
    store.setAnswers(id, "demographics", store.protocol().demographics, {{"name", "=cmd|'/C calc'!A1"}, {"age", "36"}});
    int attempt = 0;
    for (const char* reason : {"@SUM(1+9)", "+1+cmd", "-2+3", "-2.5"}) {
      store.voidTrial(store.beginTrial(trial(id, 3, attempt++)), TrialState::kLost, reason);
    }
  }
  exportCsv(study(), folder_ / "a.csv", {.personal = true});
  exportBids(study(), folder_ / "bids", {.personal = true});
  expectTrueInPython(R"py(
import pandas
text = pandas.read_csv('a.csv', dtype=str, keep_default_na=False)
assert text.demographics_name.iloc[0] == "'=cmd|'/C calc'!A1"
assert {"'@SUM(1+9)", "'+1+cmd", "'-2+3", "-2.5"} <= set(text.reason), set(text.reason)
people = pandas.read_csv('bids/participants.tsv', sep='\t', quoting=3)
assert people.demographics_name.iloc[0] == "'=cmd|'/C calc'!A1"
numbers = pandas.read_csv('a.csv')
assert numbers.x.dtype == 'float64' and numbers.first_work_j.dtype == 'float64'
)py");
}

TEST_F(StudyExport, WhatIsPersonalIsForItsOwnerAlone) {
  exportCsv(study(), folder_ / "a.csv", {.personal = true});
  exportBids(study(), folder_ / "bids", {.personal = true});
  for (const char* name : {"a.csv", "bids/participants.tsv"}) {
    EXPECT_EQ(fs::status(folder_ / name).permissions(), fs::perms::owner_read | fs::perms::owner_write) << name;
  }
  EXPECT_EQ(fs::status(folder_ / "bids").permissions(), fs::perms::owner_all);
}

TEST_F(StudyExport, NeverReplacesTheStudyThatItReads) {
  EXPECT_THROW(exportCsv(study(), file_, {.overwrite = true}), Failure);
  EXPECT_THROW(exportBids(study(), file_, {.overwrite = true}), Failure);
  EXPECT_EQ(study().participants().size(), 2U);
}

TEST_F(StudyExport, TellsWhatRanEachPart) {
  {
    StudyStore store(file_, Access::kRun);
    const std::int64_t id = store.participants()[0].id;
    store.giveConsent(id);
    const std::int64_t run = store.beginSession(id, {.kind = "run",
                                                     .program_version = "1.2.3",
                                                     .device = "sigma.7 (force-dimension)",
                                                     .machine = {.os = "Debian", .kernel = "Linux 6", .cpu = "Z80"},
                                                     .loop_rate_hz = 1000});
    store.endSession(run, SessionCounts{.ticks = 5000, .missed_ticks = 3, .safety_trips = 1});
    store.beginSession(id, {.kind = "resume", .program_version = "1.2.4", .device = "sigma.7 (force-dimension)"});
  }
  exportCsv(study(), folder_ / "a.csv", {});
  exportBids(study(), folder_ / "bids", {.authors = {"A. Lovelace"}, .program_version = "1.3.0"});
  expectTrueInPython(R"(
import json, pandas
t = pandas.read_csv('a-sessions.csv')
assert list(t.participant) == ['S01', 'S01'] and list(t.kind) == ['run', 'resume']
assert t.ticks.iloc[0] == 5000 and t.missed_ticks.iloc[0] == 3 and t.safety_trips.iloc[0] == 1
assert t.loop_rate_hz.iloc[0] == 1000 and t.program_version.iloc[1] == '1.2.4'
assert t.ended_at.isna().tolist() == [False, True] and t.ticks.isna().iloc[1]
assert t.cpu.iloc[0] == 'Z80' and len(t.protocol_sha256.iloc[0]) == 64
description = json.load(open('bids/dataset_description.json'))
assert description['GeneratedBy'] == [{'Name': 'haptolith', 'Version': '1.3.0'}]
assert description['Authors'] == ['A. Lovelace']
sidecar = json.load(open('bids/sub-S01/beh/sub-S01_task-friction_beh.json'))
assert sidecar['StimulusPresentation']['SoftwareVersion'] == '1.2.4'
assert sidecar['Sessions'][0]['MissedTicks'] == '3' and len(sidecar['Sessions']) == 2
people = pandas.read_csv('bids/participants.tsv', sep='\t', na_values='n/a')
assert people.consent_version.iloc[0].startswith('sha256:') and people.consent_language.iloc[0] == 'en'
assert people.consent_at.isna().tolist() == [False, True]
)");
}

TEST_F(StudyExport, ExplainsEveryColumnOfATable) {
  exportCsv(study(), folder_ / "a.csv", {});
  expectTrueInPython(R"(
import json, pandas
columns = json.load(open('a-columns.json'))
for name in ['a.csv', 'a-sessions.csv']:
    assert list(pandas.read_csv(name).columns) == list(columns[name]), name
    assert all(column['Description'] for column in columns[name].values())
assert columns['a.csv']['first_peak_force_n']['Units'] == 'N'
assert columns['a.csv']['response']['Levels']['1'] == 'the participant judged the test to have more'
assert columns['a.csv']['demographics_age']['Description'] == 'Age'
)");
}

TEST_F(StudyExport, ReplacesNothingBesideTheTableEither) {
  for (const char* taken : {"a-columns.json", "a-sessions.csv"}) {
    std::ofstream(folder_ / taken) << "mine";
    EXPECT_THROW(exportCsv(study(), folder_ / "a.csv", {}), Failure) << taken;
    EXPECT_EQ(readFile(folder_ / taken), "mine");
    EXPECT_FALSE(fs::exists(folder_ / "a.csv"));
    fs::remove(folder_ / taken);
  }
}

TEST_F(StudyExport, TellsWhatHasBecomeOfRecordings) {
  fs::create_directory(recordingsFolder(file_));
  const auto recording = [&](const char* interval) {
    return recordingsFolder(file_) / fmt::format("S01-friction-{}.h5", interval);
  };
  const auto state_of_first = [&] {
    exportCsv(study(), folder_ / "a.csv", {.overwrite = true});
    expectTrueInPython("import csv; open('said', 'w').write(next(csv.DictReader(open('a.csv')))['recording_state'])");
    return readFile(folder_ / "said");
  };
  EXPECT_EQ(state_of_first(), "missing");
  for (const char* interval : {"first", "second"}) {
    const RecordingWriter writer(recording(interval), RecordingHeader());
    EXPECT_EQ(state_of_first(), "unfinished") << interval;  // as one whose writer was killed
  }
  EXPECT_EQ(state_of_first(), "whole");
  fs::remove(recording("second"));
  EXPECT_EQ(state_of_first(), "missing");
  std::ofstream(recording("second")) << "\x89HDF and no more";
  EXPECT_EQ(state_of_first(), "unfinished");
}

TEST_F(StudyExport, TellsWhatIsInTheWay) {
  EXPECT_THROW(exportCsv(study(), folder_ / "no/such/folder.csv", {}), Failure);
  EXPECT_THROW(exportBids(study(), folder_ / "no/such/folder", {}), Failure);
}

TEST_F(StudyExport, ReadsAStudyThatRuns) {
  const StudyStore runner(file_, Access::kRun);
  exportCsv(study(), folder_ / "a.csv", {});
  EXPECT_THAT(readFile(folder_ / "a.csv"), HasSubstr("S02"));
}

TEST_F(StudyExport, TellsGroupAndStratumWhereTheStudyHasThem) {
  const fs::path grouped = folder_ / "grouped.study";
  StudyStore::create(grouped, loadProtocolText(kTwoGroups, "groups.toml"), kTwoGroups, 42);
  {
    StudyStore store(grouped, Access::kRun);
    const std::int64_t id = store.addParticipant("").id;
    store.setAnswers(id, "demographics", store.protocol().demographics, {{"hand", "right"}, {"age", "36"}});
    (void)store.assignGroup(id);
    store.beginTrial(trial(id, 0));
    store.beginTrial(trial(store.addParticipant("").id, 0));
  }
  const StudyStore store(grouped, Access::kRead);
  exportCsv(store, folder_ / "g.csv", {});
  exportBids(store, folder_ / "g", {});
  exportCsv(study(), folder_ / "a.csv", {});
  exportBids(study(), folder_ / "a", {});
  const std::string own = store.participants()[0].assignment->group;
  std::ofstream(folder_ / "own.txt") << own;
  expectTrueInPython(R"(
import json, pandas
own = open('own.txt').read()
t = pandas.read_csv('g.csv')
assert list(t.group.fillna('')) == [own, ''], t.group
assert list(t.stratum.fillna('')) == ['hand right; age 30 to < 50', '']
people = pandas.read_csv('g/participants.tsv', sep='\t', na_values='n/a', keep_default_na=False)
assert list(people.group.fillna('')) == [own, ''] and people.stratum[0] == 'hand right; age 30 to < 50'
for file in (json.load(open('g-columns.json'))['g.csv'], json.load(open('g/participants.json'))):
    assert file['group']['Levels'] == {'both': 'goes through friction, gravity', 'weight': 'goes through gravity'}
    assert 'stratum' in file
for table, separator in (('a.csv', ','), ('a/participants.tsv', '\t')):
    assert not {'group', 'stratum'} & set(pandas.read_csv(table, sep=separator).columns)
)");
}

TEST(StudyColumns, AreAllInTheDocument) {
  const std::string document = readFile(sourceDir() / "docs/how-to/studies.md");
  std::set<std::string> names;
  for (const ExportColumn& column : trialColumns()) {
    EXPECT_TRUE(names.insert(column.name).second) << column.name;
    const bool second = column.name.starts_with("second_");  // stands beside the first, in its row
    EXPECT_THAT(document, HasSubstr(fmt::format("{}`{}`", second ? ", " : "\n| ", column.name)));
  }
  for (const char* name : {"group", "stratum"}) {  // where the study has them
    EXPECT_THAT(document, HasSubstr(fmt::format("\n| `{}` | the same, of participants.tsv |", name)));
  }
  for (const ExportColumn& column : sessionColumns()) {
    EXPECT_THAT(document, HasSubstr(fmt::format("`{}`", column.name)));
    EXPECT_THAT(document, HasSubstr(column.meaning));
  }
}

}  // namespace
}  // namespace haptolith
