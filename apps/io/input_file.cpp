#include "apps/io/input_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/io/input_state.h"
#include "apps/io/safe_write.h"

namespace grainlaw::io {
namespace {

constexpr std::size_t largest_text = std::size_t{64} << 20;  // bytes; real inputs have a few kB

/// The signature of HDF5 stands at 0, or after a user block of 512 bytes (our runs) or a doubling
/// of it.
bool is_hdf5(std::string_view bytes) {
  for (std::size_t at = 0; at < bytes.size(); at = at == 0 ? 512 : 2 * at) {
    if (bytes.substr(at).starts_with("\x89HDF\r\n\x1a\n")) return true;
  }
  return false;
}

/// Takes a run, picture or archive for what it is before a parser complains about its first byte.
void refuse_binary(std::string_view bytes, const std::filesystem::path& path) {
  const auto refuse = [&](std::string_view what) {
    throw ReadError(
        fmt::format("{}:1:1: error: this is {}; a TOML file is expected", path.string(), what));
  };
  if (is_hdf5(bytes)) refuse("an HDF5 file, e.g. a run");
  if (bytes.find('\0') != std::string_view::npos) refuse("a binary file");
}

std::string unit_text(const Key& key) {
  return key.unit.text.empty() ? "" : fmt::format(" [{}]", key.unit.text);
}

/// A value of the file and the key it was found for.
struct Found {
  InputState& state;
  const std::string& section;
  const Key& key;

