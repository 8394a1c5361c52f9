#include <CLI/App.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "haptolith/core/files/atomic_file.h"

#include "commands.h"
#include "lab/lab_options.h"
#include "lab/specimens.h"
#include "shared/common_options.h"
#include "shared/output.h"
#include "shared/overwrite.h"

namespace haptolith {

namespace {

struct CollectOptions {
  std::vector<std::string> files;
  std::string out_file;
  Overwrite overwrite;
  bool json = false;
};

void saveRows(const OutputFile& file, const Collection& collection) {
  AtomicFile whole(file);
  whole.write(fmt::format("{}\n", fmt::join(collection.columns, ",")));
  for (const std::vector<double>& row : collection.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const char* comma = i > 0 ? "," : "";
      whole.write(std::isfinite(row[i]) ? fmt::format("{}{:.17g}", comma, row[i]) : comma);
    }
    whole.write("\n");
  }
  whole.commit();
}

void runCollect(const CollectOptions& options) {
  requireWritable({options.overwrite(options.out_file)});
  std::vector<Specimen> specimens;
  specimens.reserve(options.files.size());
  for (const std::string& file : options.files) {
    specimens.push_back(readSpecimen(file));
  }
  const Collection collection = collected(std::move(specimens));
  if (!options.out_file.empty()) {
    saveRows(options.overwrite(options.out_file), collection);
  }
  options.json ? printJson(collection.json) : printText(collection.text);
}

}  // namespace

void addCollect(CLI::App& lab) {
  auto options = std::make_shared<CollectOptions>();
  CLI::App* command =
      lab.add_subcommand("collect", "Combine specimens that were simulated one by one: mean and standard deviation");
  command->add_option("FILES", options->files, "Output of `haptolith lab TEST --seed N --json`, one file per seed")
      ->required();
  command->add_option("--out", options->out_file, "Write the numbers of each specimen, one row each (.csv)");
  options->overwrite.addTo(*command);
  addJson(*command, options->json);
  command->footer(
      "Example:\n  for i in 1 2 3; do haptolith lab shear --seed $i --json > shear-$i.json; done\n  haptolith lab "
      "collect shear-*.json   the files may come from several machines\n  haptolith lab shear --seeds 3        the "
      "same result on one machine");
  command->callback([options] { runCollect(*options); });
}

}  // namespace haptolith
