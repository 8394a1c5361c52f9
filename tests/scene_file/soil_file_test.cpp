#include "haptolith/scene_file/soil_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "haptolith/scene_file/scene_file.h"
#include "haptolith/scene_file/soil_file_keys.h"
#include "haptolith/scene_file/toml/toml_error.h"

#include "../source_dir.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string readFile(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

const std::string kTarget =
    "name = 'x'\n[target]\nbulk_density_kg_m3 = 1500\nfriction_angle_deg = 42\ncohesion_pa = 520\n";
const std::string kSoil =
    "[soil]\nradius_mm = 7\ngamma_nm = 4e-5\nrho0_kg_m3 = 1425\nrho_max_kg_m3 = 1995\nstiffness_n_m = 2000\n"
    "friction_model = 'contact'\ncontact_friction = 0.7\ncontact_cohesion_n = 0.1\n";

class SoilFiles : public testing::Test {
 protected:
  SoilFiles() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_soil_{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~SoilFiles() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path write(const std::string& text) const {
    fs::path path = folder_ / "x.toml";
    std::ofstream(path) << text;
    return path;
  }

  [[nodiscard]] SoilFile load(const std::string& text) const { return loadSoilFile(write(text)); }

  /// The message, its folder cut off: "x.toml:2: ...".
  [[nodiscard]] std::string errorOf(const std::string& text) const {
    try {
      (void)load(text);
    } catch (const TomlError& error) {
      return std::string(error.what()).substr(folder_.string().size() + 1);
    }
    return "no error";
  }

  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      names.push_back(entry.path().filename().string());
    }
    return names;
  }

  fs::path folder_;
};

void expectSameNumbers(const SoilParameters& a, const SoilParameters& b) {
  EXPECT_EQ(a.radius_m, b.radius_m);
  EXPECT_EQ(a.gamma_nm, b.gamma_nm);
  EXPECT_EQ(a.rho0_kg_m3, b.rho0_kg_m3);
  EXPECT_EQ(a.rho_max_kg_m3, b.rho_max_kg_m3);
  EXPECT_EQ(a.mu_hat, b.mu_hat);
  EXPECT_EQ(a.stiffness_n_m, b.stiffness_n_m);
  EXPECT_EQ(a.attraction_ratio, b.attraction_ratio);
  EXPECT_EQ(a.moving_friction_ratio, b.moving_friction_ratio);
  EXPECT_EQ(a.friction, b.friction);
  EXPECT_EQ(a.contact_friction, b.contact_friction);
  EXPECT_EQ(a.contact_cohesion_n, b.contact_cohesion_n);
  EXPECT_EQ(a.cohesion_range_ratio, b.cohesion_range_ratio);
  EXPECT_EQ(a.tangential_ratio, b.tangential_ratio);
  EXPECT_EQ(a.damping_ratio, b.damping_ratio);
}

void expectSameRange(const std::optional<Range>& a, const std::optional<Range>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (a) {
    EXPECT_EQ(a->lowest, b->lowest);
    EXPECT_EQ(a->highest, b->highest);
  }
}

void expectSame(const SoilFile& a, const SoilFile& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.target.bulk_density_kg_m3, b.target.bulk_density_kg_m3);
  EXPECT_EQ(a.target.friction_angle_deg, b.target.friction_angle_deg);
  expectSameRange(a.target.friction_angle_range_deg, b.target.friction_angle_range_deg);
  EXPECT_EQ(a.target.cohesion_pa, b.target.cohesion_pa);
  expectSameRange(a.target.cohesion_range_pa, b.target.cohesion_range_pa);
  EXPECT_EQ(a.target.strength, b.target.strength);
  expectSameNumbers(a.soil, b.soil);
  ASSERT_EQ(a.reached.has_value(), b.reached.has_value());
  if (a.reached) {
    EXPECT_EQ(a.reached->friction_angle_deg, b.reached->friction_angle_deg);
    EXPECT_EQ(a.reached->friction_angle_sd_deg, b.reached->friction_angle_sd_deg);
    EXPECT_EQ(a.reached->cohesion_pa, b.reached->cohesion_pa);
    EXPECT_EQ(a.reached->cohesion_sd_pa, b.reached->cohesion_sd_pa);
    EXPECT_EQ(a.reached->bulk_density_kg_m3, b.reached->bulk_density_kg_m3);
    EXPECT_EQ(a.reached->seeds, b.reached->seeds);
  }
}

