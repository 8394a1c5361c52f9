// Mesh files as people's programs write them: each reads as a clean one, or is refused with a reason.

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/mesh/mesh_file.h"

#include "../shared/messy_inputs.h"
#include "../source_dir.h"
#include "made_meshes.h"

namespace haptolith {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

double area_m2(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto [a, b, c] = cornersOf(mesh, triangle);
    sum += (b - a).cross(c - a).norm() / 2;
  }
  return sum;
}

const fs::path kFolder = sourceDir() / "tests/data/messy/meshes";

void expectTheSame(const TriangleMesh& mesh, const TriangleMesh& clean) {
  constexpr double kRounded = 1e-5;
  EXPECT_EQ(mesh.triangles.size(), clean.triangles.size());
  EXPECT_NEAR(made::volume_m3(mesh), made::volume_m3(clean), kRounded * made::volume_m3(clean));
  EXPECT_NEAR(area_m2(mesh), area_m2(clean), kRounded * area_m2(clean));
  const MeshCorners corners = cornersOf(mesh);
  EXPECT_LT((corners.low_m - cornersOf(clean).low_m).norm(), 1e-7);
  EXPECT_LT((corners.high_m - cornersOf(clean).high_m).norm(), 1e-7);
}

TEST(MessyMeshes, ReadAsTheCleanOnesOrAreRefused) {
  const std::vector<Expectation> all = expectationsIn(kFolder);
  EXPECT_GE(all.size(), 60U);
  for (const Expectation& expected : all) {
    expectAsWritten(expected, [&expected] {
      const TriangleMesh mesh = readMesh(kFolder / expected.input);
      if (!expected.clean.empty()) {
        expectTheSame(mesh, readMesh(kFolder / expected.clean));
      }
      return std::string();
    });
  }
}

std::string bytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(MessyMeshes, AreRefusedOrReadWithAnyBytesChanged) {
  std::mt19937_64 random(11);
  int read = 0;
  for (const Expectation& one : expectationsIn(kFolder)) {
    for (int i = 0; i < 40; ++i) {
      std::string bytes = bytesOf(kFolder / one.input);
      for (int changes = 0; changes < 3 && !bytes.empty(); ++changes) {
        bytes[random() % bytes.size()] = static_cast<char>(random());
      }
      try {
        (void)parseMesh(bytes, "changed", *meshFormat(one.input));
        ++read;
      } catch (const InvalidParameter&) {
        continue;
      }
    }
  }
  EXPECT_GT(read, 100);
}

TEST(MessyMeshes, TheCleanOnesAreRight) {
  for (const char* name : {"l.obj", "l.stl", "l.glb"}) {
    const TriangleMesh l = readMesh(kFolder / name);
    EXPECT_NEAR(made::volume_m3(l), 5e-6, 1e-11) << name;
    EXPECT_NEAR(area_m2(l), 2 * 500e-6 + 120e-3 * 10e-3, 1e-9) << name;
  }
  EXPECT_NEAR(made::volume_m3(readMesh(kFolder / "frame.obj")), 4e-6, 1e-11);
}

TEST(MessyMeshes, SayWhatIsLeftOut) {
  const auto notes_of = [](const char* name) {
    const fs::path path = kFolder / name;
    std::vector<std::string> notes;
    (void)parseMesh(bytesOf(path), name, *meshFormat(path), {}, &notes);
    return notes;
  };
  using testing::ElementsAre;
  using testing::IsEmpty;
  EXPECT_THAT(notes_of("l.stl"), IsEmpty());
  EXPECT_THAT(notes_of("l.glb"), IsEmpty());
  EXPECT_THAT(notes_of("gltf-mirrored-node.glb"), IsEmpty());
  EXPECT_THAT(notes_of("stl-two-bytes-behind.stl"), ElementsAre(HasSubstr("2 bytes after the 20 triangles")));
  EXPECT_THAT(notes_of("gltf-bytes-behind.glb"), ElementsAre(HasSubstr("3 bytes after its end")));
  EXPECT_THAT(notes_of("gltf-morph-targets.glb"), ElementsAre(HasSubstr("morph targets")));
  EXPECT_THAT(notes_of("gltf-skin.glb"), ElementsAre(HasSubstr("bones")));
  EXPECT_THAT(notes_of("gltf-lines-too.glb"), ElementsAre(HasSubstr("lines")));
}

}  // namespace
}  // namespace haptolith
