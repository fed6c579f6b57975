#pragma once

#include "common/app/standard_streams.hpp"
#include "robot_client/app/options.hpp"
#include "robot_client/foxglove/foxglove_source.hpp"

#include <boost/asio/io_context.hpp>

#include <memory>

namespace scanloom::robot {

/// Makes the source of a robot that runs foxglove_bridge. It is not connected yet: see survey_robot().
/// Errors: those of the files with tokens and certificates.
[[nodiscard]] Result<std::unique_ptr<FoxgloveSource>> make_foxglove(const RobotOptions& options,
                                                                    const FoxgloveOptions& foxglove, Console& console);

/// Runs `io` until the source has connected and knows what the robot's poses are. Afterwards the source goes on when
/// `io` runs again.
/// Errors: those of FoxgloveSource::prepare(); kShuttingDown if a signal interrupts it.
[[nodiscard]] Result<Poses> survey_robot(boost::asio::io_context& io, FoxgloveSource& source);

} // namespace scanloom::robot
