#pragma once

#include "common/app/program.hpp"
#include "robot_client/app/replay_options.hpp"
#include "robot_client/ros/recording_plan.hpp"

#include <string>

namespace scanloom::robot {

/// Returns what a recording contains, as lines for people: topics, frames, losses, and the command that replays it.
/// @param options  its path, and the options that the command repeats
/// @param plan     how it is replayed; its error says why it cannot be
[[nodiscard]] std::string info_text(const InfoOptions& options, const RecordingSurvey& found,
                                    const Result<RecordingPlan>& plan);

/// Prints info_text() of a file.
ExitCode run(const InfoOptions& options);

} // namespace scanloom::robot
