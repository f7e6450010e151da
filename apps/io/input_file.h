#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/io/input_key.h"

namespace grainlaw::io {

/// Bad input; what() is the whole message with file:line:column, the line, a caret and the remedy.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An input file that cannot be used at all: missing, foreign, cut short, changed.
struct ReadError : InputError {
  using InputError::InputError;
};

/// A file that could not be written; what() names path and system error.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Rows of a matrix as written, not necessarily of equal length.
using NumberRows = std::vector<std::vector<double>>;

struct InputState;

/// One section of an input file. Nothing throws while keys are read: problems are gathered, a
/// placeholder is returned, and InputFile::finish reports all of them at once.
/// T: double, std::int64_t, bool, std::string, a std::vector of double, std::int64_t or
/// std::string, or NumberRows. Numbers come in internal units; their bounds hold in the units of
/// the file.
class Section {
 public:
  const std::string& name() const { return name_; }  ///< as InputFile::message takes it
  bool given() const;  ///< is it in the file (always, when listing keys)
  bool has(std::string_view key) const;

  /// A key that has to be there.
  template <class T>
  T read(const Key& key) {
    const std::optional<T> value = ask<T>(key, "required");
    if (!value) report_missing(key);
    return value.value_or(T{});
  }
  /// A key with a default, in internal units; `note` names them in the key list.
  template <class T>
  T read_or(const Key& key, const T& otherwise, std::string_view note = {}) {
    return ask<T>(key, default_text(otherwise, note)).value_or(otherwise);
  }
  /// A key that may be absent; `note` says in the key list what happens then.
  template <class T>
  std::optional<T> find(const Key& key, std::string_view note = "optional") {
    return ask<T>(key, note);
  }
  /// A word out of a list; required unless there is a default. Where it is missing or unknown, the
  /// nearest or the first stands in for it, so that the keys that depend on it can be judged.
  std::string choice(const Key& key,
                     const std::vector<std::string>& words,
                     const std::optional<std::string>& otherwise = {});

  /// This section where a key has a certain value: the key list shows its keys apart.
  Section when(std::string_view key, std::string_view word, std::string_view meaning) const;

  /// Exactly one of these keys, all read before, has to be there.
  void exactly_one_of(const std::vector<std::string>& keys);
  /// These keys, all read before, exclude each other.
  void at_most_one_of(const std::vector<std::string>& keys);
  /// Do the keys that follow apply? When listing, all do.
  bool applies(bool condition) const;
  /// Gathers the problem that a key should be there.
  void report_missing(const Key& key);
  /// Gathers a problem with a key, or with the section when the key is absent. A key whose value
  /// could not be taken has its problem already.
  void problem(std::string_view key, std::string text, std::string hint = {});

 private:
  friend class InputFile;
  Section(InputState& state, std::string_view name) : state_(&state), name_(name) {}

  template <class T>
  std::optional<T> ask(const Key& key, std::string_view missing);
  SectionEntry& entry() const;
  std::vector<std::string> present(const std::vector<std::string>& keys) const;
  static std::string default_text(double value, std::string_view note);
  static std::string default_text(std::int64_t value, std::string_view note);
  static std::string default_text(bool value, std::string_view note);
  static std::string default_text(const std::string& value, std::string_view note);

  InputState* state_;
  std::string name_;
  std::string variant_;  ///< see when(); always empty when a file is read
};

/// A TOML file that knows where everything stands in it.
class InputFile {
 public:
  /// Throws ReadError when the file cannot be read or is no text, InputError for a syntax error.
  static InputFile open(const std::filesystem::path& path);
  static InputFile from_text(std::string text, const std::filesystem::path& path);
  /// No file: every section is given, every key absent, nothing is a problem. For key lists.
  static InputFile listing();

  InputFile(InputFile&&) noexcept;
  ~InputFile();

  Section top();
  Section section(std::string_view name, std::string_view meaning);           ///< has to be there
  Section optional_section(std::string_view name, std::string_view meaning);  ///< may be absent

  /// Every [[name]], in their order; a single [name] counts as one. None: there is none.
  std::vector<Section> sections(std::string_view name, std::string_view meaning);

  /// Throws InputError when there were problems, or keys and sections nobody asked for.
  void finish();
  /// The message for a problem with a key that is found later.
  std::string message(std::string_view section,
                      std::string_view key,
                      std::string_view text,
                      std::string_view hint = {}) const;

  const std::string& text() const;
  const std::filesystem::path& path() const;
  std::string key_list() const;  ///< Markdown

 private:
  explicit InputFile(std::unique_ptr<InputState> state);
  std::unique_ptr<InputState> state_;
};

}  // namespace grainlaw::io
