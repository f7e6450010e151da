#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "apps/io/input_key.h"

namespace grainlaw::io {

/// Bad input; what() is the whole message with file:line:column, the line, a caret and the remedy.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file that could not be written or read; what() names path and system error.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A rectangular or ragged list of rows of numbers.
using NumberRows = std::vector<std::vector<double>>;

struct InputState;

/// One section of an input file. Nothing throws while keys are read: problems are gathered, a
/// placeholder is returned, and InputFile::finish reports all of them at once.
/// T: double, std::int64_t, bool, std::string, std::vector<double>, std::vector<std::string>,
/// NumberRows. Numbers are returned in internal units, bounds hold in the units of the file.
class Section {
 public:
  /// Is the section in the file (always, when listing keys)?
  bool given() const;
  bool has(std::string_view key) const;

  /// A key that has to be there.
  template <class T>
  T read(const Key& key);
  /// A key with a default, which is given in internal units; `note` describes its unit there.
  template <class T>
  T read_or(const Key& key, const T& otherwise, std::string_view note = {});
  /// A key that may be absent.
  template <class T>
  std::optional<T> find(const Key& key);
  /// A word out of a list; required.
  std::string choice(const Key& key, const std::vector<std::string>& words);

  /// Exactly one of these keys has to be there.
  void exactly_one_of(const std::vector<std::string>& keys);
  /// Do the keys that follow apply? They do when listing, where `condition` is shown with them.
  bool applies(bool condition) const;
  /// Gathers a problem with a key (with the section, when the key is absent).
  void problem(std::string_view key, const std::string& text);

 private:
  friend class InputFile;
  Section(InputState& state, std::string name) : state_(&state), name_(std::move(name)) {}
  InputState* state_;
  std::string name_;
};

/// A TOML file that knows where everything stands in it.
class InputFile {
 public:
  /// Throws FileError when the file cannot be read and InputError for a syntax error.
  static InputFile open(const std::filesystem::path& path);
  static InputFile from_text(std::string text, const std::filesystem::path& path);
  /// No file: every section is given, every key absent, nothing is a problem. For key lists.
  static InputFile listing();

  InputFile(InputFile&&) noexcept;
  ~InputFile();

  Section top();
  Section section(std::string_view name, std::string_view meaning);           ///< has to be there
  Section optional_section(std::string_view name, std::string_view meaning);  ///< may be absent

  bool has_problems() const;
  /// Throws InputError when there were problems or keys and sections nobody asked for.
  void finish();
  /// "file:line:column: error: text" with the line and a caret under the key, for a problem that
  /// is found after finish().
  std::string message(std::string_view section,
                      std::string_view key,
                      const std::string& text) const;

  const std::string& text() const;
  const std::filesystem::path& path() const;
  std::string key_list() const;  ///< Markdown

 private:
  explicit InputFile(std::unique_ptr<InputState> state);
  std::unique_ptr<InputState> state_;
};

}  // namespace grainlaw::io
