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

Html cell(std::string_view name, bool words, const Html& content) {
  const std::string_view style = words ? R"( class="words")" : "";
  return {fmt::format("<{0}{1}>{2}</{0}>", name, style, content.markup)};
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
