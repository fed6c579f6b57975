#include "server/app/run.hpp"

#include "common/app/machine.hpp"
#include "common/app/standard_streams.hpp"
#include "server/app/guards.hpp"
#include "server/app/options.hpp"
#include "server/app/resource_limits.hpp"
#include "server/app/server.hpp"
#include "server/app/standard_error_sink.hpp"
#include "server/app/store_commands.hpp"
#include "server/log/context.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <iostream>
#include <memory>
#include <variant>

namespace scanloom::app {
namespace {

int report_failure(const Error& why) {
    standard_error().write(fmt::format("scanloom-server: {}\n", why.message));
    return kExitFailed;
}

void set_up_log(const ServerOptions& options) {
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("scanloom-server", standard_error_sink()));
    if (options.log_format == "json") {
        spdlog::set_formatter(std::make_unique<log::JsonFormatter>());
    } else {
        spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
    }
    spdlog::set_level(spdlog::level::from_str(options.log_level));
}

int run(const ServerOptions& options) {
    set_up_log(options);
    const auto memory = memory_limit();
    save_address_space(memory);
    const auto descriptors = allow_as_many_descriptors_as_possible();
    switch (options.task) {
    case Task::kCheck:
    case Task::kCheckMaps: return check_store(options);
    case Task::kRepair: return repair_store(options);
    case Task::kRestore: return restore_store(options);
    case Task::kCopy: return copy_store(options);
    case Task::kServe: break;
    }
    if (auto fits = check_address_space(options, memory); !fits) return report_failure(fits.error());
    if (const auto short_of = shortage(descriptors); !short_of.empty()) spdlog::warn("{}", short_of);
    for (const auto& warning : guard_warnings(options)) spdlog::warn("{}", warning);
    auto server = Server::open(options, limits_within(descriptors));
    auto ended = server ? (*server)->run() : Result<>(server.error());
    return ended ? kExitDone : report_failure(ended.error());
}

} // namespace

int run(int argc, const char* const* argv) {
    const auto hangup = std::signal(SIGHUP, SIG_IGN); // until the server handles it
    const auto options = read_options(argc, argv);
    if (const auto* leave = std::get_if<Leave>(&options)) {
        (leave->code == kExitDone ? std::cout : std::cerr) << leave->text;
        return leave->code;
    }
    const auto& settings = std::get<ServerOptions>(options);
    if (settings.task != Task::kServe) std::signal(SIGHUP, hangup);
    return run(settings);
}

} // namespace scanloom::app
