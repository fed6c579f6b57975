// A scanloom-robot that discards the contents of its spool at each start. Used to test the row "spool".
// Usage: broken_robot, and the options of scanloom-robot
#include "robot_client/app/options.hpp"
#include "robot_client/app/run.hpp"

#include <csignal>
#include <filesystem>
#include <vector>

namespace {

void forget(const std::filesystem::path& spool) {
    std::error_code none_yet;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(spool, none_yet)) {
        if (entry.path().extension() == ".spool") files.push_back(entry.path());
    }
    for (const auto& file : files) std::filesystem::remove(file);
}

} // namespace

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);
    const auto options = scanloom::robot::parse_options(argc, argv);
    if (!std::holds_alternative<scanloom::robot::RobotOptions>(options)) return scanloom::kExitUsage;
    const auto& robot = std::get<scanloom::robot::RobotOptions>(options);
    forget(robot.spool);
    return scanloom::robot::run(robot);
}
