#include "robot_client/app/options.hpp"
#include "robot_client/app/run.hpp"

#include <fmt/format.h>

#include <exception>

int main(int argc, char** argv) try {
    const auto options = scanloom::robot::parse_options(argc, argv);
    if (const auto* leave = std::get_if<scanloom::robot::Leave>(&options)) {
        fmt::print(leave->code == scanloom::kExitDone ? stdout : stderr, "{}", leave->text);
        return leave->code;
    }
    return scanloom::robot::run(std::get<scanloom::robot::RobotOptions>(options));
} catch (const std::exception& error) {
    fmt::print(stderr, "scanloom-robot: {}\n", error.what());
    return scanloom::kExitFailed;
}
