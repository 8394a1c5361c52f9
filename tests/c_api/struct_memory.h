// Structs that begin with `size`, as callers of older and newer versions of the header have them.
#pragma once

#include <gmock/gmock.h>
#include <haptolith/haptolith.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace haptolith::library {

inline constexpr unsigned char kUntouched = 0x5A;
inline constexpr std::uint32_t kLater = 64;  ///< bytes that a later version has more

/// Memory for any of the structs, as a caller has it.
struct Memory {
  alignas(16) std::array<unsigned char, 1024> bytes;

  explicit Memory(std::uint32_t size) {
    bytes.fill(kUntouched);
    std::memcpy(bytes.data(), &size, sizeof size);
  }
  template <class Struct>
  [[nodiscard]] Struct* as() {
    return reinterpret_cast<Struct*>(bytes.data());
  }
};

/// Expects that a struct is filled in for every size from `first` on, and nothing beyond it.
/// @param first  bytes of its first version.
template <class Struct>
void expectFilledIn(const std::string& name, std::uint32_t first, const std::function<std::int32_t(Struct*)>& call) {
  SCOPED_TRACE(name);
  ASSERT_LE(first, sizeof(Struct));
  Memory too_small(first - 1);
  EXPECT_EQ(call(too_small.as<Struct>()), HAPTO_WRONG_SIZE);
  const std::uint32_t now = sizeof(Struct);
  for (const std::uint32_t size : {first, now, now + kLater}) {
    SCOPED_TRACE(size);
    Memory memory(size);
    EXPECT_EQ(call(memory.as<Struct>()), HAPTO_OK);
    EXPECT_EQ(memory.as<Struct>()->size, size);
    EXPECT_THAT(std::vector<unsigned char>(memory.bytes.begin() + std::min(size, now), memory.bytes.end()),
                testing::Each(kUntouched));
    EXPECT_THAT(std::vector<unsigned char>(memory.bytes.begin() + 4, memory.bytes.begin() + first),
                testing::Not(testing::Each(kUntouched)));
  }
}

}  // namespace haptolith::library
