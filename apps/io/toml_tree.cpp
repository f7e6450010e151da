#include "apps/io/toml_tree.h"

#include <toml++/toml.h>  // slow to compile: included here and nowhere else

#include <algorithm>

#include "apps/io/input_file.h"

namespace grainlaw::io {
namespace {

// The parser recurses into what stands in brackets and the names between dots; this bounds its
// stack for any file, also a hostile one. Our own files have three levels.
constexpr std::ptrdiff_t most_nesting_characters = 5000;
constexpr int most_levels = 20;

struct TooDeep {
  Place place;
};

Place place_of(const toml::source_region& region, std::size_t width) {
  return {std::max<std::size_t>(region.begin.line, 1),
          std::max<std::size_t>(region.begin.column, 1),
          width};
}

TomlValue converted(const toml::node& node, int level);

TomlTable converted_table(const toml::table& table, int level) {
  TomlTable result;
  for (const auto& [key, node] : table) {
    result.entries.push_back({std::string(key.str()),
                              place_of(key.source(), key.str().size()),
                              converted(node, level + 1)});
  }
  return result;
}

std::vector<TomlValue> converted_array(const toml::array& array, int level) {
  std::vector<TomlValue> result;
  for (const toml::node& node : array) result.push_back(converted(node, level + 1));
  return result;
}

TomlValue converted(const toml::node& node, int level) {
  if (level > most_levels) throw TooDeep{place_of(node.source(), 1)};
  TomlValue result{place_of(node.source(), 1), {}};
  if (const auto* table = node.as_table()) {
    result.value = converted_table(*table, level);
  } else if (const auto* array = node.as_array()) {
    result.value = converted_array(*array, level);
  } else if (const auto* flag = node.as_boolean()) {
    result.value = flag->get();
  } else if (const auto* integer = node.as_integer()) {
    result.value = integer->get();
  } else if (const auto* number = node.as_floating_point()) {
    result.value = number->get();
  } else if (const auto* text = node.as_string()) {
    result.value = text->get();
  } else {
    result.value = TomlOther{"a date or time"};
  }
  return result;
}

void refuse_hostile_nesting(const std::string& text, const std::filesystem::path& path) {
  const auto nests = [](char c) { return c == '.' || c == '[' || c == '{'; };
  if (std::ranges::count_if(text, nests) <= most_nesting_characters) return;
  throw InputError(
      excerpt(path.string(), text, {}, "too many dots and brackets for an input file"));
}

}  // namespace

const TomlEntry* TomlTable::find(std::string_view key) const {
  const auto it = std::ranges::find(entries, key, &TomlEntry::key);
  return it == entries.end() ? nullptr : &*it;
}

std::string TomlValue::type() const {
  struct Name {
    std::string operator()(const TomlOther& other) const { return other.type; }
    std::string operator()(bool) const { return "true or false"; }
    std::string operator()(std::int64_t) const { return "an integer"; }
    std::string operator()(double) const { return "a number"; }
    std::string operator()(const std::string&) const { return "a text"; }
    std::string operator()(const std::vector<TomlValue>&) const { return "a list"; }
    std::string operator()(const TomlTable&) const { return "a section"; }
  };
  return std::visit(Name{}, value);
}

TomlValue parse_toml(const std::string& text, const std::filesystem::path& path) {
  refuse_hostile_nesting(text, path);
  try {
    return converted(toml::parse(text), 0);
  } catch (const toml::parse_error& error) {
    throw InputError(excerpt(
        path.string(), text, place_of(error.source(), 1), std::string(error.description())));
  } catch (const TooDeep& found) {
    throw InputError(excerpt(path.string(), text, found.place, "nested too deeply"));
  }
}

}  // namespace grainlaw::io
