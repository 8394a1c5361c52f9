#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "haptolith/recording/export_pictures.h"
#include "haptolith/recording/picture_meshes.h"
#include "haptolith/recording/vtu_file.h"

namespace haptolith {

namespace {

VtuFile particlesFile(const ScenePicture& picture) {
  const std::vector<std::int32_t> id = numbered(picture.position_m.size());
  VtuFile file({.point_m = picture.position_m, .cells = id, .points_per_cell = 1});
  file.addTime(picture.time_s);
  file.addPointData(kId, id);
  file.addPointData(kRadius, picture.radius_m);
  file.addPointData(kContactForce, picture.contact_force_n);
  if (!picture.velocity_m_s.empty()) {
    file.addPointData(kVelocity, picture.velocity_m_s);
  }
  return file;
}

}  // namespace

void exportVtk(RecordedPictures& pictures, const AtomicFolder& folder) {
  VtkCollection particles, stones;
  const ToolSet parameters = pictures.sceneFile() ? toolSet(*pictures.sceneFile()) : ToolSet();
  const std::vector<std::string> tool_names = toolFileNames(pictures);
  std::vector<VtkCollection> tools(tool_names.size());
  BoxMesh box;
  std::size_t number = 0;
  pictures.forEach([&](const ScenePicture& picture) {
    const std::string name = fmt::format("particles-{:06}.vtu", number);
    folder.write(name, particlesFile(picture).text());
    particles.add(picture.time_s, name);
    for (std::size_t i = 0; i < picture.tools.size(); ++i) {
      const PicturedTool& at = picture.tools[i];
      VtuFile tool(toolMesh(parameters.all()[i], at));
      tool.addTime(picture.time_s);
      for (const NamedNumbers& numbers : numbersOf(at, parameters.all()[i])) {
        tool.addNumbers(numbers);
      }
      const std::string tool_name = fmt::format("{}-{:06}.vtu", tool_names[i], number);
      folder.write(tool_name, tool.text());
      tools[i].add(picture.time_s, tool_name);
    }
    if (!picture.stones.empty()) {
      VtuFile stones_file(stonesMesh(picture.stones));
      stones_file.addTime(picture.time_s);
      const std::string stones_name = fmt::format("stones-{:06}.vtu", number);
      folder.write(stones_name, stones_file.text());
      stones.add(picture.time_s, stones_name);
    }
    box.show(picture);
    ++number;
  });
  folder.write("particles.pvd", particles.text());
  for (std::size_t i = 0; i < tools.size(); ++i) {
    if (!tools[i].empty()) {
      folder.write(tool_names[i] + ".pvd", tools[i].text());
    }
  }
  if (!stones.empty()) {
    folder.write("stones.pvd", stones.text());
  }
  if (pictures.sceneFile()) {
    folder.write("box.vtu", VtuFile(box.of(pictures.sceneFile()->bed)).text());
  }
}

}  // namespace haptolith
