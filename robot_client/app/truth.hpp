#pragma once

#include "common/app/program.hpp"
#include "common/error/error.hpp"
#include "robot_client/app/options.hpp"

#include <string>

namespace scanloom::robot {

/// Writes the truth of a world as PREFIX.pgm and PREFIX.yaml; makes their folder.
/// @return  one line of JSON: the size of the map and where it is.
/// Errors   those of load_world(); kTooLarge: of more than kRosImagePixelsMax cells; kStoreFailed: a file or folder
///          that cannot be written or made, naming it.
[[nodiscard]] Result<std::string> write_truth(const TruthOptions& options);

/// The same as a program: the line goes to stdout, an error to stderr.
[[nodiscard]] ExitCode run(const TruthOptions& options);

} // namespace scanloom::robot
