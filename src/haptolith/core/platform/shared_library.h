#pragma once

#include <filesystem>
#include <memory>

namespace haptolith {

/// A library that is loaded while the program runs, because not every machine has it. Not for the tick.
class SharedLibrary {
 public:
  /// @param path  a file; a bare name ("libdrd.so.3") is left to the loader to find.
  /// @throws Failure with the loader's reason.
  explicit SharedLibrary(std::filesystem::path path);

  /// Path that the constructor was given.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

  /// The address of a function, which becomes whichever type of function pointer it is assigned to.
  struct Symbol {
    void* address;

    template <class Function>
    operator Function*() const noexcept {  // NOLINT(google-explicit-constructor): the loader knows no types
      return reinterpret_cast<Function*>(address);
    }
  };

  /// A function, which may be called as long as the program runs.
  /// @throws Failure with the names of both when the library has no such function.
  [[nodiscard]] Symbol symbol(const char* name) const;

 private:
  struct Closer {
    void operator()(void* handle) const noexcept;
  };

  std::filesystem::path path_;
  std::unique_ptr<void, Closer> handle_;
};

}  // namespace haptolith
