#include "haptolith/core/files/user_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <optional>
#include <string>

namespace haptolith {
namespace {

namespace fs = std::filesystem;

/// The environment's variables, as they were when it goes.
class UserFolder : public testing::Test {
 protected:
  UserFolder() {
    for (std::size_t i = 0; i < std::size(kNames); ++i) {
      const char* value = std::getenv(kNames[i]);
      before_[i] = value == nullptr ? std::nullopt : std::optional<std::string>(value);
      unsetenv(kNames[i]);
    }
    fs::create_directories(home_);
  }
  ~UserFolder() override {
    for (std::size_t i = 0; i < std::size(kNames); ++i) {
      before_[i] ? setenv(kNames[i], before_[i]->c_str(), 1) : unsetenv(kNames[i]);
    }
    fs::remove_all(home_);
  }
  UserFolder(const UserFolder&) = delete;
  UserFolder& operator=(const UserFolder&) = delete;

  static constexpr const char* kNames[]{"HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"};
  std::optional<std::string> before_[std::size(kNames)];
  fs::path home_ = fs::temp_directory_path() / ("haptolith-user-folder-test-" + std::to_string(getpid()));
};

TEST_F(UserFolder, LiesBelowAHomeThatExists) {
  setenv("HOME", home_.c_str(), 1);
  EXPECT_EQ(userCacheFolder(), home_ / ".cache/haptolith");
  EXPECT_EQ(userStateFolder(), home_ / ".local/state/haptolith");
  EXPECT_TRUE(fs::is_empty(home_)) << "nobody has asked for anything yet";
}

TEST_F(UserFolder, IsWhereTheEnvironmentSaysEvenIfItHasToBeMade) {
  setenv("HOME", home_.c_str(), 1);
  setenv("XDG_CACHE_HOME", "/nonexistent/caches", 1);
  setenv("XDG_STATE_HOME", "/nonexistent/states", 1);
  EXPECT_EQ(userCacheFolder(), "/nonexistent/caches/haptolith");
  EXPECT_EQ(userStateFolder(), "/nonexistent/states/haptolith");
}

TEST_F(UserFolder, IsNotBelowAPathThatIsNotAbsolute) {
  setenv("HOME", home_.c_str(), 1);
  setenv("XDG_CACHE_HOME", "caches", 1);
  setenv("XDG_STATE_HOME", "", 1);
  EXPECT_EQ(userCacheFolder(), home_ / ".cache/haptolith");
  EXPECT_EQ(userStateFolder(), home_ / ".local/state/haptolith");
}

TEST_F(UserFolder, IsNoneForWhoHasNoHome) {
  EXPECT_EQ(userCacheFolder(), "");
  for (const char* home : {"", "home", "/nonexistent", "/dev/null"}) {
    setenv("HOME", home, 1);
    EXPECT_EQ(userCacheFolder(), "") << home;
    EXPECT_EQ(userStateFolder(), "") << home;
  }
}

}  // namespace
}  // namespace haptolith