/// Numbers that have no short decimal.
SoilFile awkwardSoil() {
  SoilFile file;
  file.name = "my \"sand\" \\ №1";
  file.source = "a line\nand another";
  file.target = {.bulk_density_kg_m3 = 1500 + 1.0 / 3,
                 .friction_angle_deg = 42.0 / 1.1,
                 .friction_angle_range_deg = Range{30.0 / 1.7, 50.0 / 1.1},
                 .cohesion_pa = 1e-300,
                 .cohesion_range_pa = Range{0, 1e3 / 7},
                 .strength = SoilStrength::kPeak};
  file.soil.radius_m = 6.4 * 1e-3;
  file.soil.gamma_nm = 4e-5 / 3;
  file.soil.rho0_kg_m3 = 1e4 / 7;
  file.soil.rho_max_kg_m3 = std::nextafter(2000, 3000);
  file.soil.stiffness_n_m = 1e17 / 3;
  file.soil.friction = FrictionModel::kContact;
  file.soil.contact_friction = 2.0 / 3;
  file.soil.contact_cohesion_n = 0.1 + 0.2;
  file.soil.cohesion_range_ratio = 0.1 / 3;
  file.soil.tangential_ratio = 2.0 / 7;
  file.soil.damping_ratio = 0.1 / 7;
  file.reached = SoilReached{.friction_angle_deg = 41.0 / 1.1,
                             .friction_angle_sd_deg = 0.1 / 3,
                             .cohesion_pa = -1.0 / 3,
                             .cohesion_sd_pa = 10.0 / 3,
                             .bulk_density_kg_m3 = 1e4 / 7,
                             .seeds = 5};
  return file;
}

// --- what is read and written ---

TEST_F(SoilFiles, WhatIsSavedIsLoadedToTheLastBit) {
  for (const FrictionModel friction : {FrictionModel::kContact, FrictionModel::kIcra2021}) {
    SoilFile soil = awkwardSoil();
    soil.soil.friction = friction;
    soil.soil.mu_hat = 0.1 / 3;
    fs::remove(folder_ / "saved.toml");
    saveSoilFile(folder_ / "saved.toml", soil);
    expectSame(loadSoilFile(folder_ / "saved.toml"), soil);
  }
  EXPECT_EQ(files(), std::vector<std::string>{"saved.toml"});
}

TEST_F(SoilFiles, RadiiInMillimetresComeBackToTheLastBit) {
  SoilFile soil = findSoil("lunar-0-15cm");
  for (int tenths = 1; tenths <= 300; ++tenths) {
    const double radius_m = tenths * 0.1 * 1e-3;
    soil.soil = rescaled(soil.soil, radius_m);
    fs::remove(folder_ / "saved.toml");
    saveSoilFile(folder_ / "saved.toml", soil);
    ASSERT_EQ(loadSoilFile(folder_ / "saved.toml").soil.radius_m, radius_m) << tenths;
  }
}

TEST_F(SoilFiles, ASavedShippedSoilIsTheShippedFile) {
  for (const std::string& name : soilNames()) {
    fs::remove(folder_ / "saved.toml");
    saveSoilFile(folder_ / "saved.toml", findSoil(name));
    EXPECT_EQ(readFile(folder_ / "saved.toml"), readFile(sourceDir() / "soils" / (name + ".toml")));
  }
}

TEST_F(SoilFiles, NumbersOfTheOtherFrictionModelAreLeftOutUntilSomebodySetsThem) {
  SoilFile soil = findSoil("lunar-0-15cm");
  soil.soil.mu_hat = SoilParameters{}.mu_hat;
  saveSoilFile(folder_ / "saved.toml", soil);
  EXPECT_THAT(readFile(folder_ / "saved.toml"), Not(HasSubstr("mu_hat")));
  soil.soil.mu_hat = 0.3;
  saveSoilFile(folder_ / "other.toml", soil);
  EXPECT_THAT(readFile(folder_ / "other.toml"), HasSubstr("mu_hat = 0.3\n"));
}

