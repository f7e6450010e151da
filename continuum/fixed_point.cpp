#include "continuum/fixed_point.h"

#include <kinsol/kinsol.h>

#include <algorithm>
#include <exception>
#include <string>

#include "continuum/sundials_handles.h"

namespace grainlaw::continuum {
namespace {

struct FreeKinsol {
  void operator()(void* memory) const { KINFree(&memory); }
};
using Kinsol = std::unique_ptr<void, FreeKinsol>;

/// What the callbacks see. No exception may cross C.
struct Callback {
  const std::function<void(std::span<const double>, std::span<double>)>& map;
  std::exception_ptr error{};
  std::string message{};
};

int image(N_Vector x, N_Vector result, void* user) noexcept {
  auto& callback = *static_cast<Callback*>(user);
  try {
    callback.map(values(x), values(result));
    return 0;
  } catch (...) {
    callback.error = std::current_exception();
    return -1;
  }
}

void keep_message(int, const char*, const char*, char* message, void* user) noexcept {
  try {
    static_cast<Callback*>(user)->message = message;
  } catch (...) {  // out of memory: the name of the failed call has to do
  }
}

}  // namespace

FixedPoint solve_fixed_point(
    const std::function<void(std::span<const double> x, std::span<double> image)>& map,
    std::span<const double> start,
    const FixedPointOptions& options) {
  Callback callback{.map = map};
  const SundialsContext context = make_context();
  const SundialsVector x =
      checked(SundialsVector(N_VNew_Serial(static_cast<long>(start.size()), context.get())),
              "N_VNew_Serial");
  const SundialsVector scale = checked(SundialsVector(N_VClone(x.get())), "N_VClone");
  std::ranges::copy(start, values(x.get()).begin());
  N_VConst(1.0, scale.get());
  const Kinsol kinsol = checked(Kinsol(KINCreate(context.get())), "KINCreate");
  void* memory = kinsol.get();
  const auto check = [&](int flag, const char* call) {
    if (flag >= 0) return;
    if (callback.error) std::rethrow_exception(callback.error);
    throw SolverError(fmt::format("{} failed: {}", call, callback.message));
  };
  check(KINSetErrHandlerFn(memory, keep_message, &callback), "KINSetErrHandlerFn");
  check(KINSetUserData(memory, &callback), "KINSetUserData");
  check(KINSetMAA(memory, options.memory), "KINSetMAA");
  check(KINSetNumMaxIters(memory, options.most_iterations), "KINSetNumMaxIters");
  check(KINInit(memory, image, x.get()), "KINInit");
  check(KINSetFuncNormTol(memory, options.tolerance), "KINSetFuncNormTol");
  const int flag = KINSol(memory, x.get(), KIN_FP, scale.get(), scale.get());
  if (flag != KIN_MAXITER_REACHED) check(flag, "KINSol");
  FixedPoint result{.x = {}, .converged = flag >= 0};
  const auto found = values(x.get());
  result.x.assign(found.begin(), found.end());
  long iterations = 0;
  check(KINGetNumNonlinSolvIters(memory, &iterations), "KINGetNumNonlinSolvIters");
  result.iterations = static_cast<int>(iterations);
  return result;
}

}  // namespace grainlaw::continuum
