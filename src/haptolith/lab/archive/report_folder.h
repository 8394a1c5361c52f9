#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "haptolith/core/process/child_process.h"

namespace haptolith {

/// What becomes of a report that is in the folder already: the user has to say.
enum class ReportThere { kRefuse, kResume, kReplace };

/// Where a report of the laboratory and all that it is made of lie: conditions.json, results/NAME.json for each test
/// that is done, results/NAME.png, and report.html or other pages. One process at a time works in it.
class ReportFolder {
 public:
  /// Makes the folder, opens the one that is there, or empties it of the report in it. With kResume and kReplace there
  /// need not be one.
  /// @param pages  files beside those, made of them; the first is page().
  /// @param conditions  what all results depend on: those of a report that is resumed have to be the same.
  /// @throws Failure when there is such a folder with kRefuse; when it holds other things, or a report made under other
  /// conditions (says which); when another process works in it; when it cannot be made.
  ReportFolder(const std::filesystem::path& path, const nlohmann::ordered_json& conditions, ReportThere if_there,
               std::vector<std::string> pages = {"report.html"});

  /// What was saved under this name; none: nothing yet. @throws Failure when it cannot be read.
  [[nodiscard]] std::optional<nlohmann::ordered_json> result(const std::string& name) const;

  /// Saves a result, whole or not at all, on the disk when this returns. @throws Failure as AtomicFile.
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
  Descriptor locked_;
};

}  // namespace haptolith
