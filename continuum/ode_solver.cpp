#include "continuum/ode_solver.h"

#include <cvode/cvode.h>
#include <fmt/format.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunmatrix/sunmatrix_band.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>

#include "continuum/sundials_handles.h"

namespace grainlaw::continuum {
namespace {

struct FreeMatrix {
  void operator()(SUNMatrix matrix) const { SUNMatDestroy(matrix); }
};
struct FreeLinearSolver {
  void operator()(SUNLinearSolver solver) const { SUNLinSolFree(solver); }
};
struct FreeCvode {
  void operator()(void* memory) const { CVodeFree(&memory); }
};
using Matrix = std::unique_ptr<std::remove_pointer_t<SUNMatrix>, FreeMatrix>;
using LinearSolver = std::unique_ptr<std::remove_pointer_t<SUNLinearSolver>, FreeLinearSolver>;
using Cvode = std::unique_ptr<void, FreeCvode>;

/// What the callbacks see: the system, its tolerances, and what went wrong inside them. No
/// exception may cross C.
struct Callback {
  const OdeSystem& system;
  double relative_tolerance;
  double absolute_tolerance;
  std::exception_ptr error;
  std::string message;  // last one of the solver, which would otherwise print it

  template <class Function>
  int guarded(Function&& function) noexcept {
    try {
      function();
      return 0;
    } catch (const StateError&) {
      error = std::current_exception();
      return 1;  // the solver may retry with a smaller step
    } catch (...) {
      error = std::current_exception();
      return -1;
    }
  }
};

int rate(double t, N_Vector y, N_Vector dydt, void* user) {
  auto& callback = *static_cast<Callback*>(user);
  return callback.guarded([&] { callback.system.rate(t, values(y), values(dydt)); });
}

int jacobian(double t,
             N_Vector y,
             N_Vector /*rate*/,
             SUNMatrix matrix,
             void* user,
             N_Vector /*scratch*/,
             N_Vector /*scratch*/,
             N_Vector /*scratch*/) {
  auto& callback = *static_cast<Callback*>(user);
  return callback.guarded([&] {
    const BandView view(SUNBandMatrix_Cols(matrix), SUNBandMatrix_StoredUpperBandwidth(matrix));
    callback.system.jacobian(t, values(y), view);
  });
}

/// Our own weights, since CVODE 6.4 loses its data when scalar tolerances are changed on the way.
int error_weights(N_Vector y, N_Vector weights, void* user) noexcept {
  const auto& callback = *static_cast<const Callback*>(user);
  const auto state = values(y);
  const auto weight = values(weights);
  for (std::size_t i = 0; i < state.size(); ++i)
    weight[i] =
        1.0 / (callback.relative_tolerance * std::abs(state[i]) + callback.absolute_tolerance);
  return 0;
}

int find_events(double t, N_Vector y, double* value, void* user) {
  auto& callback = *static_cast<Callback*>(user);
  return callback.guarded([&] {
    callback.system.events(t, values(y), {value, callback.system.event_count()});
  });
}

void keep_message(int, const char*, const char*, char* message, void* user) noexcept {
  try {
    static_cast<Callback*>(user)->message = message;
  } catch (...) {  // out of memory: the name of the failed call has to do
  }
}

}  // namespace

struct OdeSolver::Implementation {
  Implementation(const OdeSystem& system, std::span<const double> start, const OdeOptions& options)
      : callback{system, options.relative_tolerance, options.absolute_tolerance, {}, {}},
        context(make_context()),
        state(checked(SundialsVector(N_VNew_Serial(static_cast<long>(start.size()), context.get())),
                      "N_VNew_Serial")),
        scratch(checked(SundialsVector(N_VClone(state.get())), "N_VClone")),
        matrix(checked(Matrix(SUNBandMatrix(static_cast<long>(start.size()),
                                            system.bandwidth().upper,
                                            system.bandwidth().lower,
                                            context.get())),
                       "SUNBandMatrix")),
        linear_solver(
            checked(LinearSolver(SUNLinSol_Band(state.get(), matrix.get(), context.get())),
                    "SUNLinSol_Band")),
        cvode(checked(Cvode(CVodeCreate(CV_BDF, context.get())), "CVodeCreate")),
        time_unit(options.time_unit),
        end_time(options.end_time),
        time(options.start_time) {
    std::copy(start.begin(), start.end(), values(state.get()).begin());
    void* memory = cvode.get();
    check(CVodeSetErrHandlerFn(memory, keep_message, &callback), "CVodeSetErrHandlerFn");
    check(CVodeInit(memory, rate, options.start_time, state.get()), "CVodeInit");
    check(CVodeSetUserData(memory, &callback), "CVodeSetUserData");
    check(CVodeWFtolerances(memory, error_weights), "CVodeWFtolerances");
    check(CVodeSetLinearSolver(memory, linear_solver.get(), matrix.get()), "CVodeSetLinearSolver");
    check(CVodeSetJacFn(memory, jacobian), "CVodeSetJacFn");
    // Newton ten times tighter than usual: its noise otherwise costs twice the steps at a yield
    // stress, and hides the approach to a steady state.
    check(CVodeSetNonlinConvCoef(memory, 0.01), "CVodeSetNonlinConvCoef");
    // a yield front leaves kinks: more halvings than usual until a step is short enough for one
    check(CVodeSetMaxErrTestFails(memory, 20), "CVodeSetMaxErrTestFails");
    check(CVodeSetMaxConvFails(memory, 20), "CVodeSetMaxConvFails");
    if (options.stop_at_event)
      check(CVodeRootInit(memory, static_cast<int>(system.event_count()), find_events),
            "CVodeRootInit");
    check(CVodeSetStopTime(memory, options.end_time), "CVodeSetStopTime");
  }

