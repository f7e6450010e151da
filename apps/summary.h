#pragma once

#include <string>
#include <variant>
#include <vector>

#include "apps/command_line.h"
#include "dem/estimate_text.h"

namespace grainlaw {

/// How far an error can be trusted.
struct Trust {
  double half_width_95 = 0.0;  ///< of the 95 % interval about the value
  std::string convergence{};   ///< in a word; empty: nothing is said
};

/// What a program says at the end: the same entries as lines for people and as JSON for programs.
class Summary {
 public:
  using Value = std::variant<double, long, bool, std::string, std::vector<std::string>>;

  /// `key` is the JSON name, `label` what a person reads; unit may be empty.
  void add(const std::string& key,
           const std::string& label,
           Value value,
           const std::string& unit = {});
  /// Begins a group of lines; JSON has no groups.
  void heading(const std::string& title);
  /// Value and standard error; JSON gets {"value": , "error": } and, where it is said, the trust.
  void add_estimate(const std::string& key,
                    const std::string& label,
                    double value,
                    double error,
                    const std::string& unit = {},
                    const Trust& trust = {});

  std::string text() const;  ///< aligned lines, at most 80 columns where words allow
  std::string json() const;

 private:
  struct Entry {
    std::string key, label, unit;
    Value value;
    bool has_error = false;
    double error = 0.0;
    Trust trust{};
  };
  std::vector<Entry> entries_;
};

/// The summary on stdout, as text or JSON; nothing when quiet text was asked.
void print(const Summary& summary, const CommonOptions& options);

}  // namespace grainlaw
