#include "apps/io/input_state.h"

#include <fmt/format.h>

#include <algorithm>

namespace grainlaw::io {

std::string title(std::string_view section) {
  return section.empty() ? "at the top level" : fmt::format("in [{}]", section);
}

std::string did_you_mean(std::string_view guess) {
  return fmt::format("; did you mean {}?", guess);
}

const TomlTable* InputState::table(std::string_view section) const {
  const TomlTable* table = &root;
  while (table != nullptr && !section.empty()) {
    const std::size_t dot = std::min(section.find('.'), section.size());
    const TomlEntry* inner = table->find(section.substr(0, dot));
    table = inner == nullptr ? nullptr : inner->value.table();
    section.remove_prefix(std::min(dot + 1, section.size()));
  }
  return table;
}

const TomlEntry* InputState::find(std::string_view section, std::string_view key) const {
  const TomlTable* found = table(section);
  return found == nullptr ? nullptr : found->find(key);
}

Place InputState::place(std::string_view section, std::string_view key) const {
  if (const TomlEntry* found = find(section, key)) return found->place;
  if (section.empty() || table(section) == nullptr) return {};
  const std::size_t dot = section.rfind('.');
  const bool nested = dot != std::string_view::npos;
  return find(nested ? section.substr(0, dot) : "", nested ? section.substr(dot + 1) : section)
      ->place;
}

SectionEntry& InputState::entry(std::string_view section, std::string_view variant) {
  const auto it = std::ranges::find_if(asked, [&](const SectionEntry& known) {
    return known.name == section && known.variant == variant;
  });
  if (it != asked.end()) return *it;
  return asked.emplace_back(SectionEntry{
      .name = std::string(section), .variant = std::string(variant), .meaning = {}, .keys = {}});
}

std::vector<std::string> InputState::known_keys(std::string_view section) const {
  std::vector<std::string> names;
  const auto it = std::ranges::find(asked, section, &SectionEntry::name);
  if (it == asked.end()) return names;
  for (const KeyEntry& key : it->keys) names.push_back(key.name);
  return names;
}

std::vector<std::string> InputState::known_sections() const {
  std::vector<std::string> names;
  for (const SectionEntry& section : asked) {
    if (!section.name.empty()) names.push_back(section.name);
  }
  return names;
}

/// A misspelt key is not missing: one message is enough.
void InputState::withdraw_missing(std::string_view section, const std::string& name) {
  std::erase_if(problems, [&](const Problem& problem) {
    return problem.section == section && std::ranges::count(problem.missing, name) > 0;
  });
}

/// A known key in the wrong section: TOML keys belong to the section above them.
std::string InputState::home_of(std::string_view key) const {
  const auto has_key = [&](const SectionEntry& section) {
    return std::ranges::count(section.keys, key, &KeyEntry::name) > 0;
  };
  const auto home = std::ranges::find_if(asked, has_key);
  if (home == asked.end()) return "";
  return home->name.empty() ? "; it belongs to the top level, before the first section"
                            : fmt::format("; it belongs to [{}]", home->name);
}

void InputState::report_unknown(const TomlEntry& found, const std::string& section) {
  const std::vector<std::string> known = known_keys(section);
  const std::string guess = nearest(found.key, known);
  if (!guess.empty()) withdraw_missing(section, guess);
  problems.push_back(
      {found.place,
       fmt::format("unknown key '{}' {}{}",
                   found.key,
                   title(section),
                   guess.empty() ? home_of(found.key) : did_you_mean("'" + guess + "'")),
       fmt::format("known here: {}", joined(known, ", ")),
       section,
       {}});
}

void InputState::report_unknown_section(const TomlEntry& found, const std::string& name) {
  const std::vector<std::string> known = known_sections();
  const std::string guess = nearest(name, known);
  if (!guess.empty()) withdraw_missing("", guess);
  problems.push_back(
      {found.place,
       fmt::format(
           "unknown section [{}]{}", name, guess.empty() ? "" : did_you_mean("[" + guess + "]")),
       fmt::format("known: {}", joined(known, ", ")),
       name,
       {}});
}

void InputState::find_unknown(const TomlTable& in, const std::string& section) {
  const std::vector<std::string> keys = known_keys(section);
  const std::vector<std::string> sections = known_sections();
  for (const TomlEntry& found : in.entries) {
    if (std::ranges::count(keys, found.key) > 0 || problems.size() > problems_shown) continue;
    const std::string name = section.empty() ? found.key : section + "." + found.key;
    const bool known = std::ranges::any_of(sections, [&](const std::string& other) {
      return other == name || other.starts_with(name + ".");
    });
    if (known && found.value.table() != nullptr) {
      find_unknown(*found.value.table(), name);
    } else if (known) {
      withdraw_missing("", name);
      problems.push_back({found.place,
                          fmt::format("[{}] must be a section, found {}", name, found.value.type()),
                          {},
                          {},
                          {}});
    } else if (found.value.table() != nullptr) {
      report_unknown_section(found, name);
    } else {
      report_unknown(found, section);
    }
  }
}

}  // namespace grainlaw::io
