#include "common/app/program.hpp"
#include "common/app/standard_streams.hpp"
#include "server/app/run.hpp"

#include <fmt/format.h>

#include <sys/stat.h>

#include <csignal>
#include <exception>

int main(int argc, char** argv) try {
    ::umask(077);                  // only the owner of the store may read the robots' data
    std::signal(SIGPIPE, SIG_IGN); // the reader of the output may exit
    scanloom::open_missing_standard_streams();
    return scanloom::app::run(argc, argv);
} catch (const std::exception& failure) {
    scanloom::standard_error().write(fmt::format("scanloom-server: {}\n", failure.what()));
    return scanloom::kExitFailed;
}
