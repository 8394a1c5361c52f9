#pragma once

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "haptolith/recording/picture_meshes.h"

namespace haptolith {

static_assert(std::endian::native == std::endian::little, "the files say so");

/// A file of VTK's XML format for unstructured grids, with the arrays as they are behind the description: first their
/// size in bytes, then their values.
class VtuFile {
 public:
  explicit VtuFile(const PictureMesh& mesh);

  void addTime(double time_s) { addNumbers({"TimeValue", {time_s}}); }

  void addNumbers(const NamedNumbers& numbers);

  template <class Value>
  void addPointData(const char* name, const std::vector<Value>& values) {
    point_data_ += array(name, values);
  }

  [[nodiscard]] std::string text() const;

 private:
  template <class Value>
  std::string array(const char* name, const std::vector<Value>& values) {
    const std::uint64_t offset = bytes_.size();
    const std::uint64_t size = values.size() * sizeof(Value);
    bytes_.append(reinterpret_cast<const char*>(&size), sizeof(size));
    bytes_.append(reinterpret_cast<const char*>(values.data()), size);
    constexpr bool kVector = std::is_same_v<Value, std::array<float, 3>>;
    const char* type = std::is_same_v<Value, std::int32_t>   ? "Int32"
                       : std::is_same_v<Value, std::uint8_t> ? "UInt8"
                                                             : "Float32";
    return fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)"
                       "\n",
                       type, name, kVector ? 3 : 1, offset);
  }

  std::string numbers_, mesh_, point_data_, bytes_;
};

/// Files with their times: what ParaView opens as one.
class VtkCollection {
 public:
  void add(double time_s, const std::string& file);
  [[nodiscard]] bool empty() const { return sets_.empty(); }
  [[nodiscard]] std::string text() const;

 private:
  std::string sets_;
};

}  // namespace haptolith