TEST_F(SoilFiles, ASoilIsNotSavedOverAnother) {
  saveSoilFile(folder_ / "saved.toml", findSoil("jsc-1a"));
  EXPECT_THROW(saveSoilFile(folder_ / "saved.toml", findSoil("lunar-0-15cm")), Failure);
  EXPECT_EQ(loadSoilFile(folder_ / "saved.toml").name, findSoil("jsc-1a").name);
}

TEST_F(SoilFiles, WhatMayBeLeftOutHasItsDefault) {
  const SoilFile soil = load(kTarget + kSoil);
  EXPECT_EQ(soil.source, "");
  EXPECT_FALSE(soil.target.friction_angle_range_deg);
  EXPECT_FALSE(soil.target.cohesion_range_pa);
  EXPECT_EQ(soil.target.strength, SoilStrength::kResidual);
  EXPECT_FALSE(soil.reached);
  EXPECT_EQ(soil.soil.cohesion_range_ratio, SoilParameters{}.cohesion_range_ratio);
  EXPECT_EQ(soil.soil.friction, FrictionModel::kContact);
}

TEST_F(SoilFiles, TheRadiusRescalesNothingBecauseAllNumbersAreForIt) {
  std::string text = kTarget + kSoil;
  text.replace(text.find("radius_mm = 7"), 13, "radius_mm = 3");
  const SoilParameters soil = load(text).soil;
  EXPECT_EQ(soil.radius_m, 3 * 1e-3);
  EXPECT_EQ(soil.gamma_nm, 4e-5);
  EXPECT_EQ(soil.stiffness_n_m, 2000);
  EXPECT_EQ(soil.contact_cohesion_n, 0.1);
}

// --- the shipped soils ---

struct MeasuredSoil {
  double density_kg_m3, friction_angle_deg, cohesion_pa;
  std::string friction_angle_range, cohesion_range;
};

std::map<std::string, MeasuredSoil> measuredSoils() {
  std::map<std::string, MeasuredSoil> soils;
  std::ifstream file(sourceDir() / "tests/data/soils.csv");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#') || line.starts_with("soil,")) {
      continue;
    }
    std::istringstream cells(line);
    std::vector<std::string> cell(6);
    for (std::string& text : cell) {
      std::getline(cells, text, ',');
    }
    soils[cell[0]] = {std::stod(cell[1]), std::stod(cell[2]), std::stod(cell[4]), cell[3], cell[5]};
  }
  return soils;
}

std::string rangeText(const std::optional<Range>& range) {
  return range ? fmt::format("{}-{}", range->lowest, range->highest) : "";
}

TEST(ShippedSoils, AimAtWhatWasMeasured) {
  const std::map<std::string, MeasuredSoil> measured = measuredSoils();
  ASSERT_FALSE(measured.empty());
  EXPECT_EQ(soilNames().size(), measured.size());
  for (const auto& [name, row] : measured) {
    const SoilFile soil = findSoil(name);
    EXPECT_EQ(soil.name, name);
    EXPECT_FALSE(soil.source.empty()) << name;
    EXPECT_EQ(soil.target.bulk_density_kg_m3, row.density_kg_m3) << name;
    EXPECT_EQ(soil.target.friction_angle_deg, row.friction_angle_deg) << name;
    EXPECT_EQ(soil.target.cohesion_pa, row.cohesion_pa) << name;
    EXPECT_EQ(rangeText(soil.target.friction_angle_range_deg), row.friction_angle_range) << name;
    EXPECT_EQ(rangeText(soil.target.cohesion_range_pa), row.cohesion_range) << name;
    EXPECT_EQ(soil.soil.friction, FrictionModel::kContact) << name;
  }
}

TEST(ShippedSoils, AreTheFilesOfTheFolder) {
  std::set<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(sourceDir() / "soils")) {
    files.insert(entry.path().stem().string());
    expectSame(findSoil(entry.path().stem().string()), loadSoilFile(entry.path()));
  }
  const std::vector<std::string> names = soilNames();
  EXPECT_EQ(std::set(names.begin(), names.end()), files);
}

