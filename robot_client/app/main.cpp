#include "common/app/standard_streams.hpp"
#include "robot_client/app/run.hpp"

#include <fmt/format.h>

#include <csignal>
#include <exception>

int main(int argc, char** argv) try {
    std::signal(SIGPIPE, SIG_IGN); // the reader of the output may exit
    std::signal(SIGXFSZ, SIG_IGN); // then exceeding the file size limit is a write error, which is reported
    scanloom::open_missing_standard_streams();
    return scanloom::robot::run(argc, argv);
} catch (const std::exception& error) {
    scanloom::standard_error().write(fmt::format("scanloom-robot: {}\n", error.what()));
    return scanloom::kExitFailed;
}
