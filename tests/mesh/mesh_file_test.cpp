#include "haptolith/mesh/mesh_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "haptolith/core/error.h"
#include "haptolith/mesh/mend.h"

#include "made_meshes.h"

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <class Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string binaryStl(const TriangleMesh& mesh, double unit_m = 1e-3, std::string header = "made by a test") {
  header.resize(80, ' ');
  append(header, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      append(header, std::numeric_limits<float>::quiet_NaN());  // a normal, of which nothing depends
    }
    for (const Vec3& corner : cornersOf(mesh, triangle)) {
      for (const double x : corner) {
        append(header, static_cast<float>(x / unit_m));
      }
    }
    append(header, std::uint16_t{7});
  }
  return header;
}

std::string textStl(const TriangleMesh& mesh, const std::string& name) {
  std::string text = "solid " + name + "\n";
  for (const auto& triangle : mesh.triangles) {
    text += "  facet normal 0 0 nan\n    outer loop\n";
    for (const Vec3& corner : cornersOf(mesh, triangle)) {
      text += fmt::format("      vertex {} {:+e} {}\n", 1e3 * corner.x(), 1e3 * corner.y(), 1e3 * corner.z());
    }
    text += "    endloop\n  endfacet\r\n";
  }
  return text + "endsolid " + name + "\n";
}

std::string glb(const std::string& json, const std::string& binary) {
  std::string padded = json;
  padded.resize((json.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  append(bytes, std::uint32_t{2});
  append(bytes, static_cast<std::uint32_t>(12 + 8 + padded.size() + 8 + binary.size()));
  append(bytes, static_cast<std::uint32_t>(padded.size()));
  bytes += "JSON" + padded;
  append(bytes, static_cast<std::uint32_t>(binary.size()));
  bytes.append("BIN\0", 4);
  return bytes + binary;
}

/// A cube of 20 mm as 36 floats of positions and 16-bit indices, and JSON with these nodes.
constexpr std::size_t kPositionBytes = 36 * 12;
std::string cubeBytes() {
  const TriangleMesh cube = made::cube(0.02);
  std::string bytes;
  for (const Vec3& point_m : cube.points_m) {
    for (const double x : point_m) {
      append(bytes, static_cast<float>(x));
    }
  }
  for (const auto& triangle : cube.triangles) {
    for (const std::int32_t i : triangle) {
      append(bytes, static_cast<std::uint16_t>(i));
    }
  }
  return bytes;
}
std::string cubeJson(
    const std::string& nodes, const std::string& buffer = R"({"byteLength":504})",
    const std::string& index_accessor = R"({"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"})") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)"
         R"({"bufferView":0,"componentType":5126,"count":36,"type":"VEC3"},)" +
         index_accessor +
         R"(],"bufferViews":[{"buffer":0,"byteLength":432},{"buffer":0,"byteOffset":432,"byteLength":72}],"buffers":[)" +
         buffer + "]}";
}

std::string refusalOf(const std::string& bytes, MeshFormat format, const MeshFileOptions& options = {}) {
  try {
    (void)parseMesh(bytes, "given", format, options);
  } catch (const InvalidParameter& error) {
    return error.what();
  }
  return "accepted";
}

MeshCorners boxOf(const std::string& bytes, MeshFormat format, const MeshFileOptions& options = {}) {
  return cornersOf(parseMesh(bytes, "given", format, options));
}

double volumeOf(const std::string& bytes, MeshFormat format) {
  return made::volume_m3(parseMesh(bytes, "given", format));
}

void expectNear(const Vec3& a, const Vec3& b) {
  EXPECT_LT((a - b).norm(), 1e-8) << a.transpose() << " is not " << b.transpose();
}

const TriangleMesh kBox = made::box(Vec3(0.01, 0.02, 0.03), Vec3(0.02, 0.05, 0.09));
constexpr double kBox_m3 = 0.01 * 0.03 * 0.06;

TEST(Stl, IsReadAsBytesAndAsText) {
  for (const std::string& bytes : {binaryStl(kBox), binaryStl(kBox, 1e-3, "solid that is none"), textStl(kBox, "box"),
                                   textStl(kBox, "facet vertex 1 2"),
                                   textStl(made::box({0.01, 0.02, 0.03}, {0.02, 0.05, 0.06}), "a") +
                                       textStl(made::box({0.01, 0.02, 0.06}, {0.02, 0.05, 0.09}), "")}) {
    const MeshCorners corners = boxOf(bytes, MeshFormat::kStl);
    expectNear(corners.low_m, {0.01, 0.02, 0.03});
    expectNear(corners.high_m, {0.02, 0.05, 0.09});
    EXPECT_NEAR(volumeOf(bytes, MeshFormat::kStl), kBox_m3, 1e-11);
  }
}

