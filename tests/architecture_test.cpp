// The arrows of docs/contributing/architecture.md: a folder of src/haptolith includes only the folders it may depend
// on.

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "source_dir.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;
using Folders = std::set<std::string>;

// Targets of each folder's arrow. It may also include everything that those include, and itself.
const std::map<std::string, Folders> kArrows = {
    {"core/math", {}},
    {"core", {"core/math"}},
    // Functions that systems do differently.
    {"core/platform", {"core"}},
    {"core/process", {"core/platform"}},
    {"core/files", {"core/process"}},
    {"figure", {"core/files"}},
    // Shapes that others drew: it knows neither soil nor tools.
    {"mesh", {"core/files"}},
    {"stone", {"mesh"}},
    {"soil", {"core"}},
    // With kernel, start and measure: a bed makes a tile, which makes a bed.
    {"bed", {"soil", "stone"}},
    {"tool", {"bed", "mesh"}},
    {"scene", {"tool"}},
    // Files of another engine.
    {"lammps", {"scene"}},
    {"device", {"core/platform"}},
    {"device/hand", {"device", "core/files"}},
    {"device/drivers", {"device/hand"}},
    {"haptics", {"bed", "device/hand"}},
    {"haptics/safety", {"haptics"}},
    {"haptics/loop", {"haptics/safety", "scene"}},
    {"scene_file/toml", {"core/files"}},
    {"scene_file", {"scene_file/toml", "haptics/loop"}},
    {"machine", {"scene_file"}},
    {"recording", {"scene_file"}},
    // A virtual laboratory has no hand in it.
    {"lab", {"soil"}},
    {"lab/theory", {"tool"}},
    {"lab/apparatus", {"lab", "lab/theory", "scene", "figure"}},
    {"lab/tests", {"lab/apparatus"}},
    {"lab/report", {"lab/tests"}},
    {"lab/catalogue", {"lab/report"}},
    {"lab/archive", {"lab/catalogue"}},
    // Bounds of a scene's force.
    {"trust", {"lab/report", "scene_file"}},
    // Parts that a person may change while it runs.
    {"session", {"recording", "device/drivers"}},
    // Answers and curves: it knows neither soil nor hands.
    {"psychometrics", {"figure"}},
    {"psychometrics/adaptive", {"psychometrics"}},
    {"psychometrics/group", {"psychometrics"}},
    {"study/protocol", {"session", "psychometrics/adaptive", "psychometrics/group"}},
    {"study/store", {"study/protocol"}},
    {"study/export", {"study/store"}},
    {"study/results", {"study/store"}},
    {"study/perception", {"study/results"}},
    {"study/run", {"study/perception"}},
    // The base of other programs, through C: neither files of recordings, nor pages, nor studies.
    {"c_api", {"machine", "device/drivers", "lab/catalogue", "trust", "psychometrics"}},
    {"c_api/recording", {"c_api", "recording"}},
    // The laboratory turned round: from forces to soil.
    {"identify/training", {"lab/tests"}},
    {"identify", {"identify/training"}},
    {"identify/check", {"identify"}},
    // Far away: what goes between two sites, and both sides of it.
    {"teleop/link", {"bed", "device/drivers"}},
    {"teleop/robot", {"teleop/link", "scene_file"}},
    {"teleop/operator", {"teleop/robot", "identify"}},
    {"teleop/bench", {"teleop/operator"}},
    // A robot network of others, and robots at its other side.
    {"ros2", {"teleop/robot"}},
    {"viewer", {"session"}},
};

/// The folder with its own arrow that holds a file: teleop/link for "teleop/link/link.h", bed for "bed/bed.h".
std::string folderOf(const fs::path& file) {
  fs::path folder = file.parent_path();
  while (folder.has_parent_path() && !kArrows.contains(folder.string())) {
    folder = folder.parent_path();
  }
  return folder.string();
}

Folders mayInclude(const std::string& folder) {
  Folders allowed{folder};
  for (const std::string& below : kArrows.at(folder)) {
    allowed.merge(mayInclude(below));
  }
  return allowed;
}