// --- finding ---

TEST_F(SoilFiles, AreFoundByNameInAnyCaseOrByFile) {
  EXPECT_EQ(findSoil("LUNAR-0-15cm").name, "lunar-0-15cm");
  EXPECT_EQ(findSoil(write(kTarget + kSoil).string()).name, "x");
  fs::rename(folder_ / "x.toml", folder_ / "x.soil");
  EXPECT_EQ(findSoil((folder_ / "x.soil").string()).name, "x");
}

TEST_F(SoilFiles, AnUnknownNameIsRefusedWithTheValidOnesAndTheNearest) {
  const auto errorOfName = [](const std::string& name) -> std::string {
    try {
      static_cast<void>(findSoil(name));
    } catch (const InvalidParameter& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(errorOfName("Surveyor"),
              AllOf(StartsWith("soil = 'Surveyor' is not valid: must be one of apollo-15-srp, "),
                    HasSubstr("a soil file (.toml); did you mean surveyor-3?")));
  EXPECT_THAT(errorOfName("marmalade"), AllOf(HasSubstr("jsc-1a"), Not(HasSubstr("did you mean"))));
  EXPECT_THAT(errorOfName(""), HasSubstr("soil = '' is not valid"));
  EXPECT_THAT(errorOfName(folder_.string()), HasSubstr("must be one of"));
  EXPECT_EQ(errorOfName("/no/such.toml"), "/no/such.toml: no such file");
}

// --- what is refused ---

TEST_F(SoilFiles, NonsenseIsRefusedWithItsLine) {
  EXPECT_EQ(errorOf(kTarget + "friction_angel_deg = 3\n" + kSoil),
            "x.toml:6: [target] friction_angel_deg is not known; did you mean [target] friction_angle_deg?");
  EXPECT_EQ(errorOf(kTarget + kSoil + "preset = 'P3'\n"),
            "x.toml:15: [soil] preset is not known, see docs/reference/soils.md");
  EXPECT_EQ(errorOf("title = 'x'\n"), "x.toml:1: title is not known, see docs/reference/soils.md");
  EXPECT_EQ(errorOf("name = 3\n"), "x.toml:1: name = 3 is not valid: must be a line of text");
  EXPECT_EQ(errorOf("name = 'x'\ntarget = 42\n"), "x.toml:2: target = 42 is not valid: must be a table, [target]");
  EXPECT_EQ(errorOf("[target]\nfriction_angle_deg = 95.5\n"),
            "x.toml:2: [target] friction_angle_deg = 95.5 is not valid: must be 0 to 89");
  EXPECT_EQ(errorOf("[target]\ncohesion_pa = '520'\n"),
            "x.toml:2: [target] cohesion_pa = '520' is not valid: must be a number, 0 to 1000000");
  EXPECT_EQ(errorOf("[target]\nstrength = 'final'\n"),
            "x.toml:2: [target] strength = 'final' is not valid: must be residual or peak");
  EXPECT_EQ(errorOf(kTarget + kSoil + "damping_ratio = 0.6\n"),
            "x.toml:15: [soil] damping_ratio = 0.6 is not valid: must be 0 to 0.5");
  EXPECT_EQ(errorOf("[reached]\nseeds = 2.5\n"),
            "x.toml:2: [reached] seeds = 2.5 is not valid: must be a whole number, 1 to 1000000");
  EXPECT_THAT(errorOf("name = 'x'\n[soil\n"), HasSubstr("x.toml:2: not TOML: "));
  EXPECT_THAT(errorOf(""),
              HasSubstr("x.toml: empty: a soil has at least one key, for example name (docs/reference/soils.md)"));
}

TEST_F(SoilFiles, RangesAreTwoNumbersAroundTheValue) {
  const std::string valid = "two numbers, each 0 to 89, the smaller first";
  for (const char* range : {"[ 42 ]", "[ 43, 41 ]", "[ 41, 42, 43 ]", "42"}) {
    EXPECT_EQ(errorOf(fmt::format("[target]\nfriction_angle_range_deg = {}\n", range)),
              fmt::format("x.toml:2: [target] friction_angle_range_deg = {} is not valid: must be {}", range, valid));
  }
  EXPECT_EQ(errorOf("[target]\nfriction_angle_range_deg = [41, 95]\n"),
            "x.toml:2: [target] friction_angle_range_deg = 95 is not valid: must be " + valid);
  EXPECT_EQ(errorOf(kTarget + "cohesion_range_pa = [600, 700.5]\n" + kSoil),
            "x.toml:5: [target] cohesion_pa = 520 is not valid: must be 600 to 700.5");
}

TEST_F(SoilFiles, HalfASoilIsRefused) {
  const std::string whole = kTarget + kSoil;
  EXPECT_EQ(errorOf(whole), "no error");
  std::istringstream lines(whole);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('[')) {
      std::string text = whole;
      text.erase(text.find(line), line.size());
      EXPECT_THAT(errorOf(text),
                  HasSubstr(line.substr(0, line.find(' ')) + " is missing, see docs/reference/soils.md"));
    }
  }
  EXPECT_EQ(errorOf(whole + "[reached]\nseeds = 5\n"),
            "x.toml: [reached] friction_angle_deg is missing, see docs/reference/soils.md");
  std::string icra2021 = whole;
  icra2021.replace(icra2021.find("contact"), 7, "icra2021");
  EXPECT_EQ(errorOf(icra2021), "x.toml: [soil] mu_hat is missing, see docs/reference/soils.md");
}

