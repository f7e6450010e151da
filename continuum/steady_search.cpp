#include "continuum/steady_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "continuum/bracket.h"

namespace grainlaw::continuum {
namespace {

using Missed = NoSuchFlow::Missed;

constexpr double steepest = 0.5 * std::numbers::pi - 1e-9;
constexpr double thinnest = 1e-12;  // [rho_p d]: less is no layer
constexpr double deepest = 1e15;    // [rho_p d]: beyond any layer

/// Which way to go where there is no flow: a layer at rest is too flat or too shallow, every other
/// end of steady flow lies on the far side.
double beyond(Outcome outcome) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return outcome == Outcome::arrested ? -infinity : infinity;
}

double excess(const FoundChute& at, double value, double wanted) {
  return flows(at.steady.answer.outcome) ? value / wanted - 1.0 : beyond(at.steady.answer.outcome);
}

double highest_inertial_number(const Profile& profile) {
  double highest = 0.0;
  for (const ProfileRow& row : profile.rows) highest = std::max(highest, row.inertial_number);
  return highest;
}

/// Side walls hold what is deeper, which adds nothing to the flow.
bool base_rests(const FoundChute& at) {
  const auto& rows = at.steady.profile.rows;
  return !rows.empty() && rows.front().shear_rate == 0.0;
}

class Search {
 public:
  Search(const RheologyTable& table, const ChuteQuestion& question)
      : table_(table),
        question_(question),
        unit_(question.chute.grains.density * question.chute.grains.diameter),
        least_mass_((table.base ? table.base->mass_below + thinnest : thinnest) * unit_) {}

  FoundChute find() const;
  std::optional<FoundChute> end_of_data(const std::function<FoundChute(double)>& flow,
                                        double low,
                                        double high) const;
  std::optional<FoundChute> end_of_data_over_tilts() const {
    return end_of_data([&](double tilt) { return of_size_or_rest(tilt); }, 0.0, steepest);
  }
  LargestFlow largest() const { return question_.inclination ? over_depths() : over_tilts(); }

 private:
  FoundChute at(double tilt, double mass) const;
  FoundChute of_depth(double tilt) const;
  FoundChute of_size(double tilt) const {
    return question_.depth ? of_depth(tilt) : at(tilt, *question_.mass_per_area);
  }
  FoundChute of_size_or_rest(double tilt) const;
  FoundChute mass_of_flow() const;
  FoundChute tilt_of_flow() const;

  struct Grown {
    double too_small;
    FoundChute end;  // first that is not too small any more, or the last that was tried
    bool found;
  };
  Grown grow(double tilt, const std::function<double(const FoundChute&)>& excess) const;

  double a_flowing_tilt() const;
  double peak(double flat, double steep, double enough) const;
  Bracket last_flowing(const std::function<FoundChute(double)>& flow,
                       double low,
                       double high,
                       double precision) const;
  LargestFlow over_tilts() const;
  LargestFlow over_depths() const;
  void end_by_data(LargestFlow& largest, const std::optional<FoundChute>& data) const;

