#include "robot_client/uplink/waiting_robot.hpp"

#include "common/error/further.hpp"

#include <fmt/format.h>

#include <utility>

namespace scanloom::robot {

Result<std::unique_ptr<Spool>> open_spool_of(const std::string& session, const std::string& robot, SpoolOptions options,
                                             const Tell& tell) {
    if (options.directory.empty()) return std::unique_ptr<Spool>{};
    options.directory /= fmt::format("{}.{}", session, robot);
    return Spool::open(std::move(options), tell);
}

std::function<void(const Error&)> told_once(Tell tell) {
    return [tell = std::move(tell), told = std::string()](const Error& error) mutable {
        if (error.message == std::exchange(told, error.message)) return;
        tell(further(error.message, "trying again"));
    };
}

} // namespace scanloom::robot