TEST(Stl, RefusesWhatIsCutOffOrCountsWrong) {
  const std::string bytes = binaryStl(kBox);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_THAT(refusalOf(bytes.substr(0, length), MeshFormat::kStl), HasSubstr("bytes")) << length;
  }
  std::string hostile = bytes;
  std::memset(hostile.data() + 80, 0xFF, 4);
  EXPECT_THAT(refusalOf(hostile, MeshFormat::kStl), HasSubstr("4294967295 triangles"));
  const std::string text = textStl(kBox, "box");
  for (std::size_t length = 1; length < text.size() - 13; length += 7) {
    EXPECT_NE(refusalOf(text.substr(0, length), MeshFormat::kStl), "accepted") << length;
  }
  EXPECT_THAT(refusalOf(text.substr(0, text.size() - 13), MeshFormat::kStl), HasSubstr("truncated"));
}

TEST(Stl, RefusesNumbersThatAreNone) {
  for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    TriangleMesh mesh = kBox;
    mesh.points_m[static_cast<std::size_t>(mesh.triangles[4][1])].z() = wrong;
    EXPECT_THAT(refusalOf(binaryStl(mesh), MeshFormat::kStl), HasSubstr("given: triangle 5: corner 2"));
    EXPECT_THAT(refusalOf(textStl(mesh, "x"), MeshFormat::kStl),
                AllOf(HasSubstr("given:33: vertex"), HasSubstr("finite")));
  }
  EXPECT_THAT(refusalOf("solid x\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3abc\n", MeshFormat::kStl),
              HasSubstr("given:4: vertex = '3abc'"));
  EXPECT_THAT(refusalOf("solid x\nfacet normal 0 0 1\nouter loop\nendloop\n", MeshFormat::kStl), HasSubstr("'vertex'"));
  EXPECT_THAT(refusalOf("solid x\nendsolid x\n", MeshFormat::kStl), HasSubstr("without a triangle"));
}

const std::string kObjCube =
    "# a cube\r\nmtllib ../secret.mtl\no cube\nv -10 -10 -10 0.5 0.5 0.5\nv 10 -10 -10\nv 10 10 -10\nv -10 10 -10\n"
    "v -10 -10 10\nv 10 -10 10\nv 10 10 10\nv -10 10 10\nvn 0 0 1\nvt 0 0\nusemtl red\n"
    "f 4 3 2 1\nf 5/1 6/1 7/1 8/1\nf 1//1 2//1 \\\n 6//1 5//1\nf -6/1/1 -5/1/1 -1/1/1 -2/1/1\nf 2 3 7 6 # side\nf 1 5 "
    "8 4\n";

TEST(Obj, IsReadWithPolygonsAndIndicesFromTheEnd) {
  const TriangleMesh mesh = parseMesh(kObjCube, "given", MeshFormat::kObj);
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_NEAR(made::volume_m3(mesh), 8e-6, 1e-12);
  EXPECT_EQ(mend(mesh).report.size(), 0U) << "closed, all looking outwards";
}

TEST(Obj, RefusesIndicesOutOfRangeWithTheirLine) {
  const std::string points = "v 0 0 0\nv 10 0 0\nv 0 10 0\n";
  for (const char* wrong : {"4", "0", "-4", "9999999999999999999999", "x", "1.5", "/1", ""}) {
    EXPECT_THAT(refusalOf(points + "f 1 2 " + wrong + "\n", MeshFormat::kObj), HasSubstr("given:4: face")) << wrong;
  }
  EXPECT_THAT(refusalOf("f 1 2 3\n" + points, MeshFormat::kObj), HasSubstr("no points before it"));
  EXPECT_THAT(refusalOf("v 1 2\n", MeshFormat::kObj), AllOf(HasSubstr("given:1: v"), HasSubstr("missing")));
  EXPECT_THAT(refusalOf("v 1 nan 2\n", MeshFormat::kObj), HasSubstr("finite"));
  EXPECT_THAT(refusalOf("v 1 1e999 2\n", MeshFormat::kObj), HasSubstr("finite"));
  EXPECT_THAT(refusalOf(points + "f 1 2 3\nv 1e-999 0 0", MeshFormat::kObj), "accepted");
  EXPECT_THAT(refusalOf("", MeshFormat::kObj), HasSubstr("without a triangle"));
}

TEST(Obj, RefusesTooManyTriangles) {
  std::string text = "v 0 0 0\nv 10 0 0\nv 0 10 0\n";
  const std::string fan = [] {
    std::string line = "f";
    for (int i = 0; i < 100'002; ++i) {
      line += " 1";
    }
    return line + "\n";
  }();
  for (int i = 0; i < 21; ++i) {
    text += fan;
  }
  EXPECT_THAT(refusalOf(text, MeshFormat::kObj),
              AllOf(HasSubstr("given:24: face"), HasSubstr("at most 2000000 triangles")));
}

