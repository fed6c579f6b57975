#pragma once

#include "robot_client/spool/spool.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

/// Functions for robots that wait for a server, shared by the program and the client library.
namespace scanloom::robot {

using Tell = std::function<void(const std::string&)>;

/// Opens the robot's spool, the directory SESSION.ROBOT in SpoolOptions::directory. Returns null if that is empty.
/// Errors: those of Spool::open().
[[nodiscard]] Result<std::unique_ptr<Spool>> open_spool_of(const std::string& session, const std::string& robot,
                                                           SpoolOptions options, const Tell& tell);

/// Makes a UplinkOptions::on_trouble that reports repeated identical errors only once.
[[nodiscard]] std::function<void(const Error&)> told_once(Tell tell);

} // namespace scanloom::robot
