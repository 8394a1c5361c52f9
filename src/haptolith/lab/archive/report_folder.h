#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/core/platform/locks.h"

namespace haptolith {

/// Treatment of a report that already exists in the folder; the user has to choose.
enum class ReportThere { kRefuse, kResume, kReplace };

/// Folder of a laboratory report: conditions.json, results/NAME.json for each finished test, results/NAME.png, and
/// report.html or other pages. One process at a time works in it.
class ReportFolder {
 public:
  /// Creates the folder, opens the existing one, or removes the report in it. With kResume and kReplace the folder need
  /// not exist.
  /// @param pages  further files, made from the results; the first is page().
  /// @param conditions  conditions of all results; those of a resumed report have to be equal.
  /// @throws Failure when the folder exists with kRefuse; when it holds other files, or a report made under other
  /// conditions (lists them); when another process works in it; when it cannot be created.
  ReportFolder(const std::filesystem::path& path, const nlohmann::ordered_json& conditions, ReportThere if_there,
               std::vector<std::string> pages = {"report.html"});

  /// Returns the result saved under this name, if there is one. @throws Failure when it cannot be read.
  [[nodiscard]] std::optional<nlohmann::ordered_json> result(const std::string& name) const;

  /// Saves a result atomically; it is on the disk on return. @throws Failure as AtomicFile.
  void save(const std::string& name, const nlohmann::ordered_json& result) const;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::filesystem::path page() const { return path_ / pages_.front(); }
  [[nodiscard]] std::filesystem::path resultFile(const std::string& name) const;
  [[nodiscard]] std::filesystem::path figure(const std::string& name) const;

 private:
  void lock();
  void removeReport() const;

  std::filesystem::path path_;
  std::vector<std::string> pages_;
  FolderLock locked_;
};

}  // namespace haptolith