  template <class T>
  std::optional<T> wrong_type(const TomlValue& value, std::string_view wanted) const {
    problem(value, fmt::format("'{}' must be {}, found {}", key.name, wanted, value.type()));
    return std::nullopt;
  }
  bool in_range(const TomlValue& at, double value) const {
    const double compared = key.bounds.unit.empty() ? value : value / key.unit.size;
    if (!std::isnan(value) && key.bounds.contain(compared)) return true;
    const std::string range = key.bounds.text(key.name);
    problem(at,
            fmt::format("{} = {} is out of range: {}{}",
                        key.name,
                        value,
                        range.empty() ? "it has to be finite" : range,
                        unit_text(key)));
    return false;
  }
  void problem(const TomlValue& at, std::string text) const {
    state.problems.push_back({at.place, std::move(text), std::string(key.meaning), section, {}});
    state.refused.emplace(section, key.name);
  }
};

std::optional<double> convert(const Found& found, const TomlValue& from, double*) {
  const auto* number = std::get_if<double>(&from.value);
  const auto* integer = std::get_if<std::int64_t>(&from.value);
  if (number == nullptr && integer == nullptr) return found.wrong_type<double>(from, "a number");
  const double value = number != nullptr ? *number : static_cast<double>(*integer);
  if (!found.in_range(from, value)) return std::nullopt;
  return value / found.key.unit.size;
}

std::optional<std::int64_t> convert(const Found& found, const TomlValue& from, std::int64_t*) {
  const auto* value = std::get_if<std::int64_t>(&from.value);
  if (value == nullptr) return found.wrong_type<std::int64_t>(from, "an integer");
  if (!found.in_range(from, static_cast<double>(*value))) return std::nullopt;
  return *value;
}

std::optional<bool> convert(const Found& found, const TomlValue& from, bool*) {
  const auto* value = std::get_if<bool>(&from.value);
  return value != nullptr ? std::optional(*value) : found.wrong_type<bool>(from, "true or false");
}

std::optional<std::string> convert(const Found& found, const TomlValue& from, std::string*) {
  const auto* value = std::get_if<std::string>(&from.value);
  return value != nullptr ? std::optional(*value)
                          : found.wrong_type<std::string>(from, "a text in quotes");
}

template <class T>
std::optional<std::vector<T>> convert(const Found& found, const TomlValue& from, std::vector<T>*) {
  const auto* list = std::get_if<std::vector<TomlValue>>(&from.value);
  if (list == nullptr) return found.wrong_type<std::vector<T>>(from, "a list in brackets");
  std::vector<T> values;
  for (const TomlValue& element : *list) {
    const std::optional<T> value = convert(found, element, static_cast<T*>(nullptr));
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

std::string type_name(double*) {
  return "number";
}
std::string type_name(std::int64_t*) {
  return "integer";
}
std::string type_name(bool*) {
  return "true or false";
}
std::string type_name(std::string*) {
  return "text";
}
std::string type_name(std::vector<double>*) {
  return "list of numbers";
}
std::string type_name(std::vector<std::int64_t>*) {
  return "list of integers";
}
std::string type_name(std::vector<std::string>*) {
  return "list of texts";
}
std::string type_name(NumberRows*) {
  return "list of rows of numbers";
}

}  // namespace

bool Section::given() const {
  return state_->listing || state_->table(name_) != nullptr;
}
bool Section::has(std::string_view key) const {
  return state_->find(name_, key) != nullptr;
}
bool Section::applies(bool condition) const {
  return state_->listing || condition;
}

SectionEntry& Section::entry() const {
  return state_->entry(name_, variant_);
}
Section Section::when(std::string_view key, std::string_view word, std::string_view meaning) const {
  Section section = *this;
  if (!state_->listing) return section;
  section.variant_ = fmt::format("{} = \"{}\"", key, word);
  section.entry().meaning = meaning;
  section.entry().required = true;
  return section;
}

/// Notes that the key exists and converts its value, if it is there.
template <class T>
std::optional<T> Section::ask(const Key& key, std::string_view missing) {
  T* const type = nullptr;
  auto& keys = entry().keys;
  if (std::ranges::find(keys, key.name, &KeyEntry::name) == keys.end()) {
    keys.push_back({std::string(key.name),
                    type_name(type),
                    key.unit.text,
                    key.bounds.text("x"),
                    std::string(missing),
                    std::string(key.meaning)});
  }
  const TomlEntry* found = state_->find(name_, key.name);
  if (found == nullptr) return std::nullopt;
  return convert(Found{*state_, name_, key}, found->value, type);
}
template std::optional<double> Section::ask(const Key&, std::string_view);
template std::optional<std::int64_t> Section::ask(const Key&, std::string_view);
template std::optional<bool> Section::ask(const Key&, std::string_view);
template std::optional<std::string> Section::ask(const Key&, std::string_view);
template std::optional<std::vector<double>> Section::ask(const Key&, std::string_view);
template std::optional<std::vector<std::int64_t>> Section::ask(const Key&, std::string_view);
template std::optional<std::vector<std::string>> Section::ask(const Key&, std::string_view);
template std::optional<NumberRows> Section::ask(const Key&, std::string_view);

void Section::report_missing(const Key& key) {
  // A missing section is one problem, and a wrong value has been reported already.
  if (state_->listing || !given() || has(key.name)) return;
  state_->problems.push_back({state_->place(name_, key.name),
                              fmt::format("missing key '{}' {}", key.name, title(name_)),
                              fmt::format("{}{}: {}", key.name, unit_text(key), key.meaning),
                              name_,
                              {std::string(key.name)}});
}

std::string Section::default_text(double value, std::string_view note) {
  return fmt::format("{}{}{}", value, note.empty() ? "" : " ", note);
}
std::string Section::default_text(std::int64_t value, std::string_view note) {
  return fmt::format("{}{}{}", value, note.empty() ? "" : " ", note);
}
std::string Section::default_text(bool value, std::string_view) {
  return value ? "true" : "false";
}
std::string Section::default_text(const std::string& value, std::string_view note) {
  return value.empty() ? std::string(note.empty() ? "empty" : note) : "\"" + value + "\"";
}

std::string Section::choice(const Key& key,
                            const std::vector<std::string>& words,
                            const std::optional<std::string>& otherwise) {
  std::string word = otherwise ? read_or(key, *otherwise) : read<std::string>(key);
  const std::string allowed = fmt::format("\"{}\"", joined(words, "\", \""));
  auto& keys = entry().keys;
  std::ranges::find(keys, key.name, &KeyEntry::name)->range = allowed;
  if (std::ranges::count(words, word) > 0) return word;
  const std::string guess = nearest(word, words);
  const TomlEntry* found = state_->find(name_, key.name);
  if (found != nullptr && std::holds_alternative<std::string>(found->value.value)) {
    state_->problems.push_back({found->value.place,
                                fmt::format("unknown {} \"{}\"{}",
                                            key.name,
                                            word,
                                            guess.empty() ? "" : did_you_mean("\"" + guess + "\"")),
                                "known: " + allowed,
                                name_,
                                {}});
  }
  return guess.empty() ? words.front() : guess;
}

void Section::exactly_one_of(const std::vector<std::string>& keys) {
  for (KeyEntry& key : entry().keys) {
    if (std::ranges::count(keys, key.name) > 0) {
      key.missing = fmt::format("exactly one of {}", joined(keys, ", "));
    }
  }
  at_most_one_of(keys);
  if (!given() || state_->listing || !present(keys).empty()) return;
  const std::string wanted = fmt::format("give exactly one of {}", joined(keys, ", "));
  state_->problems.push_back(
      {state_->place(name_, ""), wanted + " " + title(name_), "none is there", name_, keys});
}

void Section::at_most_one_of(const std::vector<std::string>& keys) {
  const std::vector<std::string> found = present(keys);
  if (found.size() < 2) return;
  problem(found.back(),
          fmt::format("{} {} exclude each other", joined(found, " and "), title(name_)),
          fmt::format("give one of {}", joined(keys, ", ")));
}

std::vector<std::string> Section::present(const std::vector<std::string>& keys) const {
  std::vector<std::string> found;
  std::ranges::copy_if(keys, std::back_inserter(found), [&](const auto& key) { return has(key); });
  return found;
}

void Section::problem(std::string_view key, std::string text, std::string hint) {
  // What stands in for a wrong value is nobody's mistake.
  if (state_->listing || state_->refused.contains({name_, std::string(key)})) return;
  state_->problems.push_back(
      {state_->place(name_, key), std::move(text), std::move(hint), name_, {}});
}

InputFile::InputFile(std::unique_ptr<InputState> state) : state_(std::move(state)) {}
InputFile::InputFile(InputFile&&) noexcept = default;
InputFile::~InputFile() = default;

InputFile InputFile::open(const std::filesystem::path& path) {
  return from_text(read_file(path, largest_text), path);
}

InputFile InputFile::from_text(std::string text, const std::filesystem::path& path) {
  refuse_binary(text, path);
  auto state = std::make_unique<InputState>();
  state->root = std::get<TomlTable>(parse_toml(text, path).value);
  state->text = std::move(text);
  state->path = path;
  return InputFile(std::move(state));
}

InputFile InputFile::listing() {
  auto state = std::make_unique<InputState>();
  state->listing = true;
  return InputFile(std::move(state));
}

Section InputFile::top() {
  return {*state_, ""};
}

Section InputFile::section(std::string_view name, std::string_view meaning) {
  Section section = optional_section(name, meaning);
  state_->entry(name).required = true;
  if (!section.given()) {
    state_->problems.push_back({{},
                                fmt::format("missing section [{}]", name),
                                std::string(meaning),
                                {},
                                {std::string(name)}});
  }
  return section;
}

Section InputFile::optional_section(std::string_view name, std::string_view meaning) {
  std::string& known = state_->entry(name).meaning;
  if (known.empty()) known = meaning;  // who reads the section first describes it
  return {*state_, name};
}

std::vector<Section> InputFile::sections(std::string_view name, std::string_view meaning) {
  if (state_->listing) return {optional_section(fmt::format("[{}]", name), meaning)};
  const Section single = optional_section(name, meaning);
  if (single.given()) return {single};
  std::vector<Section> found;
  for (std::size_t k = 1; state_->table(fmt::format("{}.{}", name, k)) != nullptr; ++k) {
    found.push_back(optional_section(fmt::format("{}.{}", name, k), meaning));
  }
  return found;
}

void InputFile::finish() {
  std::vector<Problem>& problems = state_->problems;
  state_->find_unknown(state_->root, "");
  if (problems.empty()) return;
  std::ranges::stable_sort(problems, {}, [](const Problem& p) { return p.place.line; });
  std::vector<std::string> lines;
  for (const Problem& p : problems) {
    if (lines.size() == problems_shown) break;
    lines.push_back(excerpt(state_->path.string(), state_->text, p.place, p.text, p.hint));
  }
  if (problems.size() > problems_shown) lines.emplace_back("... and more");
  throw InputError(joined(lines, "\n"));
}

std::string InputFile::message(std::string_view section,
                               std::string_view key,
                               std::string_view text,
                               std::string_view hint) const {
  return excerpt(state_->path.string(), state_->text, state_->place(section, key), text, hint);
}

const std::string& InputFile::text() const {
  return state_->text;
}
const std::filesystem::path& InputFile::path() const {
  return state_->path;
}
std::string InputFile::key_list() const {
  return markdown(state_->asked);
}

}  // namespace grainlaw::io