/// Faults of the includes in one file of `folder`, one sentence each.
std::vector<std::string> violations(const std::string& folder, const std::string& file, std::istream& text) {
  if (!kArrows.contains(folder)) {
    return {file + ": folder " + folder + " is not in docs/contributing/architecture.md"};
  }
  static const std::regex kOurs(R"(^\s*#\s*include\s*["<]haptolith/([^">]+/[^">]+)[">].*)");
  static const std::regex kRelative(R"(^\s*#\s*include\s*"\.\./.*)");
  const Folders allowed = mayInclude(folder);
  std::vector<std::string> found;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    std::smatch match;
    if (std::regex_match(line, kRelative)) {
      found.push_back(file + ":" + std::to_string(number) + ": includes by a relative path");
    } else if (std::regex_match(line, match, kOurs) && !allowed.contains(folderOf(match[1].str()))) {
      found.push_back(file + ":" + std::to_string(number) + ": " + folder + " may not include " +
                      folderOf(match[1].str()));
    }
  }
  return found;
}

std::vector<std::string> violationsIn(const std::string& folder, const std::string& text) {
  std::istringstream stream(text);
  return violations(folder, "made_up.h", stream);
}

TEST(Architecture, NoFolderIncludesUpwards) {
  const fs::path root = sourceDir() / "src" / "haptolith";
  std::vector<std::string> found;
  int files = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
    const fs::path name = fs::relative(entry.path(), root);
    if (name.extension() != ".h" && name.extension() != ".cpp") {
      continue;
    }
    std::ifstream text(entry.path());
    std::ranges::copy(violations(folderOf(name), name.string(), text), std::back_inserter(found));
    ++files;
  }
  EXPECT_THAT(found, IsEmpty());
  EXPECT_GT(files, 10) << "nothing to check in " << root;
}

/// Adds the types that a header defines outside functions and other types, by their full names.
void addTypes(std::istream& text, const std::string& file, std::map<std::string, Folders>& types) {
  static const std::regex kOpens(R"(^namespace ([\w:]+) \{$)");
  static const std::regex kCloses(R"(^\}  // namespace ([\w:]+)$)");
  static const std::regex kType(R"(^(?:struct|class|enum class|enum) (\w+)(?: final)?(?: : [^{]*)? \{.*)");
  std::vector<std::string> open;
  for (std::string line; std::getline(text, line);) {
    std::smatch match;
    if (std::regex_match(line, match, kOpens)) {
      open.push_back(match[1]);
    } else if (std::regex_match(line, match, kCloses) && !open.empty()) {
      open.pop_back();
    } else if (std::regex_match(line, match, kType)) {
      std::string name;
      for (const std::string& outer : open) {
        name += outer + "::";
      }
      types[name + match[1].str()].insert(file);
    }
  }
}

// Two types of one name in one program break its one-definition rule, which no compiler sees.
TEST(Architecture, NoTwoHeadersDefineATypeOfOneName) {
  const fs::path root = sourceDir() / "src" / "haptolith";
  std::map<std::string, Folders> types;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
    if (entry.path().extension() == ".h") {
      std::ifstream text(entry.path());
      addTypes(text, fs::relative(entry.path(), root).string(), types);
    }
  }
  EXPECT_GT(types.size(), 300U);
  for (const auto& [type, files] : types) {
    EXPECT_EQ(files.size(), 1U) << type << " is defined in " << testing::PrintToString(files);
  }
}

TEST(Architecture, TheCheckSeesAnUpwardInclude) {
  EXPECT_THAT(violationsIn("soil", "#pragma once\n#include \"haptolith/bed/bed.h\"\n"),
              ElementsAre("made_up.h:2: soil may not include bed"));
  EXPECT_THAT(violationsIn("core", "  #  include <haptolith/soil/soil_parameters.h>\n"),
              ElementsAre("made_up.h:1: core may not include soil"));
  EXPECT_THAT(violationsIn("teleop/link", "#include \"haptolith/teleop/robot/robot.h\"\n"),
              ElementsAre("made_up.h:1: teleop/link may not include teleop/robot"));
}

