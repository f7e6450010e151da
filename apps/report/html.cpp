#include "apps/report/html.h"

#include <fmt/format.h>

namespace grainlaw::report {
namespace {

std::string_view entity(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return {};
  }
}

/// Numbers may break into lines where a reader would break them: before ±, a bracket and "to".
/// Every other space holds.
std::string held_together(const std::string& markup) {
  std::string result;
  bool in_tag = false;
  for (std::size_t i = 0; i < markup.size(); ++i) {
    if (markup[i] == '<') in_tag = true;
    if (markup[i] == '>') in_tag = false;
    const std::string_view rest = std::string_view(markup).substr(i + 1);
    const bool breaks = rest.starts_with("±") || rest.starts_with("[") || rest.starts_with("(") ||
                        rest.starts_with("to ");
    markup[i] == ' ' && !in_tag&& !breaks ? result += "\u00a0" : result += markup[i];
  }
  return result;
}

/// A sentence in a column of numbers wraps as any other.
bool is_sentence(const std::string& markup) {
  return markup.find("<span") != std::string::npos;
}

Html cell(std::string_view name, bool words, const Html& content) {
  const std::string_view style = words ? R"( class="words")" : "";
  const bool numbers = !words && name == "td" && !is_sentence(content.markup);
  return {fmt::format(
      "<{0}{1}>{2}</{0}>", name, style, numbers ? held_together(content.markup) : content.markup)};
}

Html row(const std::vector<Html>& cells, std::string_view name, const Table& content) {
  if (cells.size() == 1 && content.head.size() > 1) {
    return {fmt::format(R"(<tr class="group"><th class="words" colspan="{}">{}</th></tr>)",
                        content.head.size(),
                        cells.front().markup)};
  }
  Html result = "<tr>"_html;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    result += cell(name, i < content.text_columns, cells[i]);
  }
  return result + "</tr>\n"_html;
}

}  // namespace

Html& Html::operator+=(const Html& next) {
  markup += next.markup;
  return *this;
}

Html operator+(Html first, const Html& second) {
  return first += second;
}

Html operator""_html(const char* markup, std::size_t length) {
  return {{markup, length}};
}

Html text(std::string_view plain) {
  Html result;
  for (const char c : plain) {
    const std::string_view escaped = entity(c);
    escaped.empty() ? result.markup += c : result.markup += escaped;
  }
  return result;
}

Html code(std::string_view name) {
  Html result = "<code>"_html;
  for (const char c : name) {
    result += text({&c, 1});
    if (c == '_') result.markup += "<wbr/>";
  }
  return result + "</code>"_html;
}

Html join(const std::vector<Html>& parts, const Html& separator) {
  Html result;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i > 0) result += separator;
    result += parts[i];
  }
  return result;
}

Html paragraph(const Html& content) {
  return "<p>"_html + content + "</p>\n"_html;
}

Html list(const std::vector<Html>& items) {
  Html result = "<ul>\n"_html;
  for (const Html& item : items) result += "<li>"_html + item + "</li>\n"_html;
  return result + "</ul>\n"_html;
}

Html folded(std::size_t count, std::size_t most, std::string_view what, const Html& content) {
  if (count <= most) return content;
  return {fmt::format("<details>\n<summary>{} {}</summary>\n{}</details>\n",
                      count,
                      text(what).markup,
                      content.markup)};
}

Html long_list(const std::vector<Html>& items, std::string_view what) {
  constexpr std::size_t most = 8;
  return folded(items.size(), most, what, list(items));
}

Html section(std::string_view id, const Html& title, const Html& content) {
  return {fmt::format(
      "<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, title.markup, content.markup)};
}

Html table(const Table& content) {
  Html result = R"(<div class="scroll" tabindex="0"><table>)"_html;
  if (!content.caption.markup.empty()) {
    result += "\n<caption>"_html + content.caption + "</caption>"_html;
  }
  result += "\n<thead>"_html + row(content.head, "th", content) + "</thead>\n<tbody>\n"_html;
  for (const std::vector<Html>& cells : content.rows) result += row(cells, "td", content);
  return result + "</tbody>\n</table></div>\n"_html;
}

}  // namespace grainlaw::report
