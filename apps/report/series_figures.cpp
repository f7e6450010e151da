#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/cohesion_section.h"
#include "apps/report/figure.h"

namespace grainlaw::report {
namespace {

using calibration::ContactPoint;
using calibration::RatioLaw;

constexpr PlotSize series_size{.width = 480, .height = 360};
/// Below it Xi is not told from 0, which has no place on a logarithmic axis: its upper limit is
/// drawn instead.
constexpr double least_ratio = 1e-3;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> series_names(const SeriesReport& series) {
  std::vector<std::string> names;
  for (const ContactPoint& point : series.contacts.points) {
    if (std::ranges::find(names, point.series) == names.end()) names.push_back(point.series);
  }
  return names;
}

/// P(gd t) of the smallest d_c.
Csv curve_csv(const LifetimeCurve& curve) {
  Csv csv{.columns = {"gd t", "P", "P error"}, .rows = {}};
  const double gd = curve.statistics.shear_rate;
  for (const dem::LifetimeRow& row : curve.statistics.distances.front().rows) {
    if (!(row.density.value > 0.0)) continue;
    csv.rows.push_back({gd * std::sqrt(row.begin * row.end), row.density.value, row.density.error});
  }
  return csv;
}

std::string curve_file(std::size_t k) {
  return fmt::format("lifetimes_{}.csv", k + 1);
}

std::string log_log_head(const std::string& name,
                         std::size_t entries,
                         std::size_t longest_title,
                         const char* x,
                         const char* y) {
  return plot_head(name, series_size) + key_above(entries, longest_title, series_size) +
         fmt::format(
             "set logscale xy\nset format xy '10^{{%T}}'\n"
             "set xlabel '{}'\nset ylabel '{}'\n",
             x,
             y);
}

Figure distribution_figure(const SeriesReport& series, const std::string& of, std::size_t number) {
  const std::string name = fmt::format("lifetimes_series_{}", number);
  std::string parts;
  std::size_t line = 0;
  std::size_t longest_title = 0;
  for (std::size_t k = 0; k < series.curves.size(); ++k) {
    if (series.curves[k].series != of) continue;
    longest_title = std::max(longest_title, series.curves[k].name.size());
    parts += fmt::format("{}'{}' using \"gd t\":\"P\" with lines {} title '{}'",
                         parts.empty() ? "" : ", \\\n     ",
                         curve_file(k),
                         line_style(line++),
                         plot_text(series.curves[k].name));
  }
  parts += fmt::format(
      ", \\\n     0.1 with lines lw 1 dt (2,4) lc rgb '{}' title '{{/:Italic P}} = 0.1'",
      colour::band);
  return {.name = name,
          .script =
              log_log_head(
                  name, line + 1, longest_title, "γ̇ {/:Italic t}", "{/:Italic P}(γ̇ {/:Italic t})") +
              "set yrange [1e-4:]\nplot " + parts + "\n",
          .label = "Distribution of contact lifetimes, " + of,
          .caption = "Lifetimes of contacts scaled with the shear rate, "_html + text(of)};
}

/// Columns of all points of one series, in the order of the runs.
Csv points_csv(const SeriesReport& series, const std::string& of) {
  Csv csv{.columns = {"kn",
                      "gd tau_l",
                      "gd tau_l error",
                      "Xi 1/4",
                      "Xi 1/4 low",
                      "Xi 1/4 high",
                      "Xi 1/2",
                      "Xi 1/2 low",
                      "Xi 1/2 high",
                      "Xi 3/4",
                      "Xi 3/4 low",
                      "Xi 3/4 high",
                      "Xi limit",
                      "Nc",
                      "Nc error",
                      "mean",
                      "mean error"},
          .rows = {}};
  for (const ContactPoint& point : series.contacts.points) {
    if (point.series != of) continue;
    std::vector<double> row = {point.stiffness,
                               point.tail_sampled ? point.long_lifetime.value : nan,
                               point.long_lifetime.error};
    for (const calibration::FittedCoefficient& ratio : point.ratio) {
      const bool found = ratio.interval.lower > least_ratio;
      row.push_back(found ? ratio.value : nan);
      row.push_back(ratio.interval.lower);
      row.push_back(ratio.interval.upper);
    }
    const calibration::FittedCoefficient& middle = point.ratio[1];
    const bool limit = !(middle.interval.lower > least_ratio) && middle.interval.upper > 0.0;
    row.push_back(limit ? middle.interval.upper : nan);
    row.insert(row.end(),
               {point.collision_rate.value,
                point.collision_rate.error,
                point.mean.value / point.shear_rate,
                point.mean.error / point.shear_rate});
    csv.rows.push_back(std::move(row));
  }
  return csv;
}

std::string points_file(std::size_t k) {
  return fmt::format("series_{}.csv", k + 1);
}

/// Half a decade beyond the softest and the stiffest grains.
std::string stiffness_axis(const SeriesReport& series) {
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  for (const ContactPoint& point : series.contacts.points) {
    low = std::min(low, point.stiffness);
    high = std::max(high, point.stiffness);
  }
  return fmt::format("set xrange [{:.3g}:{:.3g}]\n", low / 3.0, 3.0 * high);
}

bool several_stiffnesses(const SeriesReport& series) {
  return std::ranges::any_of(series.contacts.points, [&](const ContactPoint& point) {
    return point.stiffness != series.contacts.points.front().stiffness;
  });
}

constexpr std::string_view limit_title = "hollow: upper end";
constexpr double mark_size = 0.9;

/// Xi with its bars, and upper limits: the hollow shape of the series on an arrow that points down.
std::string ratio_parts(const std::string& x, std::size_t k, const std::string& title) {
  const std::string colour = point_style(k).substr(point_style(k).find("lc rgb"));
  return fmt::format(
      "keyentry with points {3} title '{4}', \\\n     "
      "'{0}' using {1}:\"Xi 1/2\":\"Xi 1/2 low\":\"Xi 1/2 high\" with yerrorbars {3} notitle, "
      "\\\n     "
      "'{0}' using {1}:\"Xi limit\":(0):(-0.45*column(\"Xi limit\")) with vectors head size "
      "screen 0.012,25 filled lw 1 {2} notitle, \\\n     "
      "'{0}' using {1}:\"Xi limit\" with points {5} notitle",
      points_file(k),
      x,
      colour,
      point_style(k, mark_size),
      title,
      hollow_style(k, 1.2 * mark_size));
}

bool has_limits(const SeriesReport& series) {
  return std::ranges::any_of(series.contacts.points, [](const ContactPoint& point) {
    const auto& interval = point.ratio[1].interval;
    return !(interval.lower > least_ratio) && interval.upper > 0.0 && std::isfinite(interval.upper);
  });
}

/// What the hollow shapes are, as an entry of the key.
std::string limit_key(const SeriesReport& series) {
  return has_limits(series)
             ? fmt::format(", \\\n     keyentry with points pt 6 ps 1 lc rgb 'black' title '{}'",
                           limit_title)
             : "";
}

constexpr const char* limit_caption =
    "; bars: 95 %; hollow with an arrow: upper end of the 95 %, where <i>Ξ</i> is not told from 0";

/// Series of one stiffness stand beside each other.
std::string beside(const char* column, std::size_t k, std::size_t of) {
  const double place = static_cast<double>(k) - 0.5 * static_cast<double>(of - 1);
  return fmt::format("(column(\"{}\")*{:.4g})", column, std::pow(1.12, place));
}

std::string power(const RatioLaw& law, const std::string& title, std::size_t style) {
  return fmt::format(", \\\n     {:.6g} * x**({:.6g}) with lines {} title '{}'",
                     law.factor.value,
                     law.rate.value,
                     line_style(style),
                     title);
}

Figure ratio_figure(const SeriesReport& series, const std::vector<std::string>& names) {
  const std::string name = "series_ratio";
  std::string parts;
  std::size_t entries = names.size() + 1;
  for (std::size_t k = 0; k < names.size(); ++k) {
    parts += parts.empty() ? "" : ", \\\n     ";
    parts += ratio_parts(beside("kn", k, names.size()), k, plot_text(names[k]));
    for (const calibration::StiffnessLaws& laws : series.contacts.stiffness) {
      if (laws.series != names[k] || !laws.ratio[1]) continue;
      parts += power(*laws.ratio[1], "its power law", k);
      ++entries;
    }
  }
  return {.name = name,
          .script = log_log_head(name,
                                 entries,
                                 std::max(longest(names), limit_title.size()),
                                 "{/:Italic k}_n {/:Italic d}/({/:Italic m g})",
                                 "{/:Italic Ξ} at half height") +
                    stiffness_axis(series) + "plot " + parts + limit_key(series) + "\n",
          .label = "Ratio of the linear to the quadratic stress against stiffness",
          .caption =
              "<i>Ξ</i> at half height against the stiffness; beside each other: the same "
              "stiffness"_html +
              Html{limit_caption}};
}

/// A fifth beyond the longest lifetime.
double lifetime_end(const SeriesReport& series) {
  double longest = 0.0;
  for (const ContactPoint& point : series.contacts.points) {
    if (point.tail_sampled) longest = std::fmax(longest, point.long_lifetime.value);
  }
  return longest > 0.0 ? 1.2 * longest : 1.5;
}

Figure lifetime_figure(const SeriesReport& series, const std::vector<std::string>& names) {
  const std::string name = "series_lifetime";
  std::string parts;
  std::size_t entries = names.size() + 2;
  const std::size_t longest_title = std::max(longest(names), limit_title.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    parts += parts.empty() ? "" : ", \\\n     ";
    parts += ratio_parts("\"gd tau_l\"", k, plot_text(names[k]));
  }
  if (series.contacts.lifetime_law) {
    const RatioLaw& law = *series.contacts.lifetime_law;
    parts += fmt::format(
        ", \\\n     {:.6g} * exp({:.6g} * x) with lines lw 1.5 lc rgb 'black' "
        "title 'fit'",
        law.factor.value,
        law.rate.value);
    ++entries;
  }
  parts += fmt::format(
      ", \\\n     0.03 * exp(4.9 * x) with lines lw 1 dt (3,3) lc rgb '{}' "
      "title 'Brewster et al.'",
      colour::band);
  return {.name = name,
          .script = plot_head(name, series_size) + key_above(entries, longest_title, series_size) +
                    "set logscale y\nset format y '10^{%T}'\n"
                    "set xlabel 'γ̇ {/:Italic τ}_l'\nset ylabel '{/:Italic Ξ} at half height'\n" +
                    fmt::format("set xrange [0:{:.3g}]\nset yrange [1e-3:*]\nplot ",
                                lifetime_end(series)) +
                    parts + limit_key(series) + "\n",
          .label = "Ratio of the linear to the quadratic stress against the long contact lifetime",
          .caption =
              "<i>Ξ</i> against the long lifetime, where <i>P</i> = 0.1; dotted: Brewster et al. "
              "(2008), eq. 14"_html +
              Html{limit_caption}};
}

Figure collision_figure(const SeriesReport& series, const std::vector<std::string>& names) {
  const std::string name = "series_collisions";
  std::string parts;
  std::size_t entries = names.size();
  for (std::size_t k = 0; k < names.size(); ++k) {
    parts +=
        fmt::format("{0}'{1}' using \"kn\":\"Nc\":\"Nc error\" with yerrorbars {2} title '{3}'",
                    parts.empty() ? "" : ", \\\n     ",
                    points_file(k),
                    point_style(k),
                    plot_text(names[k]));
    for (const calibration::StiffnessLaws& laws : series.contacts.stiffness) {
      if (laws.series == names[k] && laws.collision_rate) {
        parts += power(*laws.collision_rate,
                       fmt::format("exponent {:.2f}", laws.collision_rate->rate.value),
                       k);
      }
    }
  }
  return {.name = name,
          .script = log_log_head(name,
                                 entries,
                                 std::max(longest(names), limit_title.size()),
                                 "{/:Italic k}_n {/:Italic d}/({/:Italic m g})",
                                 "{/:Italic N}_c √({/:Italic d}/{/:Italic g})") +
                    stiffness_axis(series) + "plot " + parts + "\n",
          .label = "Collisions per grain against stiffness",
          .caption = "Contacts that begin, per grain and √(<i>d</i>/<i>g</i>)"_html};
}

}  // namespace

std::vector<FigureGroup> series_figures(const SeriesReport& series) {
  const std::vector<std::string> names = series_names(series);
  if (names.empty()) return {};
  std::vector<FigureGroup> groups(1);
  const auto add = [&](Figure figure) {  // two of them side by side can be read
    if (groups.back().figures.size() == 2) groups.emplace_back();
    groups.back().figures.push_back(std::move(figure));
  };
  for (std::size_t k = 0; k < series.curves.size(); ++k) {
    groups.front().data[curve_file(k)] = curve_csv(series.curves[k]);
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    groups.front().data[points_file(k)] = points_csv(series, names[k]);
    if (std::ranges::find(series.curves, names[k], &LifetimeCurve::series) != series.curves.end()) {
      add(distribution_figure(series, names[k], k + 1));
    }
  }
  const bool over_stiffness = several_stiffnesses(series);
  if (over_stiffness) add(ratio_figure(series, names));
  if (!series.curves.empty()) add(lifetime_figure(series, names));
  if (!series.curves.empty() && over_stiffness) add(collision_figure(series, names));
  if (series.cohesion) {
    groups.front().data.merge(cohesion_data(series));
    for (Figure& figure : cohesion_figures(series)) add(std::move(figure));
  }
  return groups;
}

}  // namespace grainlaw::report
