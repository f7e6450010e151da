#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw::report {

/// Markup as it stands in the page. Whatever was not written as markup in this program (names,
/// messages, numbers) enters through text(), which escapes it.
struct Html {
  std::string markup;

  Html& operator+=(const Html& next);
};

Html operator+(Html first, const Html& second);
Html operator""_html(const char* markup, std::size_t length);

/// Plain text with & < > " ' escaped.
Html text(std::string_view plain);

/// Name of a run, file or key, which may break into lines after each underscore.
Html code(std::string_view name);

Html join(const std::vector<Html>& parts, const Html& separator);
Html paragraph(const Html& content);
Html list(const std::vector<Html>& items);

/// The content of `count` items, behind "25 points" (to be opened) where they are more than `most`.
Html folded(std::size_t count, std::size_t most, std::string_view what, const Html& content);

/// A list that more than eight items fold.
Html long_list(const std::vector<Html>& items, std::string_view what);

Html section(std::string_view id, const Html& title, const Html& content);

/// A table whose first `text_columns` columns hold words (left), the others numbers (right). A row
/// of one cell is a heading over the rows below it.
struct Table {
  Html caption;
  std::vector<Html> head;
  std::vector<std::vector<Html>> rows;
  std::size_t text_columns = 1;
};

/// Cells wrap where the page is narrow; what is still wider scrolls in a box of its own.
Html table(const Table& content);

}  // namespace grainlaw::report
