#pragma once

#include "common/app/program.hpp"
#include "common/error/error.hpp"
#include "robot_client/app/options.hpp"

#include <string>

namespace scanloom::robot {

/// Writes the ground truth of a world as PREFIX.pgm and PREFIX.yaml; creates their folder.
/// @return one line of JSON with the size of the map and the paths of the files
/// Errors: those of load_world(); kTooLarge if the map has more than kRosImagePixelsMax cells; kStoreFailed if a file
///         or folder cannot be written or created; the message names it.
[[nodiscard]] Result<std::string> write_ground_truth(const GroundTruthOptions& options);

/// Runs write_ground_truth() as a program: prints its line to stdout or its error to stderr.
[[nodiscard]] ExitCode run(const GroundTruthOptions& options);

} // namespace scanloom::robot
