#include "common/app/standard_streams.hpp"
#include "server/app/options.hpp"
#include "server/app/run.hpp"

#include <fmt/format.h>

#include <sys/stat.h>

#include <csignal>
#include <exception>
#include <iostream>

int main(int argc, char** argv) {
    using namespace scanloom;
    ::umask(077);                                     // only the owner of the store may read the robots' data
    std::signal(SIGPIPE, SIG_IGN);                    // the reader of the output may exit
    const auto hangup = std::signal(SIGHUP, SIG_IGN); // until the server handles it
    try {
        open_missing_standard_streams();
        const auto options = app::read_options(argc, argv);
        if (const auto* leave = std::get_if<Leave>(&options)) {
            (leave->code == kExitDone ? std::cout : std::cerr) << leave->text;
            return leave->code;
        }
        const auto& settings = std::get<app::ServerOptions>(options);
        if (settings.task != app::Task::kServe) std::signal(SIGHUP, hangup);
        return app::run(settings);
    } catch (const std::exception& failure) {
        standard_error().write(fmt::format("scanloom-server: {}\n", failure.what()));
        return kExitFailed;
    }
}
