// Front end: `grainlaw VERB ...` becomes `grainlaw-VERB ...`, as git does.
#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "apps/exit_code.h"

namespace {

struct Verb {
  std::string_view name;
  std::string_view purpose;
};
constexpr std::array verbs{
    Verb{"dem", "run one DEM scene, write local data         SCENE.toml [-o RUN.h5]"},
    Verb{"calibrate", "run a campaign, fit the laws, report        CAMPAIGN.toml [-o DIR]"},
    Verb{"predict", "predict a flow from a fitted table          CASE.toml --table TABLE.toml"},
    Verb{"compare", "compare DEM runs with predictions, report   RUN.h5... --table TABLE.toml"},
};

void print_help(FILE* out) {
  fmt::print(
      out,
      "grainlaw {}: from grain properties to flow predictions\n\nUsage: grainlaw VERB ...\n\n",
      GRAINLAW_VERSION);
  for (const Verb& verb : verbs) fmt::print(out, "  {:<10} {}\n", verb.name, verb.purpose);
  fmt::print(out, "\n`grainlaw VERB --help` tells more, with an example.\n");
}

std::filesystem::path own_folder() {
  std::error_code none;
  return std::filesystem::read_symlink("/proc/self/exe", none).parent_path();
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view verb = argc > 1 ? argv[1] : "";
  if (verb == "--help" || verb == "-h" || verb == "help") {
    print_help(stdout);
    return 0;
  }
  if (verb == "--version") {
    fmt::print("{}\n", GRAINLAW_VERSION);
    return 0;
  }
  for (const Verb& known : verbs) {
    if (verb != known.name) continue;
    const std::string program = "grainlaw-" + std::string(verb);
    const std::string beside = own_folder() / program;
    argv[1] = argv[0];
    execv(beside.c_str(), argv + 1);
    execvp(program.c_str(), argv + 1);
    fmt::print(stderr, "grainlaw: cannot start {}: {}\n", beside, std::strerror(errno));
    return static_cast<int>(grainlaw::ExitCode::bad_input);
  }
  if (!verb.empty()) fmt::print(stderr, "grainlaw: unknown verb '{}'\n\n", verb);
  print_help(stderr);
  return static_cast<int>(grainlaw::ExitCode::bad_input);
}
