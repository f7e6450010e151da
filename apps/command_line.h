#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/exit_code.h"

namespace grainlaw {

/// Options that every program has.
struct CommonOptions {
  bool check = false;  ///< validate the input, say what would be done, run nothing
  bool json = false;   ///< summary as one JSON object on stdout
  bool quiet = false;  ///< no progress, no summary; errors still go to stderr
  int threads = 0;     ///< 0 before the command line is read: as many as the machine has
};

/// Seconds of "90s", "10min", "2h" or a plain number of seconds; absent when the text is something
/// else or not above 0.
std::optional<double> duration_seconds(std::string_view text);

/// The command line of `grainlaw VERB`.
class CommandLine {
 public:
  CommandLine(const std::string& verb, const std::string& description, const std::string& example);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  void required(const std::string& name, std::string& target, const std::string& help);
  void list(const std::string& name, std::vector<std::string>& target, const std::string& help);
  void flag(const std::string& name, bool& target, const std::string& help);
  void option(const std::string& name,
              std::string& target,
              const std::string& help,
              bool is_required = false);
  void option_list(const std::string& name,
                   std::vector<std::string>& target,
                   const std::string& help,
                   bool is_required = false);
  /// A number above 0; absent where the option is not given.
  void number(const std::string& name, std::optional<double>& target, const std::string& help);

  /// A duration above 0, given as "90s", "10min", "2h" or a number of seconds [s].
  void duration(const std::string& name, double& seconds, const std::string& help);
  /// What --threads means here and how many they are unless said otherwise.
  void threads(const std::string& help, int otherwise);

  /// Reads the arguments and runs the body under run_program; not where help was asked for or the
  /// usage is wrong. Returns the exit code.
  int run(int argc, char** argv, const std::function<ExitCode(const CommonOptions&)>& body);

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace grainlaw
