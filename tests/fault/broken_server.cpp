// scanloom-server with a log or a disk that breaks its promises: what the rows of faults are tried on.
// Usage: broken_server hasty|forgetful|blind|unsynced, and the options of scanloom-server
#include "server/app/options.hpp"
#include "server/app/server.hpp"
#include "tests/fault/broken_logs.hpp"
#include "tests/fault/unsynced_files.hpp"

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
    spdlog::set_level(spdlog::level::err);
    const auto unsynced = fault::unsynced_files();
    const auto open_log = [&](const std::filesystem::path& directory,
                              store::StoreOptions store) -> Result<std::unique_ptr<store::ScanLog>> {
        if (kind == "unsynced") store.env = unsynced.get();
        auto log = store::open_rocksdb(directory, store);
        if (!log || kind == "unsynced") return log;
        return fault::broken_log(kind, std::move(*log));
    };
    auto server = app::Server::open(std::get<app::ServerOptions>(options), {}, open_log);
    const auto ended = server ? (*server)->run() : Result<>(server.error());
    if (ended) return kExitDone;
    std::fprintf(stderr, "broken_server: %s\n", ended.error().message.c_str());
    return kExitFailed;
}