  void check(int flag, const char* call) {
    if (flag >= 0) return;
    if (callback.error) std::rethrow_exception(callback.error);
    throw SolverError(fmt::format("{} failed: {}", call, callback.message));
  }

  /// What the system threw, unless it only refused a state: then its words.
  std::string refusal() const {
    if (!callback.error) return {};
    try {
      std::rethrow_exception(callback.error);
    } catch (const StateError& error) {
      return fmt::format("; {}", error.what());
    }
  }

  [[noreturn]] void fail(int flag) {
    const std::string refused = refusal();
    const std::unique_ptr<char, decltype(&std::free)> flag_name(
        checked(CVodeGetReturnFlagName(flag), "CVodeGetReturnFlagName"), &std::free);
    throw SolverError(fmt::format("the time integration stopped at t = {:.6g}{} with {}: {}{}{}",
                                  time,
                                  time_unit,
                                  flag_name.get(),
                                  callback.message,
                                  fastest(),
                                  refused));
  }

  /// The derivative of this order of the polynomial through the last steps.
  std::vector<double> polynomial(double at, int order) {
    check(CVodeGetDky(cvode.get(), at, order, scratch.get()), "CVodeGetDky");
    const auto found = values(scratch.get());
    return {found.begin(), found.end()};
  }

  /// The unknown that changes fastest in units of its tolerance, in words.
  std::string fastest() {
    try {
      return "; fastest change in " + callback.system.component_name(fastest_component());
    } catch (const StateError&) {
      return {};  // no rates there
    }
  }

  std::size_t fastest_component() {
    const SundialsVector weights = checked(SundialsVector(N_VClone(state.get())), "N_VClone");
    check(CVodeGetErrWeights(cvode.get(), weights.get()), "CVodeGetErrWeights");
    const auto change = values(scratch.get());
    callback.system.rate(time, values(state.get()), change);
    const auto weight = values(weights.get());
    std::size_t fastest = 0;
    for (std::size_t i = 1; i < change.size(); ++i)
      if (std::abs(change[i] * weight[i]) > std::abs(change[fastest] * weight[fastest]))
        fastest = i;
    return fastest;
  }

  Callback callback;  // its address is known to CVODE: this struct never moves
  SundialsContext context;
  SundialsVector state;
  SundialsVector scratch;
  Matrix matrix;
  LinearSolver linear_solver;
  Cvode cvode;
  std::string time_unit;
  double end_time;
  double time;
};

OdeSolver::OdeSolver(const OdeSystem& system,
                     std::span<const double> start,
                     const OdeOptions& options)
    : self_(std::make_unique<Implementation>(system, start, options)) {}

OdeSolver::~OdeSolver() = default;

OdeSolver::Step OdeSolver::step() {
  auto& self = *self_;
  const int flag =
      CVode(self.cvode.get(), self.end_time, self.state.get(), &self.time, CV_ONE_STEP);
  if (flag < 0) self.fail(flag);
  self.callback.error = nullptr;  // of a state that was refused and then avoided
  if (flag == CV_ROOT_RETURN) return Step::event;
  return flag == CV_TSTOP_RETURN ? Step::end : Step::advanced;
}

OdeEvent OdeSolver::event() const {
  std::vector<int> roots(self_->callback.system.event_count());
  self_->check(CVodeGetRootInfo(self_->cvode.get(), roots.data()), "CVodeGetRootInfo");
  for (std::size_t i = 0; i < roots.size(); ++i)
    if (roots[i] != 0) return {.index = i, .rising = roots[i] > 0};
  return {};
}

void OdeSolver::tighten(double factor) {
  self_->callback.relative_tolerance *= factor;
  self_->callback.absolute_tolerance *= factor;
}

double OdeSolver::time() const {
  return self_->time;
}

std::span<const double> OdeSolver::state() const {
  return values(self_->state.get());
}

std::vector<double> OdeSolver::interpolate(double time) const {
  return self_->polynomial(time, 0);
}

std::vector<double> OdeSolver::derivative() const {
  return self_->polynomial(self_->time, 1);
}

SolverStatistics OdeSolver::statistics() const {
  void* memory = self_->cvode.get();
  SolverStatistics statistics;
  const auto count = [&](auto get, long& number, const char* call) {
    self_->check(get(memory, &number), call);
  };
  count(CVodeGetNumSteps, statistics.steps, "CVodeGetNumSteps");
  count(CVodeGetNumRhsEvals, statistics.rhs_evaluations, "CVodeGetNumRhsEvals");
  count(CVodeGetNumJacEvals, statistics.jacobian_evaluations, "CVodeGetNumJacEvals");
  count(CVodeGetNumErrTestFails, statistics.error_test_failures, "CVodeGetNumErrTestFails");
  count(
      CVodeGetNumNonlinSolvConvFails, statistics.newton_failures, "CVodeGetNumNonlinSolvConvFails");
  return statistics;
}

}  // namespace grainlaw::continuum