  const RheologyTable& table_;
  const ChuteQuestion& question_;
  double unit_;        // rho_p d
  double least_mass_;  // above the effective base there must be some
};

FoundChute Search::at(double tilt, double mass) const {
  FoundChute found{.chute = question_.chute, .steady = {}};
  found.chute.inclination = tilt;
  found.chute.mass_per_area = mass;
  try {
    found.steady = steady_chute(table_, found.chute);
  } catch (const std::bad_optional_access&) {  // at the limit itself, by rounding
    found.steady.answer = {.outcome = Outcome::no_dense_state,
                           .text = "at the limit of what the law carries"};
  }
  found.mass_flow = found.chute.grains.density * std::abs(found.steady.profile.flux);
  return found;
}

/// The mass whose free surface stands at the depth asked for, if there is one; else the last layer
/// that was tried, which does not flow.
FoundChute Search::of_depth(double tilt) const {
  const double wanted = *question_.depth;
  const double most = least_mass_ + question_.chute.grains.density * wanted;  // phi = 1
  const Bracket end = root(
      [&](double m) {
        const FoundChute layer = at(tilt, m);
        return excess(layer, layer.steady.profile.height, wanted);
      },
      {.low = least_mass_, .high = most});
  FoundChute layer = at(tilt, end.nearest());
  if (!flows(layer.steady.answer.outcome)) return layer;
  const double height = layer.steady.profile.height;
  if (std::abs(height / wanted - 1.0) < 1e-9) return layer;
  if (height > wanted && end.low > least_mass_) return at(tilt, end.low);  // rests
  throw NoSuchFlow("no mass gives a steady flow of that depth at this tilt", Missed::depth, height);
}

/// In a search over tilts one at which no layer is that deep ends steady flow like any other.
FoundChute Search::of_size_or_rest(double tilt) const {
  try {
    return of_size(tilt);
  } catch (const NoSuchFlow& missing) {
    FoundChute none;
    const bool thick = missing.nearest && *missing.nearest > *question_.depth;
    none.steady.answer = {.outcome = thick ? Outcome::arrested : Outcome::no_dense_state,
                          .text = missing.what()};
    return none;
  }
}

/// Doubles the depth of the layer until it is not too small any more.
Search::Grown Search::grow(double tilt,
                           const std::function<double(const FoundChute&)>& excess_of) const {
  double too_small = least_mass_;
  for (double step = unit_;; step *= 2.0) {
    FoundChute layer = at(tilt, least_mass_ + step);
    const bool over = excess_of(layer) >= 0.0;
    if (over || base_rests(layer) || step > deepest * unit_)
      return {too_small, std::move(layer), over};
    too_small = least_mass_ + step;
  }
}

[[noreturn]] void flow_not_reached(const FoundChute& nearest, const std::string& why) {
  if (!flows(nearest.steady.answer.outcome))
    throw NoSuchFlow(nearest.steady.answer.text, Missed::mass_flow);
  throw NoSuchFlow(why, Missed::mass_flow, nearest.mass_flow);
}

std::string ends_there(const FoundChute& beyond_it) {
  const auto& [outcome, text, time, flags, condition] = beyond_it.steady.answer;
  return flows(outcome) ? "steady flow ends there" : "steady flow ends there: " + text;
}

FoundChute Search::mass_of_flow() const {
  const double tilt = *question_.inclination;
  const auto off = [&](const FoundChute& layer) {
    return excess(layer, layer.mass_flow, *question_.mass_flow);
  };
  const Grown grown = grow(tilt, off);
  if (!grown.found)
    flow_not_reached(
        grown.end,
        base_rests(grown.end)
            ? "side walls hold all that lies deeper at rest"
            : fmt::format("that of a layer {:g} d deep, and no deeper one is tried", deepest));
  const Bracket end = root([&](double m) { return off(at(tilt, m)); },
                           {.low = grown.too_small, .high = grown.end.chute.mass_per_area});
  FoundChute layer = at(tilt, end.nearest());
  if (!(std::abs(off(layer)) < 1e-9))
    flow_not_reached(layer,
                     end.low > least_mass_
                         ? ends_there(at(tilt, end.high))
                         : fmt::format("that of a layer of {:g} rho_p d above the base, and no "
                                       "thinner one is tried",
                                       thinnest));
  return layer;
}

constexpr const char* held = "the yield stress holds the layer at every tilt";

bool rests_at_any_tilt(const Bracket& end) {
  return std::isinf(end.low_miss) && end.low > 0.999 * steepest;
}

FoundChute Search::tilt_of_flow() const {
  const double wanted = *question_.mass_flow;
  double high = steepest;
  if (question_.depth) high = peak(0.0, steepest, wanted);
  const auto off = [&](double tilt) {
    const FoundChute layer = of_size_or_rest(tilt);
    return excess(layer, layer.mass_flow, wanted);
  };
  const Bracket end = root(off, {.low = 0.0, .high = high});
  if (rests_at_any_tilt(end)) throw NoSuchFlow(held, Missed::mass_flow);
  FoundChute layer = of_size_or_rest(end.nearest());
  if (!(std::abs(excess(layer, layer.mass_flow, wanted)) < 1e-9))
    flow_not_reached(layer,
                     question_.depth
                         ? "steeper, a layer of this depth thins more than it gains speed"
                         : ends_there(of_size_or_rest(std::min(end.high, steepest))));
  return layer;
}

double Search::a_flowing_tilt() const {
  double tilt = 0.5 * steepest;
  std::string why;
  const auto none = [&](double t) {
    const FoundChute layer = of_size_or_rest(t);
    if (!flows(layer.steady.answer.outcome)) {
      why = layer.steady.answer.text;
      return beyond(layer.steady.answer.outcome);
    }
    tilt = t;
    return 0.0;
  };
  const Bracket end = root(none, {.low = 0.0, .high = steepest});
  if (flows(of_size_or_rest(tilt).steady.answer.outcome)) return tilt;
  throw NoSuchFlow(rests_at_any_tilt(end) ? held : why, Missed::mass_flow);
}

/// Between a value at which the layer flows and one at which it does not.
Bracket Search::last_flowing(const std::function<FoundChute(double)>& flow,
                             double low,
                             double high,
                             double precision) const {
  return split(
      [&](double x) { return flows(flow(x).steady.answer.outcome); }, low, high, precision);
}

/// The tilt of the largest flow of a given depth, by golden section: steeper, the layer thins more
/// than it gains speed. Ends at the first tilt whose flow is `enough`.
double Search::peak(double flat, double steep, double enough) const {
  const double inside = a_flowing_tilt();
  const auto flow = [&](double tilt) { return of_size_or_rest(tilt); };
  const double lowest = last_flowing(flow, inside, flat, 1e-6).low;
  const double highest = last_flowing(flow, inside, steep, 1e-6).low;
  return golden_section(
      [&](double tilt) {
        const FoundChute layer = of_size_or_rest(tilt);
        return flows(layer.steady.answer.outcome) ? layer.mass_flow : -1.0;
      },
      lowest,
      highest,
      enough);
}

void refuse_own_tilt(const RheologyTable& table) {
  if (const auto* law = std::get_if<GeneralisedBagnold>(&table.law))
    throw std::invalid_argument(
        fmt::format("this table of a, b, tau_c holds at its own tilt only, {:.5g} degrees: no "
                    "other tilt can be sought; give inclination, or a table of mu(I)",
                    law->inclination * 180.0 / std::numbers::pi));
}

FoundChute Search::find() const {
  const bool size = question_.mass_per_area || question_.depth;
  if (!question_.mass_flow && question_.inclination && size) return of_size(*question_.inclination);
  if (question_.mass_flow && question_.inclination && !size) return mass_of_flow();
  if (question_.mass_flow && !question_.inclination && size) {
    refuse_own_tilt(table_);
    return tilt_of_flow();
  }
  throw std::invalid_argument("of tilt, size and mass flow exactly two must be given");
}

/// Where the highest I of the layer, which grows with x, is the highest of the data.
std::optional<FoundChute> Search::end_of_data(const std::function<FoundChute(double)>& flow,
                                              double low,
                                              double high) const {
  const auto& range = table_.range.inertial_number;
  if (!range) return std::nullopt;
  const auto miss = [&](const FoundChute& layer) {
    return excess(layer, highest_inertial_number(layer.steady.profile), range->upper);
  };
  const Bracket end = root([&](double x) { return miss(flow(x)); }, {.low = low, .high = high});
  FoundChute layer = flow(end.nearest());
  if (std::abs(miss(layer)) < 1e-9) return layer;
  return std::nullopt;
}

/// The data end the flow unless the law has its largest before.
void Search::end_by_data(LargestFlow& largest, const std::optional<FoundChute>& data) const {
  largest.ended_by_data = data.has_value();
  if (!data && !largest.law)
    throw NoSuchFlow(
        table_.range.inertial_number
            ? "every steady flow of the law lies at a higher I than the data, and it grows without "
              "limit"
            : "the mass flow of the law grows without limit and the table states no range of I",
        Missed::mass_flow);
  largest.found = data ? *data : *largest.law;
}

/// At the limit of steady flow q of the base grows like 1/(M_limit - M) or faster, so the flow has
/// no bound; only between walls, for rigid grains without cohesion, the limit is met at the surface
/// itself, where it carries nothing.
LargestFlow Search::over_tilts() const {
  refuse_own_tilt(table_);
  const auto flow = [&](double tilt) { return of_size_or_rest(tilt); };
  const Bracket end = last_flowing(flow, a_flowing_tilt(), steepest, 1e-10);
  LargestFlow largest;
  largest.law_limit = end.low;
  largest.law_end = flow(end.high).steady.answer.outcome;
  const ChuteCase& chute = question_.chute;
  double top = end.low;
  if (question_.depth) {
    top = peak(0.0, steepest, std::numeric_limits<double>::infinity());
    largest.law = flow(top);
  } else if (chute.walls && !chute.grains.adhesion && !chute.grains.stiffness) {
    largest.law = flow(top);
  }
  end_by_data(largest, end_of_data(flow, 0.0, top));
  return largest;
}

LargestFlow Search::over_depths() const {
  const double tilt = *question_.inclination;
  const auto flow = [&](double mass) { return at(tilt, mass); };
  const Grown grown = grow(tilt, [](const FoundChute& layer) {
    return flows(layer.steady.answer.outcome) ? -1.0 : beyond(layer.steady.answer.outcome);
  });
  LargestFlow largest;
  largest.law_limit = grown.end.chute.mass_per_area;
  if (grown.found) {
    const Bracket end = root(
        [&](double mass) {
          const Outcome outcome = flow(mass).steady.answer.outcome;
          return flows(outcome) ? -1.0 : beyond(outcome);
        },
        {.low = grown.too_small, .high = largest.law_limit});
    if (end.low <= least_mass_ || !flows(flow(end.low).steady.answer.outcome))
      throw NoSuchFlow(grown.end.steady.answer.text, Missed::mass_flow);
    largest.law_limit = end.low;
    largest.law_end = flow(end.high).steady.answer.outcome;
  } else if (base_rests(grown.end)) {
    largest.law = grown.end;
  } else {
    throw NoSuchFlow(flows(grown.end.steady.answer.outcome)
                         ? "the mass flow grows without limit with the depth: nothing in this law "
                           "ends it at this tilt; give a size"
                         : grown.end.steady.answer.text,
                     Missed::mass_flow);
  }
  end_by_data(largest, end_of_data(flow, least_mass_, largest.law_limit));
  return largest;
}

}  // namespace

FoundChute find_chute(const RheologyTable& table, const ChuteQuestion& question) {
  return Search(table, question).find();
}

LargestFlow largest_flow(const RheologyTable& table, const ChuteQuestion& question) {
  const bool size = question.mass_per_area || question.depth;
  if (question.mass_flow || size == question.inclination.has_value())
    throw std::invalid_argument("the largest flow takes either a tilt or a size");
  return Search(table, question).largest();
}

FoundChute end_of_data(const RheologyTable& table, const ChuteQuestion& question) {
  auto found = Search(table, question).end_of_data_over_tilts();
  if (!found) throw NoSuchFlow("I stays below that of the data", Missed::mass_flow);
  return std::move(*found);
}

}  // namespace grainlaw::continuum
