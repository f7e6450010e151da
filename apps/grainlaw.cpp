// Front end: `grainlaw VERB ...` becomes `grainlaw-VERB ...`, as git does.
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
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
    Verb{"dem", "run one DEM scene, write local data    SCENE.toml [-o RUN.h5]"},
    Verb{"calibrate", "run a campaign, fit laws, report       CAMPAIGN.toml [-o DIR]"},
    Verb{"predict", "predict a flow from a table            CASE.toml -t TABLE.toml"},
    Verb{"compare", "compare runs with predictions, report  RUN.h5... -t TABLE.toml"},
    Verb{"study", "set errors against run time            STUDY.toml [-o DIR]"},
};

std::string help() {
  std::string text = fmt::format(
      "grainlaw {}: from grain properties to flow predictions\n\nUsage: grainlaw VERB ...\n\n",
      GRAINLAW_VERSION);
  for (const Verb& verb : verbs) text += fmt::format("  {:<10} {}\n", verb.name, verb.purpose);
  return text + "\n`grainlaw VERB --help` tells more, with an example.\n";
}

int fail(const std::string& message) {
  std::fputs(message.c_str(), stderr);
  return static_cast<int>(grainlaw::ExitCode::bad_input);
}

int answer(const std::string& text) {
  const bool written = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  return static_cast<int>(written ? grainlaw::ExitCode::answered : grainlaw::ExitCode::resource);
}

std::filesystem::path own_folder() {
  std::error_code none;
  return std::filesystem::read_symlink("/proc/self/exe", none).parent_path();
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view verb = argc > 1 ? argv[1] : "";
  if (verb == "--help" || verb == "-h" || verb == "help") {
    return answer(help());
  }
  if (verb == "--version") {
    return answer(GRAINLAW_VERSION "\n");
  }
  for (const Verb& known : verbs) {
    if (verb != known.name) continue;
    const std::string program = "grainlaw-" + std::string(verb);
    const std::string beside = own_folder() / program;
    argv[1] = argv[0];
    execv(beside.c_str(), argv + 1);
    execvp(program.c_str(), argv + 1);
    return fail(fmt::format("grainlaw: cannot start {}: {}\n", beside, std::strerror(errno)));
  }
  return fail((verb.empty() ? "" : fmt::format("grainlaw: unknown verb '{}'\n\n", verb)) + help());
}
