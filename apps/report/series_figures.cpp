#include <fmt/format.h>

#include <algorithm>
#include <array>
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

std::string log_log_head(const std::string& name, const char* x, const char* y) {
  return plot_head(name, series_size) +
         fmt::format(
             "set tmargin at screen 0.76\nset logscale xy\nset format xy '10^{{%T}}'\n"
             "set xlabel '{}'\nset ylabel '{}'\n",
             x,
             y);
}

Figure distribution_figure(const SeriesReport& series, const std::string& of, std::size_t number) {
  const std::string name = fmt::format("lifetimes_series_{}", number);
  std::string parts;
  std::size_t line = 0;
  for (std::size_t k = 0; k < series.curves.size(); ++k) {
    if (series.curves[k].series != of) continue;
    parts += fmt::format("{}'{}' using \"gd t\":\"P\" with lines {} title '{}'",
                         parts.empty() ? "" : ", \\\n     ",
                         curve_file(k),
                         line_style(line++),
                         plot_text(series.curves[k].name));
  }
  parts += fmt::format(", \\\n     0.1 with lines lw 1 dt (2,4) lc rgb '{}' title 'P = 0.1'",
                       colour::band);
  return {.name = name,
          .script = log_log_head(name, "γ̇ {/:Italic t}", "{/:Italic P}(γ̇ {/:Italic t})") +
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

/// Upper limits of Xi: triangles that point down, with their bar.
std::string limit_part(const char* x, std::size_t k) {
  return fmt::format(
      ", \\\n     '{0}' using \"{1}\":\"Xi limit\" with points pt 10 ps 0.8 lc rgb '{2}' notitle",
      points_file(k),
      x,
      std::array{colour::measured, colour::predicted, colour::third, colour::fourth}[k % 4]);
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
  for (std::size_t k = 0; k < names.size(); ++k) {
    parts += fmt::format(
        "{}'{}' using \"kn\":\"Xi 1/2\":\"Xi 1/2 low\":\"Xi 1/2 high\" with yerrorbars {} "
        "title '{}'",
        parts.empty() ? "" : ", \\\n     ",
        points_file(k),
        point_style(k),
        plot_text(names[k]));
    parts += limit_part("kn", k);
    for (const calibration::StiffnessLaws& laws : series.contacts.stiffness) {
      if (laws.series == names[k] && laws.ratio[1]) {
        parts += power(*laws.ratio[1], "its power law", k);
      }
    }
  }
  return {
      .name = name,
      .script =
          log_log_head(name, "{/:Italic k}_n {/:Italic d}/({/:Italic m g})", "Ξ at half height") +
          "plot " + parts + "\n",
      .label = "Ratio of the linear to the quadratic stress against stiffness",
      .caption =
          "<i>Ξ</i> at half height against the stiffness; bars: 95 %, open triangles: its upper end where <i>Ξ</i> is not told from 0"_html};
}

Figure lifetime_figure(const SeriesReport& series, const std::vector<std::string>& names) {
  const std::string name = "series_lifetime";
  std::string parts;
  for (std::size_t k = 0; k < names.size(); ++k) {
    parts += fmt::format(
        "{}'{}' using \"gd tau_l\":\"Xi 1/2\":\"Xi 1/2 low\":\"Xi 1/2 high\" with yerrorbars {} "
        "title '{}'",
        parts.empty() ? "" : ", \\\n     ",
        points_file(k),
        point_style(k),
        plot_text(names[k]));
    parts += limit_part("gd tau_l", k);
  }
  if (series.contacts.lifetime_law) {
    const RatioLaw& law = *series.contacts.lifetime_law;
    parts += fmt::format(
        ", \\\n     {:.6g} * exp({:.6g} * x) with lines lw 1.5 lc rgb 'black' "
        "title 'fit'",
        law.factor.value,
        law.rate.value);
  }
  parts += fmt::format(
      ", \\\n     0.03 * exp(4.9 * x) with lines lw 1 dt (3,3) lc rgb '{}' "
      "title 'Brewster et al. 2008'",
      colour::band);
  return {.name = name,
          .script = plot_head(name, series_size) +
                    "set tmargin at screen 0.76\nset logscale y\nset format y '10^{%T}'\n"
                    "set xlabel 'γ̇ τ_l'\nset ylabel 'Ξ at half height'\nset xrange [0:1.5]\n"
                    "set yrange [1e-3:*]\nplot " +
                    parts + "\n",
          .label = "Ratio of the linear to the quadratic stress against the long contact lifetime",
          .caption = "<i>Ξ</i> against the long lifetime, where <i>P</i> = 0.1; bars: 95 %"_html};
}

Figure collision_figure(const SeriesReport& series, const std::vector<std::string>& names) {
  const std::string name = "series_collisions";
  std::string parts;
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
