#include "haptolith/study/export/analysis_scripts.h"

#include <string>

namespace haptolith {

std::filesystem::path scriptBeside(const std::filesystem::path& table, const AnalysisScript& script) {
  return table.parent_path() / (table.stem().string() + "-" + std::string(script.name));
}

void writeAnalysisScripts(const std::filesystem::path& table, IfThere if_there) {
  for (const AnalysisScript& script : analysisScripts()) {
    requireFree({scriptBeside(table, script), if_there});
  }
  for (const AnalysisScript& script : analysisScripts()) {
    AtomicFile file({scriptBeside(table, script), if_there});
    file.write(script.text);
    file.commit();
  }
}

}  // namespace haptolith