TEST(Mesh, OfAnotherUnitIsRefusedWithOneThatIsPlausible) {
  EXPECT_THAT(
      refusalOf(binaryStl(made::cube(0.05), 1), MeshFormat::kStl),
      AllOf(HasSubstr("0.05 mm"), HasSubstr("2 mm to 2 m"), HasSubstr("with a unit of 1 m (1 m) it would be 50 mm")));
  EXPECT_THAT(refusalOf(binaryStl(made::cube(0.05)), MeshFormat::kStl, {.unit_m = 1}),
              AllOf(HasSubstr("50 m"), HasSubstr("with a unit of 1 mm (0.001 m) it would be 50 mm")));
  EXPECT_EQ(refusalOf(binaryStl(made::cube(0.05), 1), MeshFormat::kStl, {.unit_m = 1}), "accepted");
  EXPECT_THAT(refusalOf(binaryStl(made::cube(0.05)), MeshFormat::kStl, {.unit_m = -1}), HasSubstr("unit_m"));
  EXPECT_THAT(refusalOf(binaryStl(made::cube(0.05, Vec3(11, 0, 0))), MeshFormat::kStl),
              HasSubstr("at most 10 m from the origin"));
  const std::string scaled = cubeJson(R"([{"mesh":0,"scale":[1000,1000,1000]}])");
  EXPECT_THAT(refusalOf(glb(scaled, cubeBytes()), MeshFormat::kGltf), HasSubstr("at a scale of 0.001"));
}

TEST(Gltf, IsReadWithTransformsAndZUp) {
  // A child, 50 mm up in glTF (y), turned by 90 degrees about y, twice as long along x before; under a parent that
  // mirrors x and moves by 10 mm along z.
  const std::string nodes =
      R"([{"children":[1],"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0.01,1]},)"
      R"({"mesh":0,"translation":[0,0.05,0],"rotation":[0,0.7071067811865476,0,0.7071067811865476],"scale":[2,1,1]}])";
  const std::string bytes = glb(cubeJson(nodes), cubeBytes());
  const MeshCorners corners = boxOf(bytes, MeshFormat::kGltf, {.unit_m = 0.5});  // metres whatever the unit is
  // x (40 mm) -> -z; then +10 mm along z; z -> -y: y from -30 to 10 mm; y -> z: 40 to 60 mm.
  expectNear(corners.low_m, {-0.01, -0.03, 0.04});
  expectNear(corners.high_m, {0.01, 0.01, 0.06});
  EXPECT_NEAR(volumeOf(bytes, MeshFormat::kGltf), 16e-6, 1e-11) << "looks outwards, though it is mirrored";
}

TEST(Gltf, IsReadAsTextWithEmbeddedData) {
  constexpr const char* kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string bytes = cubeBytes();
  std::string code;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {  // 504 is a multiple of 3
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | static_cast<unsigned char>(bytes[i + k]);
    }
    for (const unsigned shift : {18U, 12U, 6U, 0U}) {
      code += kLetters[bits >> shift & 63];
    }
  }
  const auto buffer = [](const std::string& uri) { return R"({"byteLength":504,"uri":")" + uri + "\"}"; };
  const std::string nodes = R"([{"mesh":0}])";
  const std::string data = "data:application/octet-stream;base64,";
  EXPECT_NEAR(volumeOf(cubeJson(nodes, buffer(data + code)), MeshFormat::kGltf), 8e-6, 1e-12);
  EXPECT_THAT(refusalOf(cubeJson(nodes, buffer("cube.bin")), MeshFormat::kGltf),
              AllOf(HasSubstr("buffers[0].uri = 'cube.bin'"), HasSubstr("other files are not read")));
  EXPECT_THAT(refusalOf(cubeJson(nodes, buffer("/etc/passwd")), MeshFormat::kGltf),
              HasSubstr("other files are not read"));
  EXPECT_THAT(refusalOf(cubeJson(nodes, buffer(data + code.substr(4))), MeshFormat::kGltf), HasSubstr("504 bytes"));
  EXPECT_THAT(refusalOf(cubeJson(nodes, buffer(data + "*" + code.substr(1))), MeshFormat::kGltf), HasSubstr("base64"));
  EXPECT_THAT(refusalOf(cubeJson(nodes), MeshFormat::kGltf), HasSubstr("without data"));
}

