#include "common/app/standard_streams.hpp"
#include "robot_client/app/info.hpp"
#include "robot_client/app/lidars.hpp"
#include "robot_client/app/options.hpp"
#include "robot_client/app/run.hpp"
#include "robot_client/app/truth.hpp"

#include <fmt/format.h>

#include <csignal>
#include <exception>

int main(int argc, char** argv) try {
    std::signal(SIGPIPE, SIG_IGN); // the reader of the output may exit
    std::signal(SIGXFSZ, SIG_IGN); // then exceeding the file size limit is a write error, which is reported
    scanloom::open_missing_standard_streams();
    const auto options = scanloom::robot::parse_options(argc, argv);
    if (const auto* leave = std::get_if<scanloom::Leave>(&options)) {
        fmt::print(leave->code == scanloom::kExitDone ? stdout : stderr, "{}", leave->text);
        return leave->code;
    }
    if (const auto* truth = std::get_if<scanloom::robot::GroundTruthOptions>(&options))
        return scanloom::robot::run(*truth);
    if (const auto* info = std::get_if<scanloom::robot::InfoOptions>(&options)) return scanloom::robot::run(*info);
    if (const auto* lidars = std::get_if<scanloom::robot::LidarsOptions>(&options))
        return scanloom::robot::run(*lidars);
    return scanloom::robot::run(std::get<scanloom::robot::RobotOptions>(options));
} catch (const std::exception& error) {
    scanloom::standard_error().write(fmt::format("scanloom-robot: {}\n", error.what()));
    return scanloom::kExitFailed;
}
