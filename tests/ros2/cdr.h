#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace haptolith {

// Plain CDR, little-endian, as OMG's DDSI-RTPS 2.2 (10.2) and CORBA's CDR have it, written down a second time: numbers
// are aligned to their size, counted from behind the 4 bytes of the encapsulation; a string is its length with the NUL
// at its end, then its bytes; a sequence is its length, then its elements.

using Bytes = std::vector<std::uint8_t>;

class CdrWriter {
 public:
  CdrWriter() = default;

  template <class Number>
  requires std::is_arithmetic_v<Number> CdrWriter& add(Number number) {
    align(sizeof number);
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&number);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof number);
    return *this;
  }
  CdrWriter& add(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
    return *this;
  }
  [[nodiscard]] const Bytes& bytes() const { return bytes_; }

 private:
  void align(std::size_t size) {
    while ((bytes_.size() - 4) % size != 0) {
      bytes_.push_back(0);
    }
  }
  Bytes bytes_{0, 1, 0, 0};  // CDR_LE, no options
};

class CdrReader {
 public:
  explicit CdrReader(const Bytes& bytes) : bytes_(bytes) {
    if (bytes.size() < 4 || bytes[0] != 0 || bytes[1] != 1) {
      throw std::runtime_error("not plain little-endian CDR");
    }
  }
  template <class Number>
  Number get() {
    while ((at_ - 4) % sizeof(Number) != 0) {
      ++at_;
    }
    Number number;
    std::memcpy(&number, &need(sizeof number), sizeof number);
    at_ += sizeof number;
    return number;
  }
  std::string text() {
    const auto size = get<std::uint32_t>();
    std::string text(reinterpret_cast<const char*>(&need(size)), size - 1);
    at_ += size;
    return text;
  }
  Bytes octets(std::size_t size) {
    const std::uint8_t* first = &need(size);
    at_ += size;
    return {first, first + size};
  }
  /// Padding to a multiple of 4.
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

 private:
  const std::uint8_t& need(std::size_t size) {
    if (size == 0 || at_ + size > bytes_.size()) {
      throw std::runtime_error("the message ends too soon");
    }
    return bytes_[at_];
  }
  const Bytes& bytes_;
  std::size_t at_ = 4;
};

}  // namespace haptolith
