#include "apps/report/svg.h"

#include <fmt/format.h>

#include <regex>

#include "apps/report/html.h"

namespace grainlaw::report {
namespace {

std::string replace_all(const std::string& source, const char* pattern, const std::string& by) {
  return std::regex_replace(source, std::regex(pattern), by);
}

std::string inherit_colour(std::string svg) {
  svg = replace_all(svg, R"re( color="(?:black|white)")re", "");
  return replace_all(svg,
                     R"re((fill|stroke|color)=["'](?:black|rgb\( *0, *0, *0\))["'])re",
                     R"($1="currentColor")");
}

std::string inherit_font(std::string svg) {
  return replace_all(svg, R"( font-family="[^"]*")", "");
}

std::string make_ids_unique(std::string svg, const std::string& prefix) {
  svg = replace_all(svg, R"(\bid=["']([^"']*)["'])", "id=\"" + prefix + "-$1\"");
  svg = replace_all(svg, R"((?:xlink:)?href=["']#([^"']*)["'])", "href=\"#" + prefix + "-$1\"");
  return replace_all(svg, R"(url\(#([^)]*)\))", "url(#" + prefix + "-$1)");
}

/// Titles would show as tooltips that repeat the legend; empty groups are half of the file.
std::string drop_clutter(std::string svg) {
  svg = replace_all(svg, R"(<title>[^<]*</title>|<desc>[^<]*</desc>)", "");
  svg = replace_all(svg, R"(<filter[^>]*>[\s\S]*?</filter>)", "");
  svg = replace_all(svg, R"(<g fill="none"[^>]*>\s*</g>)", "");
  return replace_all(svg, R"(\n\s*)", "\n");
}

}  // namespace

std::string inline_svg(std::string_view drawn, std::string_view prefix, std::string_view label) {
  const std::size_t element = drawn.find("<svg");
  const std::size_t begin = drawn.find('>', element);
  const std::size_t end = drawn.rfind("</svg>");
  std::match_results<std::string_view::const_iterator> view_box;
  if (begin == drawn.npos || end == drawn.npos ||
      !std::regex_search(drawn.begin() + element,
                         drawn.begin() + begin,
                         view_box,
                         std::regex(R"re(viewBox="([0-9. ]*)")re"))) {
    return {};
  }
  std::string content(drawn.substr(begin + 1, end - begin - 1));
  content = make_ids_unique(std::move(content), std::string(prefix));
  content = drop_clutter(inherit_font(inherit_colour(std::move(content))));
  return fmt::format(R"(<svg role="img" aria-label="{}" viewBox="{}">{}</svg>)",
                     text(label).markup,
                     view_box[1].str(),
                     content);
}

}  // namespace grainlaw::report