TEST(Gltf, RefusesWhatLeadsOutOfIt) {
  const std::string nodes = R"([{"mesh":0}])";
  const auto refusal = [&](const std::string& json) { return refusalOf(glb(json, cubeBytes()), MeshFormat::kGltf); };
  EXPECT_EQ(refusal(cubeJson(nodes)), "accepted");
  EXPECT_THAT(refusal(cubeJson(R"([{"mesh":1}])")), HasSubstr("nodes[0].mesh = 1"));
  EXPECT_THAT(refusal(cubeJson(R"([{"mesh":-1}])")), HasSubstr("whole number"));
  EXPECT_THAT(refusal(cubeJson(R"([{"mesh":0,"children":[0]}])")), HasSubstr("reached twice"));
  EXPECT_THAT(refusal(cubeJson(R"([{"mesh":0,"scale":[1,1e99,1]}])")), HasSubstr("scale[1]"));
  EXPECT_THAT(refusal(cubeJson(R"([{"mesh":0,"rotation":[0,0,0,0]}])")), HasSubstr("of length 1"));
  EXPECT_THAT(refusal(cubeJson(nodes, R"({"byteLength":505})")), HasSubstr("504 bytes"));
  EXPECT_THAT(refusal(cubeJson(nodes, R"({"byteLength":503})")), HasSubstr("within its buffer"));
  const auto indices = [&](const std::string& accessor) {
    return refusal(cubeJson(nodes, R"({"byteLength":504})", accessor));
  };
  EXPECT_THAT(indices(R"({"bufferView":1,"componentType":5123,"count":37,"type":"SCALAR"})"),
              HasSubstr("within a view"));
  EXPECT_THAT(indices(R"({"bufferView":1,"componentType":5123,"count":4294967296,"type":"SCALAR"})"),
              HasSubstr("count"));
  EXPECT_THAT(indices(R"({"bufferView":1,"componentType":5123,"byteOffset":268435456,"count":36,"type":"SCALAR"})"),
              HasSubstr("within a view"));
  EXPECT_THAT(indices(R"({"bufferView":0,"componentType":5125,"count":36,"type":"SCALAR"})"),
              HasSubstr("the number of points"));
  EXPECT_THAT(indices(R"({"bufferView":1,"componentType":5126,"count":18,"type":"SCALAR"})"),
              HasSubstr("whole numbers"));
  EXPECT_THAT(indices(R"({"bufferView":1,"componentType":5123,"count":35,"type":"SCALAR"})"),
              HasSubstr("a multiple of 3"));
  std::string nan = cubeBytes();
  std::memset(nan.data() + 24, 0xFF, 4);
  EXPECT_THAT(refusalOf(glb(cubeJson(nodes), nan), MeshFormat::kGltf), HasSubstr("no finite number in value 2"));
  std::string draco = cubeJson(nodes);
  draco.insert(1, R"("extensionsRequired":["KHR_draco_mesh_compression"],)");
  EXPECT_THAT(refusal(draco), HasSubstr("without compression"));
  EXPECT_THAT(refusalOf(R"({"asset":{"version":"1.0"}})", MeshFormat::kGltf), HasSubstr("2.0"));
  EXPECT_THAT(refusalOf("[1]", MeshFormat::kGltf), HasSubstr("glTF 2.0"));
  EXPECT_THAT(refusalOf(std::string(100'000, '['), MeshFormat::kGltf), HasSubstr("brackets deep"));
}

TEST(Gltf, RefusesAFileThatWasCutOffAnywhere) {
  const std::string bytes = glb(cubeJson(R"([{"mesh":0}])"), cubeBytes());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_NE(refusalOf(bytes.substr(0, length), MeshFormat::kGltf), "accepted") << length;
  }
  std::string part = bytes;
  std::memset(part.data() + 12, 0xFF, 4);
  EXPECT_THAT(refusalOf(part, MeshFormat::kGltf), HasSubstr("part at byte 12"));
}

TEST(MeshFile, IsReadByItsName) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() /
      fmt::format("haptolith-mesh-{}", testing::UnitTest::GetInstance()->random_seed());
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  };
  EXPECT_EQ(readMesh(write("a.STL", binaryStl(kBox))).triangles.size(), 12U);
  EXPECT_EQ(readMesh(write("a.obj", kObjCube)).triangles.size(), 12U);
  EXPECT_EQ(readMesh(write("a.glb", glb(cubeJson(R"([{"mesh":0}])"), cubeBytes()))).triangles.size(), 12U);
  EXPECT_THROW((void)readMesh(write("a.step", "x")), InvalidParameter);
  EXPECT_THROW((void)readMesh(write("empty.stl", "")), InvalidParameter);
  EXPECT_THROW((void)readMesh(folder / "none.stl"), InvalidParameter);
  std::filesystem::resize_file(write("large.stl", ""), kMostMeshBytes + 1);  // sparse
  EXPECT_THROW((void)readMesh(folder / "large.stl"), InvalidParameter);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace haptolith
