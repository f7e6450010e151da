#include "apps/io/input_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace grainlaw::io {

namespace {

/// Takes the first word off "contact.normal".
std::string_view take_word(std::string_view& section) {
  const std::size_t dot = std::min(section.find('.'), section.size());
  const std::string_view word = section.substr(0, dot);
  section.remove_prefix(std::min(dot + 1, section.size()));
  return word;
}

/// The element of a list that "1", "2", ... names.
const TomlValue* element(const std::vector<TomlValue>& list, std::string_view number) {
  std::size_t k = 0;
  std::from_chars(number.data(), number.data() + number.size(), k);
  return k >= 1 && k <= list.size() ? &list[k - 1] : nullptr;
}

/// What stands under a section; of "shear_boxes.2" the second [[shear_boxes]].
const TomlValue* find_value(const TomlTable& root, std::string_view section) {
  const TomlTable* table = &root;
  const TomlValue* value = nullptr;
  while (table != nullptr && !section.empty()) {
    const TomlEntry* inner = table->find(take_word(section));
    if (inner == nullptr) return nullptr;
    value = &inner->value;
    const auto* list = std::get_if<std::vector<TomlValue>>(&value->value);
    if (list != nullptr && !section.empty()) value = element(*list, take_word(section));
    if (value == nullptr) return nullptr;
    table = value->table();
  }
  return section.empty() ? value : nullptr;
}

}  // namespace

std::string title(std::string_view section) {
  if (section.empty()) return "at the top level";
  const std::size_t dot = section.rfind('.');
  if (dot == std::string_view::npos || section[dot + 1] < '0' || section[dot + 1] > '9') {
    return fmt::format("in [{}]", section);
  }
  return fmt::format("in [[{}]] number {}", section.substr(0, dot), section.substr(dot + 1));
}

std::string did_you_mean(std::string_view guess) {
  return fmt::format("; did you mean {}?", guess);
}

const TomlTable* InputState::table(std::string_view section) const {
  if (section.empty()) return &root;
  const TomlValue* value = find_value(root, section);
  return value == nullptr ? nullptr : value->table();
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
  const TomlEntry* home =
      find(nested ? section.substr(0, dot) : "", nested ? section.substr(dot + 1) : section);
  return home != nullptr ? home->place : find_value(root, section)->place;  // of a list: no key
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

void InputState::report_no_section(const TomlValue& found, Place at, const std::string& name) {
  problems.push_back(
      {at, fmt::format("[{}] must be a section, found {}", name, found.type()), {}, {}, {}});
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
    const auto* list = std::get_if<std::vector<TomlValue>>(&found.value.value);
    const bool numbered = list != nullptr && std::ranges::count(sections, name + ".1") > 0;
    if (known && found.value.table() != nullptr) {
      find_unknown(*found.value.table(), name);
    } else if (numbered) {
      for (std::size_t k = 0; k < list->size(); ++k) {
        const std::string numbered_name = fmt::format("{}.{}", name, k + 1);
        const TomlTable* one = (*list)[k].table();
        if (one != nullptr) find_unknown(*one, numbered_name);
        if (one == nullptr) report_no_section((*list)[k], (*list)[k].place, numbered_name);
      }
    } else if (known) {
      withdraw_missing("", name);
      report_no_section(found.value, found.place, name);
    } else if (found.value.table() != nullptr) {
      report_unknown_section(found, name);
    } else {
      report_unknown(found, section);
    }
  }
}

}  // namespace grainlaw::io
