#pragma once

#include <functional>
#include <string>

#include "apps/exit_code.h"

namespace grainlaw {

/// Runs the body of a program and turns every exception into one message on stderr and an exit
/// code; no exception and no stack trace ever reaches the person.
int run_program(const char* name, const std::function<ExitCode()>& body);

/// From here on SIGINT and SIGTERM set a flag instead of ending the process.
void catch_stop_signals();
bool stop_requested();

/// Processor and number of cores, for statements about run time.
std::string machine();

}  // namespace grainlaw
