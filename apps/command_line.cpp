#include "apps/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <thread>

#include "apps/program.h"

namespace grainlaw {
namespace {

struct DurationUnit {
  std::string_view name;
  double seconds;
};
std::string not_empty(const std::string& text) {
  return text.empty() ? "an empty text is given" : "";
}

constexpr DurationUnit duration_units[] = {{"", 1.0}, {"s", 1.0}, {"min", 60.0}, {"h", 3600.0}};

}  // namespace

std::optional<double> duration_seconds(std::string_view text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || !std::isfinite(value) || value <= 0.0) return std::nullopt;
  const std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  for (const auto& [name, seconds] : duration_units) {
    if (unit == name) return value * seconds;
  }
  return std::nullopt;
}

struct CommandLine::Parser {
  std::string verb;
  CLI::App app;
  CommonOptions common{};
};

CommandLine::CommandLine(const std::string& verb,
                         const std::string& description,
                         const std::string& example)
    : parser_(new Parser{verb, CLI::App(description, "grainlaw-" + verb)}) {
  CLI::App& app = parser_->app;
  CommonOptions& common = parser_->common;
  app.footer("Example:\n" + example +
             "\n\nExit codes: 0 answered, 1 bad input, 2 no steady state or refused,\n"
             "            3 disk or memory, 4 stopped");
  app.set_version_flag("--version", GRAINLAW_VERSION);
  app.add_flag("--check", common.check, "say what would run; run nothing");
  app.add_flag("--json", common.json, "summary as one JSON object on stdout");
  app.add_flag("--quiet", common.quiet, "no progress and no summary");
  app.add_option("--threads", common.threads, "threads (default: as many as there are cores)")
      ->check(CLI::Range(1, 1024));
}

CommandLine::~CommandLine() = default;

void CommandLine::required(const std::string& name, std::string& target, const std::string& help) {
  parser_->app.add_option(name, target, help)->required()->check(not_empty);
}

void CommandLine::list(const std::string& name,
                       std::vector<std::string>& target,
                       const std::string& help) {
  parser_->app.add_option(name, target, help)->required()->check(not_empty);
}

void CommandLine::flag(const std::string& name, bool& target, const std::string& help) {
  parser_->app.add_flag(name, target, help);
}

void CommandLine::option(const std::string& name,
                         std::string& target,
                         const std::string& help,
                         bool is_required) {
  parser_->app.add_option(name, target, help)->required(is_required)->check(not_empty);
}

void CommandLine::option_list(const std::string& name,
                              std::vector<std::string>& target,
                              const std::string& help,
                              bool is_required) {
  parser_->app.add_option(name, target, help)->required(is_required)->check(not_empty);
}

void CommandLine::number(const std::string& name,
                         std::optional<double>& target,
                         const std::string& help) {
  const auto read = [name, &target](const std::string& text) {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || rest != end || !std::isfinite(value) || value <= 0.0)
      throw CLI::ValidationError(name, "'" + text + "' is no number above 0");
    target = value;
  };
  parser_->app.add_option_function<std::string>(name, read, help)->type_name("FLOAT");
}

void CommandLine::duration(const std::string& name, double& seconds, const std::string& help) {
  const auto read = [name, &seconds](const std::string& text) {
    const std::optional<double> value = duration_seconds(text);
    if (!value) {
      throw CLI::ValidationError(
          name, "'" + text + "' is no duration above 0: 90s, 10min, 2h or a number of seconds");
    }
    seconds = *value;
  };
  parser_->app.add_option_function<std::string>(name, read, help)->type_name("DURATION");
}

void CommandLine::threads(const std::string& help, int otherwise) {
  parser_->app.get_option("--threads")->description(help);
  parser_->common.threads = otherwise;
}

int CommandLine::run(int argc,
                     char** argv,
                     const std::function<ExitCode(const CommonOptions&)>& body) {
  try {
    parser_->app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return parser_->app.exit(error) == 0 ? static_cast<int>(ExitCode::answered)
                                         : static_cast<int>(ExitCode::bad_input);
  }
  CommonOptions& common = parser_->common;
  if (common.threads == 0) {
    common.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  }
  return run_program("grainlaw " + parser_->verb, [&] { return body(common); });
}

}  // namespace grainlaw
