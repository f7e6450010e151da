#include "apps/command_line.h"

#include <CLI/CLI.hpp>
#include <thread>

namespace grainlaw {

struct CommandLine::Parser {
  CLI::App app;
  CommonOptions& common;
};

CommandLine::CommandLine(const std::string& program,
                         const std::string& description,
                         const std::string& example,
                         CommonOptions& common)
    : parser_(new Parser{CLI::App(description, program), common}) {
  CLI::App& app = parser_->app;
  app.footer("Example:\n" + example +
             "\n\nExit codes: 0 answered, 1 bad input, 2 no steady state or refused step,\n"
             "            3 disk or memory, 4 stopped");
  app.set_version_flag("--version", GRAINLAW_VERSION);
  app.add_flag("--check", common.check, "say what would run; run nothing");
  app.add_flag("--json", common.json, "summary as one JSON object on stdout");
  app.add_flag("--quiet", common.quiet, "no progress and no summary");
  app.add_option("--threads", common.threads, "runs of a campaign at once (default: cores)")
      ->check(CLI::Range(1, 1024));
}

CommandLine::~CommandLine() = default;

void CommandLine::required(const std::string& name, std::string& target, const std::string& help) {
  parser_->app.add_option(name, target, help)->required();
}

void CommandLine::list(const std::string& name,
                       std::vector<std::string>& target,
                       const std::string& help) {
  parser_->app.add_option(name, target, help)->required();
}

void CommandLine::flag(const std::string& name, bool& target, const std::string& help) {
  parser_->app.add_flag(name, target, help);
}

void CommandLine::option(const std::string& name,
                         std::string& target,
                         const std::string& help,
                         bool is_required) {
  parser_->app.add_option(name, target, help)->required(is_required);
}

void CommandLine::option_list(const std::string& name,
                              std::vector<std::string>& target,
                              const std::string& help) {
  parser_->app.add_option(name, target, help);
}

std::optional<int> CommandLine::parse(int argc, char** argv) {
  try {
    parser_->app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return parser_->app.exit(error) == 0 ? static_cast<int>(ExitCode::answered)
                                         : static_cast<int>(ExitCode::bad_input);
  }
  if (parser_->common.threads == 0) {
    parser_->common.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }
  return std::nullopt;
}

}  // namespace grainlaw
