#include "apps/io/input_key.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace grainlaw::io {

bool Bounds::contain(double value) const {
  const bool above = lower_allowed ? value >= lower : value > lower;
  const bool below = upper_allowed ? value <= upper : value < upper;
  return above && below;
}

std::string Bounds::text(std::string_view name) const {
  std::string out(name);
  const std::string space = unit.empty() ? "" : " ";
  if (std::isfinite(lower)) {
    out = fmt::format("{}{}{} {} {}", lower, space, unit, lower_allowed ? "<=" : "<", out);
  }
  if (std::isfinite(upper)) {
    out += fmt::format(" {} {}{}{}", upper_allowed ? "<=" : "<", upper, space, unit);
  }
  return out == name ? "" : out;
}

std::string joined(const std::vector<std::string>& words, std::string_view separator) {
  std::string out;
  for (const std::string& word : words) {
    if (&word != &words.front()) out += separator;
    out += word;
  }
  return out;
}

namespace {

std::string_view first_word(const SectionEntry& section) {
  return std::string_view(section.name).substr(0, section.name.find('.'));
}

/// Sections of one first word behind each other, "contact.normal" before "contact.friction".
std::vector<SectionEntry> grouped(const std::vector<SectionEntry>& sections) {
  std::vector<SectionEntry> out;
  for (const SectionEntry& section : sections) {
    const auto last = std::ranges::find(out.rbegin(), out.rend(), first_word(section), first_word);
    out.insert(last == out.rend() ? out.end() : last.base(), section);
  }
  return out;
}

}  // namespace

std::string markdown(const std::vector<SectionEntry>& sections) {
  std::string out;
  for (const SectionEntry& section : grouped(sections)) {
    std::string title = section.name.empty() ? "Top level" : "`[" + section.name + "]`";
    if (!section.variant.empty()) title += " with `" + section.variant + "`";
    out += fmt::format("### {}\n\n", title);
    if (!section.meaning.empty()) {
      out += fmt::format("{}{}.\n\n", section.meaning, section.required ? "" : " (optional)");
    }
    out += "| key | type | unit | range | if missing | meaning |\n|---|---|---|---|---|---|\n";
    for (const KeyEntry& key : section.keys) {
      out += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n",
                         key.name,
                         key.type,
                         key.unit,
                         key.range,
                         key.missing,
                         key.meaning);
    }
    out += "\n";
  }
  return out;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> previous(b.size() + 1);
  std::iota(previous.begin(), previous.end(), 0);
  std::vector<std::size_t> current(b.size() + 1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    current[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = previous[j] + (a[i] == b[j] ? 0 : 1);
      current[j + 1] = std::min({replaced, previous[j + 1] + 1, current[j] + 1});
    }
    std::swap(previous, current);
  }
  return previous.back();
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t least = 1 + std::max<std::size_t>(1, word.size() / 3);  // more is another word
  if (word.size() > 64) return best;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace grainlaw::io
