#include "apps/imported_runs.h"

#include <fmt/format.h>

#include <set>

#include "apps/program.h"

namespace grainlaw {

void add_checks(Summary& summary, const io::RunRecord& record) {
  const std::string& run = record.data.name;
  summary.add(run + "_from", run + ", from", record.imported_from);
  for (const io::ImportCheck& check : record.checks) {
    summary.add(run + "_" + check.name,
                "  " + check.name,
                fmt::format("{}: {}", name(check.outcome), check.text));
  }
}

std::vector<std::string> failed_checks(const std::vector<io::RunRecord>& imported) {
  std::vector<std::string> failed;
  for (const io::RunRecord& record : imported) {
    for (const io::ImportCheck& check : record.checks) {
      if (check.outcome != io::CheckOutcome::failed) continue;
      failed.push_back(
          fmt::format("{}: check of the {} failed: {}", record.data.name, check.name, check.text));
    }
  }
  return failed;
}

void store_imported(const std::vector<io::RunRecord>& imported,
                    const std::filesystem::path& folder,
                    const std::vector<std::string>& inputs) {
  if (imported.empty()) return;
  std::filesystem::create_directories(folder);
  std::set<std::string> names;
  for (const io::RunRecord& record : imported) {
    const std::string& run = record.data.name;
    if (run.find('/') != std::string::npos || !names.insert(run).second) {
      throw io::InputError(fmt::format(
          "imported run '{}': its name has to be that of a file, and of no other run", run));
    }
    const std::filesystem::path path = folder / (run + ".h5");
    refuse_overwriting_input(path.string(), inputs);
    io::write_imported_data(record, path);
  }
}

}  // namespace grainlaw
