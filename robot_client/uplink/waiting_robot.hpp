#pragma once

#include "robot_client/spool/spool.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

/// What every robot does that waits for a server, the program's and that of the client library.
namespace scanloom::robot {

using Tell = std::function<void(const std::string&)>;

/// Opens the robot's spool, SESSION.ROBOT within SpoolOptions::directory; null where that is empty.
/// Errors  those of Spool::open().
[[nodiscard]] Result<std::unique_ptr<Spool>> open_spool_of(const std::string& session, const std::string& robot,
                                                           SpoolOptions options, const Tell& tell);

/// For UplinkOptions::on_trouble: a server that is away for long is told once.
[[nodiscard]] std::function<void(const Error&)> told_once(Tell tell);

} // namespace scanloom::robot
