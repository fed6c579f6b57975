// A scanloom-server with a log, a disk or sockets that break their guarantees. Used to test the rows of faults.
// Usage: broken_server KIND OPTIONS...
// KIND is one of broken_logs.hpp, broken_files.hpp or broken_sockets.hpp, or "usurping" or "retrying", and OPTIONS are
// those of scanloom-server.
#include "server/app/options.hpp"
#include "server/app/server.hpp"
#include "server/app/standard_error_sink.hpp"
#include "server/store/open_store.hpp"
#include "tests/fault/broken_database_logs.hpp"
#include "tests/fault/broken_files.hpp"
#include "tests/fault/broken_logs.hpp"
#include "tests/fault/broken_sockets.hpp"

#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdio>

int main(int argc, char** argv) {
    using namespace scanloom;
    if (argc < 2) return kExitUsage;
    std::signal(SIGPIPE, SIG_IGN);
    const std::string kind = argv[1];
    const auto options = app::read_options(argc - 1, argv + 1);
    if (!std::holds_alternative<app::ServerOptions>(options)) return kExitUsage;
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("broken_server", app::standard_error_sink()));
    fault::break_sockets(kind);
    const auto files = kind == "unsynced"   ? fault::unsynced_files()
                       : kind == "trusting" ? fault::trusting_files()
                                            : nullptr;
    const auto open_log = [&](const std::filesystem::path& directory,
                              store::StoreOptions store) -> Result<std::unique_ptr<store::ScanLog>> {
        store.env = files.get();
        auto log = store::open_store(directory, store);
        if (!log) return log;
        if (kind == "usurping") return fault::usurping_log(std::move(*log), directory);
        if (kind == "retrying") return fault::retrying_log(std::move(*log));
        return fault::broken_log(kind, std::move(*log));
    };
    auto server = app::Server::open(std::get<app::ServerOptions>(options), {}, open_log);
    const auto ended = server ? (*server)->run() : Result<>(server.error());
    if (ended) return kExitDone;
    std::fprintf(stderr, "broken_server: %s\n", ended.error().message.c_str());
    return kExitFailed;
}
