#pragma once

#include "robot_client/source/pose_path.hpp"

#include <boost/asio/awaitable.hpp>

#include <functional>
#include <string>

namespace scanloom::robot {

/// Reads lines of poses (see pose_lines.hpp) as they come, from a pipe, terminal or socket, which is closed in the end.
/// People are told of the first lines that cannot be used.
/// @return why there will be no more, for people; empty where it was cancelled.
[[nodiscard]] boost::asio::awaitable<std::string> feed_poses(int descriptor,
                                                             std::function<void(const StampedPose&)> on_pose,
                                                             std::function<void(const std::string&)> note);

/// Standard input, open once more, so that other programs that share it (a shell) do not find it non-blocking.
/// @return -1 where that is not possible.
[[nodiscard]] int open_standard_input_again() noexcept;

} // namespace scanloom::robot
