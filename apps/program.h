#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/exit_code.h"

namespace grainlaw {

/// Runs the body of a program and turns every exception into one message on stderr and an exit
/// code; no exception and no stack trace ever reaches the person.
int run_program(const std::string& name, const std::function<ExitCode()>& body);

/// Writes a line to stderr; a closed or full stderr is no reason to end a run.
void say(std::string_view line);

/// From here on SIGINT, SIGTERM and SIGHUP set a flag instead of ending the process, and a limit on
/// the size of files makes writing fail instead. The flag is also set after this many seconds
/// (--max-wall); 0: never.
void catch_stop_signals(double max_wall);

/// Asks to stop this many seconds from now.
void stop_after(double seconds);

/// By a signal or because the time is up.
bool stop_requested();

/// "by a signal" or "because --max-wall is over".
const char* stop_reason();

/// Throws io::InputError when an output path names one of the inputs.
void refuse_overwriting_input(const std::string& output, const std::vector<std::string>& inputs);

/// Throws io::InputError when a text is to be written over an HDF5 file, hours of DEM, or over a
/// TOML file, which somebody wrote by hand or fitted.
void refuse_overwriting_run(const std::string& output);

/// Throws io::FileError when no file can be written at this path.
void require_writable(const std::string& path);

/// A word that a shell takes as it is, in quotes where it must be.
std::string shell_word(const std::string& text);

/// An option and the words that follow it, or the words alone, with a blank before each; nothing
/// where there are no words.
std::string option_text(const std::string& name, const std::vector<std::string>& words);

/// Processor and number of cores, for statements about run time.
std::string machine();

}  // namespace grainlaw