TEST_F(SoilFiles, NumbersThatDoNotGoTogetherAreRefused) {
  std::string text = kTarget + kSoil;
  text.replace(text.find("1995"), 4, "1000");
  EXPECT_THAT(errorOf(text), HasSubstr("x.toml:10: [soil] rho_max_kg_m3 = 1000 is not valid: must be > 1425"));
}

TEST_F(SoilFiles, WhatCouldNotBeLoadedIsNotSaved) {
  const auto refuses = [&](auto change) {
    SoilFile soil = findSoil("jsc-1a");
    change(soil);
    EXPECT_THROW(saveSoilFile(folder_ / "saved.toml", soil), InvalidParameter);
    EXPECT_TRUE(files().empty());
  };
  refuses([](SoilFile& soil) { soil.name.clear(); });
  refuses([](SoilFile& soil) { soil.soil.gamma_nm = std::nan(""); });
  refuses([](SoilFile& soil) { soil.soil.stiffness_n_m = INFINITY; });
  refuses([](SoilFile& soil) { soil.target.friction_angle_deg = 10; });
  refuses([](SoilFile& soil) { soil.reached = SoilReached{}; });
  EXPECT_THROW(saveSoilFile("/no/such/folder/saved.toml", findSoil("jsc-1a")), Failure);
}

// --- in a scene ---

class SoilsInScenes : public SoilFiles {
 protected:
  [[nodiscard]] SceneFile loadScene(const std::string& text) const {
    std::ofstream(folder_ / "scene.toml") << text;
    return loadSceneFile(folder_ / "scene.toml");
  }

  [[nodiscard]] std::string sceneErrorOf(const std::string& text) const {
    try {
      (void)loadScene(text);
    } catch (const TomlError& error) {
      return std::string(error.what()).substr(folder_.string().size() + 1);
    }
    return "no error";
  }
};

TEST_F(SoilsInScenes, ANameIsABuiltInSoil) {
  const SceneFile scene = loadScene("[soil]\nname = 'Surveyor-3'\n");
  EXPECT_EQ(scene.soil_name, "surveyor-3");
  EXPECT_EQ(scene.preset, "");
  expectSameNumbers(scene.bed.soil, findSoil("surveyor-3").soil);
}

TEST_F(SoilsInScenes, AFileLiesBesideTheScene) {
  (void)write(kTarget + kSoil);
  const SceneFile scene = loadScene("[soil]\nfile = 'x.toml'\n");
  EXPECT_EQ(scene.soil_name, "x");
  EXPECT_EQ(scene.preset, "");
  EXPECT_EQ(scene.bed.soil.contact_cohesion_n, 0.1);
}

