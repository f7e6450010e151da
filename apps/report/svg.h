#pragma once

#include <string>
#include <string_view>

namespace grainlaw::report {

/// Makes an SVG written by gnuplot fit into a page: no XML head, black becomes the colour of the
/// text around it, fonts are inherited, and every id gets `prefix` (gnuplot gives all its files the
/// same ids). `label` is read out instead of the picture. Empty when there is no svg element.
std::string inline_svg(std::string_view drawn, std::string_view prefix, std::string_view label);

}  // namespace grainlaw::report
