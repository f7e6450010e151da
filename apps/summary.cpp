#include "apps/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace grainlaw {
namespace {

template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

constexpr std::size_t text_columns = 80;

/// Words of `text` in lines that start at column `indent`.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::string out;
  std::size_t column = indent;
  std::size_t begin = 0;
  while (begin < text.size()) {
    std::size_t end = std::min(text.find(' ', begin), text.size());
    if (text.compare(end, 2, " %") == 0) end = std::min(text.find(' ', end + 1), text.size());
    const std::string word = text.substr(begin, end - begin);
    if (column > indent && column + 1 + word.size() > text_columns) {
      out += '\n' + std::string(indent, ' ');
      column = indent;
    }
    if (column > indent) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
    begin = end + 1;
  }
  return out;
}

/// Four digits, more where they stand before the point; whole numbers as they are.
std::string number_text(double x) {
  const double size = std::abs(x);
  if (size >= 1e4 && size < 1e6 && x != std::round(x)) return fmt::format("{:.0f}", x);
  const bool whole = x == std::round(x) && size < 1e6;
  return whole ? fmt::format("{:.6g}", x) : fmt::format("{:.4g}", x);
}

std::string value_text(const Summary::Value& value, std::size_t indent) {
  return std::visit(Overload{[](double x) { return number_text(x); },
                             [](long n) { return fmt::format("{}", n); },
                             [](bool yes) { return std::string(yes ? "yes" : "no"); },
                             [&](const std::string& text) { return wrapped(text, indent); },
                             [&](const std::vector<std::string>& lines) {
                               std::string out;
                               for (const std::string& line : lines) {
                                 if (!out.empty()) out += '\n' + std::string(indent, ' ');
                                 out += wrapped(line, indent);
                               }
                               return out.empty() ? std::string("none") : out;
                             }},
                    value);
}

}  // namespace

void Summary::add(const std::string& key,
                  const std::string& label,
                  Value value,
                  const std::string& unit) {
  entries_.push_back({key, label, unit, std::move(value)});
}

void Summary::heading(const std::string& title) {
  entries_.push_back({.key = {}, .label = title, .unit = {}, .value = std::string()});
}

void Summary::add_estimate(const std::string& key,
                           const std::string& label,
                           double value,
                           double error,
                           const std::string& unit,
                           const Trust& trust) {
  entries_.push_back({key, label, unit, value, true, error, trust});
}

std::string Summary::text() const {
  std::size_t width = 0;
  for (const Entry& entry : entries_)
    if (!entry.key.empty()) width = std::max(width, entry.label.size());
  std::string out;
  for (const Entry& entry : entries_) {
    if (entry.key.empty()) {
      out += (out.empty() ? "" : "\n") + entry.label + '\n';
      continue;
    }
    const double* x = std::get_if<double>(&entry.value);
    const bool known = x != nullptr && std::isfinite(*x) && !(entry.error > 0.0);
    const std::string value = entry.has_error && !known ? value_with_error(*x, entry.error)
                                                        : value_text(entry.value, width + 2);
    out += fmt::format("{:<{}}  {}", entry.label, width, value);
    if (!entry.unit.empty()) out += ' ' + entry.unit;
    if (!entry.trust.convergence.empty()) out += " (" + entry.trust.convergence + ')';
    out += '\n';
  }
  return out;
}

std::string Summary::json() const {
  nlohmann::ordered_json object;
  for (const Entry& entry : entries_) {
    if (entry.key.empty()) continue;  // a heading
    nlohmann::ordered_json& target = object[entry.key];
    if (entry.has_error) {
      target["value"] = number(std::get<double>(entry.value));
      // As in the text: no error is none, not an exact value.
      if (entry.error > 0.0) {
        target["error"] = number(entry.error);
      } else {
        target["error"] = nullptr;
      }
      if (!entry.trust.convergence.empty()) {
        target["half_width_95"] = number(entry.trust.half_width_95);
        target["convergence"] = entry.trust.convergence;
      }
    } else if (const double* x = std::get_if<double>(&entry.value)) {
      target = number(*x);
    } else {
      std::visit([&](const auto& value) { target = value; }, entry.value);
    }
  }
  return object.dump(2) + '\n';
}

void print(const Summary& summary, const CommonOptions& options) {
  if (options.quiet && !options.json) return;
  // A stdout that cannot be written is noticed when the program ends and flushes it.
  std::fputs((options.json ? summary.json() : summary.text()).c_str(), stdout);
}

}  // namespace grainlaw
