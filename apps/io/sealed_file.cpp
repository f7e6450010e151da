#include "apps/io/sealed_file.h"

#include <fmt/format.h>

#include <charconv>

#include "apps/io/input_file.h"

namespace grainlaw::io {
namespace {

/// The number after `label`; -1 when there is none.
long long number_after(std::string_view text, std::string_view label) {
  const std::size_t at = text.find(label);
  if (at == std::string_view::npos) return -1;
  long long value = -1;
  const char* begin = text.data() + at + label.size();
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  return error == std::errc{} ? value : -1;
}

std::string foreign(std::string_view bytes) {
  if (bytes.empty()) return "is empty";
  if (bytes.starts_with("\x89HDF")) return "is an HDF5 file, but not one that grainlaw wrote";
  return "is not a file that grainlaw wrote";
}

}  // namespace

std::string seal(std::string_view kind, int format, std::string_view content) {
  std::string bytes = fmt::format("grainlaw {}\nformat {}\nbytes {}\nchecksum {:016x}\n",
                                  kind,
                                  format,
                                  content.size(),
                                  checksum(content));
  bytes.resize(seal_bytes, '\0');
  return bytes.append(content);
}

std::string_view unseal(std::string_view kind,
                        int format,
                        std::string_view bytes,
                        const std::filesystem::path& path) {
  const auto fail = [&](const std::string& what) {
    throw ReadError(fmt::format("{} {}: a {} file is wanted", path.string(), what, kind));
  };
  const std::string first_line = fmt::format("grainlaw {}\n", kind);
  if (!bytes.starts_with(first_line)) fail(foreign(bytes));
  const std::string_view stated = bytes.substr(0, seal_bytes);
  const long long version = number_after(stated, "\nformat ");
  if (version > format) {
    fail(fmt::format("has format {}, this program knows {} and older", version, format));
  }
  const std::string_view content = bytes.substr(stated.size());
  const long long size = number_after(stated, "\nbytes ");
  if (size > static_cast<long long>(content.size()) || stated.size() < seal_bytes) {
    fail(fmt::format("is cut short, it has {} bytes", bytes.size()));
  }
  if (stated != seal(kind, format, content).substr(0, seal_bytes)) {
    fail("was changed or damaged after it was written (checksum)");
  }
  return content;
}

}  // namespace grainlaw::io