TEST(Architecture, TheCheckLetsArrowsAndTheirArrowsPass) {
  EXPECT_THAT(violationsIn("tool", "#include \"haptolith/bed/bed.h\"\n#include \"haptolith/core/vec.h\"\n"), IsEmpty());
  EXPECT_THAT(violationsIn("teleop/bench", "#include \"haptolith/teleop/link/link.h\"\n"), IsEmpty());
  EXPECT_THAT(violationsIn("bed", "#include \"haptolith/bed/kernel/rows-inl.h\"\n#include <vector>\n"), IsEmpty());
}

TEST(Architecture, DevicesKnowNoSoil) {
  EXPECT_THAT(mayInclude("device/drivers"), ElementsAre("core", "core/files", "core/math", "core/platform",
                                                        "core/process", "device", "device/drivers", "device/hand"));
  EXPECT_EQ(violationsIn("device", "#include \"haptolith/soil/presets.h\"\n").size(), 1U);
}

TEST(Architecture, LabHasNoDeviceAndTheBranchesNeverMeet) {
  EXPECT_FALSE(mayInclude("lab/archive").contains("device"));
  EXPECT_FALSE(mayInclude("identify/check").contains("device"));
  for (const char* branch : {"study/run", "viewer"}) {
    EXPECT_FALSE(mayInclude(branch).contains("lab")) << branch;
  }
  const Folders branches{"study/run", "teleop/bench", "viewer"};
  for (const std::string& branch : branches) {
    for (const std::string& other : branches) {
      EXPECT_EQ(mayInclude(branch).contains(other), branch == other) << branch << " -> " << other;
    }
  }
}

// Few enough for a newcomer to see all of them.
TEST(Architecture, NoFolderHasMoreThan30Sources) {
  std::map<std::string, int> sources;
  for (const char* where : {"src", "apps"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(sourceDir() / where)) {
      const fs::path name = fs::relative(entry.path(), sourceDir());
      sources[name.parent_path().string()] += name.extension() == ".h" || name.extension() == ".cpp" ? 1 : 0;
    }
  }
  for (const auto& [folder, count] : sources) {
    EXPECT_LE(count, 30) << folder;
  }
}

/// Words that had several meanings, or a synonym, and the word that is left for each.
const std::map<std::string, std::string> kDroppedWords = {
    {"felt", "soil wrench, device wrench, displayed wrench"},
    {"let_?go", "release"},
    {"grain", "particle"},
    {"exchange_", "lammps, replace"},
    {"key_?frame", "keyframe, in teleoperation alone"},
    {"sitting", "study session"},
    {"scenario", "scene file"},
};

/// "haptolith.h:12 felt" for each dropped word of a header outside lines that keep a deprecated or written name.
std::vector<std::string> droppedWordsIn(const fs::path& header) {
  const std::regex kept(R"(deprecated|HAPTO_RENAMED|"scenario")");
  std::vector<std::string> found;
  std::ifstream file(header);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    for (const auto& [word, instead] : kDroppedWords) {
      const bool there = std::regex_search(line, std::regex("(^|[^a-z])" + word, std::regex::icase));
      if (there && !std::regex_search(line, kept)) {
        found.push_back(header.filename().string() + ":" + std::to_string(number) + " " + word + ": " + instead);
      }
    }
  }
  return found;
}

TEST(PublicHeaders, HaveOneWordForEachMeaning) {
  std::vector<std::string> found;
  int headers = 0;
  for (const auto& entry : fs::directory_iterator(sourceDir() / "include/haptolith")) {
    const std::vector<std::string> words = droppedWordsIn(entry.path());
    found.insert(found.end(), words.begin(), words.end());
    ++headers;
  }
  EXPECT_GE(headers, 8);
  EXPECT_THAT(found, IsEmpty());
}

TEST(Architecture, TheCheckRefusesUnknownFoldersAndRelativePaths) {
  EXPECT_THAT(violationsIn("utils", ""),
              ElementsAre("made_up.h: folder utils is not in docs/contributing/architecture.md"));
  EXPECT_THAT(violationsIn("bed", "#include \"../tool/tool.h\"\n"),
              ElementsAre("made_up.h:1: includes by a relative path"));
}

}  // namespace
}  // namespace haptolith
