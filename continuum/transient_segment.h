#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "continuum/chute_1d.h"
#include "continuum/transient_system.h"

namespace grainlaw::continuum {

/// Whether part of a layer may rest while other parts shear: a yield stress that is not
/// proportional to the depth (a proportional one lets the whole layer start as one block), or a
/// viscous stress too steep at rest for the shear rate to be the state.
bool may_rest_in_part(const Layer& layer);

/// Why an integration ended.
enum class End { steady, arrested, dense_state_lost, time_limit, step_limit, failed };

/// A layer at one tilt on its way from a given motion, units d = rho_p = g = 1.
class Segment {
 public:
  /// What a caller sees of every step and event.
  struct Observer {
    std::function<void(double time, const std::function<Motion(double)>& motion_at)> passed;
    std::function<void(ChuteEvent::Kind, double time)> happened;
    std::function<void(double time, double mean_velocity)> mean_velocity;
  };
  struct Result {
    End end = End::time_limit;
    Motion motion{};
    double time = 0.0;
    double stopped_at = 0.0;  ///< with End::arrested
    double largest_acceleration = 0.0;
    double surface_acceleration = 0.0;
    std::string failure{};  ///< with End::failed
  };

  /// `options` in the units of the layer.
  Segment(const Layer& layer, const TransientOptions& options, Motion start);

  /// From `begin` to `end`; stops early when steady (`may_stop`, asked after every step), when the
  /// dense state is lost, or when nothing moves any more.
  Result run(double begin,
             double end,
             const std::function<bool()>& may_stop,
             const Observer& observer,
             SolverStatistics& statistics) const;

  const Verdict& verdict() const { return verdict_; }
  const DiscreteLayer& discrete() const { return system_->discrete(); }
  double regularisation() const { return delta_; }
  double settling_time() const { return settling_time_; }  ///< 0: no steady flow lies ahead
  double time_needed() const;                              ///< for the answer, generously

 private:
  bool at_rest() const;
  bool settled(double since, const OdeSolver& solver) const;
  Result integrate(OdeSolver& solver,
                   double begin,
                   const std::function<bool()>& may_stop,
                   const Observer& observer) const;
  Result rest(double begin, double end, const Observer& observer) const;

  Verdict verdict_;
  const TransientOptions& options_;
  Motion start_;
  double delta_ = 0.0;
  double elastic_time_ = 0.0;
  double settling_time_ = 0.0;
  std::unique_ptr<TransientSystem> system_;
};

}  // namespace grainlaw::continuum