TEST_F(SoilsInScenes, TheRadiusRescalesANamedSoil) {
  const SceneFile scene = loadScene("[soil]\nradius_mm = 3.5\nname = 'jsc-1a'\ndamping_ratio = 0.3\n");
  SoilParameters expected = rescaled(findSoil("jsc-1a").soil, 3.5 * 1e-3);
  expected.damping_ratio = 0.3;
  expectSameNumbers(scene.bed.soil, expected);
  EXPECT_EQ(scene.soil_name, "jsc-1a");
}

TEST_F(SoilsInScenes, OneSoilIsEnough) {
  (void)write(kTarget + kSoil);
  for (const std::string other : {"preset = 'P3'", "gamma_nm = 4e-5", "rho0_kg_m3 = 1400", "rho_max_kg_m3 = 1900",
                                  "mu_hat = 0.3", "contact_friction = 0.5", "contact_cohesion_n = 0.1"}) {
    for (const std::string soil : {"name = 'lhs-1'", "file = 'x.toml'"}) {
      EXPECT_THAT(sceneErrorOf("[soil]\n" + soil + "\n" + other + "\n"),
                  AllOf(StartsWith("scene.toml:3: [soil] "), HasSubstr("cannot both be given")));
    }
  }
  EXPECT_EQ(sceneErrorOf("[soil]\nname = 'lhs-1'\nfile = 'x.toml'\n"),
            "scene.toml:3: [soil] name and file cannot both be given");
}

TEST_F(SoilsInScenes, WhatIsWrongIsToldWhereItIs) {
  EXPECT_THAT(sceneErrorOf("[soil]\nname = 'moon'\n"),
              StartsWith("scene.toml:2: [soil] name = 'moon' is not valid: must be apollo-15-srp, dry-sand, "));
  EXPECT_THAT(sceneErrorOf("[soil]\nfile = 'none.toml'\n"),
              AllOf(StartsWith("scene.toml:2: [soil] file = "), HasSubstr("none.toml: no such file")));
  EXPECT_EQ(sceneErrorOf("[soil]\nfile = 3\n"), "scene.toml:2: [soil] file = 3 is not valid: must be a file");
  (void)write("[target]\ncohesion_pa = -1\n");
  EXPECT_EQ(sceneErrorOf("[soil]\nfile = 'x.toml'\n"),
            "x.toml:2: [target] cohesion_pa = -1 is not valid: must be 0 to 1000000");
}

// --- docs/reference/soils.md ---

TEST(SoilFileKeys, AreAllInTheDocumentAndNoOthers) {
  const std::string document = readFile(sourceDir() / "docs/reference/soils.md");
  for (const SoilFileKey& key : soilFileKeys()) {
    const std::size_t section =
        document.find(key.table.empty() ? "## At the top\n" : fmt::format("## [{}]\n", key.table));
    ASSERT_NE(section, std::string::npos) << "no section for " << key.table;
    EXPECT_THAT(document.substr(section, document.find("\n## ", section + 1) - section),
                HasSubstr(fmt::format("| `{}` | {} | {} |\n", key.name, validText(key), key.meaning)));
  }
  std::ptrdiff_t rows = 0;
  for (std::size_t at = document.find("\n| `"); at != std::string::npos; at = document.find("\n| `", at + 1)) {
    ++rows;
  }
  EXPECT_EQ(rows, std::ssize(soilFileKeys()));
}

TEST(SoilFileKeys, OfSoilAreThoseOfASceneThatAreNumbersOfTheSoil) {
  std::vector<std::string_view> names;
  for (const SceneFileKey& key : soilKeys()) {
    EXPECT_EQ(key.table, "soil");
    names.push_back(key.name);
  }
  const auto in_scenes = std::ranges::count(sceneFileKeys(), std::string_view("soil"), &SceneFileKey::table);
  EXPECT_EQ(std::ssize(names) + 3, in_scenes) << "all but preset, name and file";
  EXPECT_THAT(names, AllOf(testing::Contains("friction_model"), Not(testing::Contains("preset")),
                           Not(testing::Contains("name")), Not(testing::Contains("file"))));
}

}  // namespace
}  // namespace haptolith
