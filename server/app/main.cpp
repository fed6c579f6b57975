#include "common/app/standard_streams.hpp"
#include "server/app/options.hpp"
#include "server/app/resource_limits.hpp"
#include "server/app/server.hpp"
#include "server/app/standard_error_sink.hpp"
#include "server/app/store_commands.hpp"
#include "server/log/context.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <sys/stat.h>

#include <csignal>
#include <exception>
#include <iostream>

namespace {

using namespace scanloom;

int failed(const Error& why) {
    standard_error().write(fmt::format("scanloom-server: {}\n", why.message));
    return kExitFailed;
}

int run(const app::ServerOptions& options) {
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("scanloom-server", app::standard_error_sink()));
    if (options.log_format == "json") {
        spdlog::set_formatter(std::make_unique<log::JsonFormatter>());
    } else {
        spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
    }
    spdlog::set_level(spdlog::level::from_str(options.log_level));
    const auto memory = memory_limit();
    app::save_address_space(memory);
    const auto descriptors = app::allow_as_many_descriptors_as_possible();
    switch (options.task) {
    case app::Task::kCheck:
    case app::Task::kCheckMaps: return app::check_store(options);
    case app::Task::kRepair: return app::repair_store(options);
    case app::Task::kRestore: return app::restore_store(options);
    case app::Task::kServe: break;
    }
    if (auto fits = app::check_address_space(options, memory); !fits) return failed(fits.error());
    if (const auto short_of = app::shortage(descriptors); !short_of.empty()) spdlog::warn("{}", short_of);
    for (const auto& warning : app::guard_warnings(options)) spdlog::warn("{}", warning);
    auto server = app::Server::open(options, app::limits_within(descriptors));
    auto ended = server ? (*server)->run() : Result<>(server.error());
    return ended ? kExitDone : failed(ended.error());
}

} // namespace

int main(int argc, char** argv) {
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
        return run(settings);
    } catch (const std::exception& failure) {
        standard_error().write(fmt::format("scanloom-server: {}\n", failure.what()));
        return kExitFailed;
    }
}
