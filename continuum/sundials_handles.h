#pragma once

#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <memory>
#include <span>
#include <type_traits>

#include "continuum/answer.h"

namespace grainlaw::continuum {

static_assert(std::is_same_v<sunrealtype, double>);

struct FreeContext {
  void operator()(SUNContext context) const { SUNContext_Free(&context); }
};
struct FreeVector {
  void operator()(N_Vector vector) const { N_VDestroy(vector); }
};
using SundialsContext = std::unique_ptr<std::remove_pointer_t<SUNContext>, FreeContext>;
using SundialsVector = std::unique_ptr<std::remove_pointer_t<N_Vector>, FreeVector>;

/// The handle, or SolverError where the call that made it failed.
template <class Handle>
Handle checked(Handle handle, const char* call) {
  if (!handle) throw SolverError(fmt::format("{} failed (out of memory?)", call));
  return handle;
}

inline SundialsContext make_context() {
  SUNContext context = nullptr;
  if (SUNContext_Create(nullptr, &context) != 0) throw SolverError("SUNContext_Create failed");
  return SundialsContext(context);
}

inline std::span<double> values(N_Vector vector) {
  return {N_VGetArrayPointer(vector), static_cast<std::size_t>(N_VGetLength(vector))};
}

}  // namespace grainlaw::continuum
