#pragma once

#include <functional>
#include <string_view>

namespace haptolith {

/// Kinds of names in files and on the command line. A key is written with its table: "soil.friction_model".
enum class NameKind { kWord, kKey, kScene, kProtocol, kLabTest, kTeleopCase };

/// Returns the present name for one from an earlier version, in any case of letters: the scene "icra2021" for "paper".
/// Other names are returned unchanged. Old names work for one minor version (CHANGELOG.md). Not for the tick.
[[nodiscard]] std::string_view currentName(NameKind kind, std::string_view name) noexcept;

/// As above; the change is reported.
[[nodiscard]] std::string_view currentNameReported(NameKind kind, std::string_view name);

/// Reports that a name of an earlier version was used, once for each `line`.
void reportFormerName(std::string_view line);

/// Sets what is called, once for each name of an earlier version that is used, with a line for the user.
void onFormerName(std::function<void(std::string_view)> report);

}  // namespace haptolith
