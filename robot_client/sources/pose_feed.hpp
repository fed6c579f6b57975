#pragma once

#include "robot_client/sources/pose_path.hpp"

#include <boost/asio/awaitable.hpp>

#include <functional>
#include <string>

namespace scanloom::robot {

/// Reads lines of poses (see pose_path.hpp) as they arrive from a pipe, terminal or socket, and closes it at the end.
/// The first lines that cannot be used are reported to `note`.
/// @return why no more poses arrive, for people; empty if cancelled
[[nodiscard]] boost::asio::awaitable<std::string> feed_poses(int descriptor,
                                                             std::function<void(const StampedPose&)> on_pose,
                                                             std::function<void(const std::string&)> note);

/// Opens standard input again, so that other programs that share it (a shell) do not find it non-blocking.
/// @return a new descriptor, or -1 if that is not possible
[[nodiscard]] int open_standard_input_again() noexcept;

} // namespace scanloom::robot
