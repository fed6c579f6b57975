#include "server/app/repair_command.hpp"

#include "common/app/standard_error.hpp"
#include "common/json/json_text.hpp"
#include "server/session/repair.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <chrono>
#include <iostream>
#include <system_error>

namespace scanloom::app {
namespace {

namespace fs = std::filesystem;

/// NEW with something behind its name, also where that ends with a slash.
fs::path beside(const fs::path& directory, const char* ending) {
    const auto absolute = fs::absolute(directory).lexically_normal();
    auto path = absolute.has_filename() ? absolute : absolute.parent_path();
    return path += ending;
}

Result<> check_empty(const fs::path& directory) {
    std::error_code problem;
    if (!fs::exists(directory, problem)) return {};
    if (fs::is_directory(directory, problem) && fs::is_empty(directory, problem)) return {};
    return Error{Errc::kConflict, fmt::format("--repair {}: it is not empty; name a directory that does not exist yet",
                                              directory.native())};
}

std::string line_of(const session::RepairedSession& session) {
    auto line = fmt::format("{}: {} entries kept", session.name, session.kept);
    if (session.missing > 0) line += fmt::format(", {} lost", session.missing);
    if (session.stood_in > 0) line += fmt::format(" ({} scans stood in for by empty ones)", session.stood_in);
    if (session.set_aside > 0) {
        line += fmt::format(", {} that cannot be woven in {}", session.set_aside, session.aside.native());
    }
    return line + "\n";
}

/// Of all sessions together.
struct Sum {
    std::uint64_t sessions = 0;
    std::uint64_t kept = 0;
    std::uint64_t missing = 0;
    std::uint64_t stood_in = 0;
    std::uint64_t set_aside = 0;

    void add(const session::RepairedSession& session) {
        ++sessions;
        kept += session.kept;
        missing += session.missing;
        stood_in += session.stood_in;
        set_aside += session.set_aside;
    }
};

Result<Sum> repair(const ServerOptions& options) {
    for (const auto& made : {options.repaired, beside(options.repaired, ".lost")}) {
        if (auto empty = check_empty(made); !empty) return empty.error();
    }
    const auto salvage = store::Salvage::open(options.store, beside(options.repaired, ".salvage"));
    if (!salvage) return salvage.error();
    for (const auto& note : (*salvage)->notes()) standard_error().write(fmt::format("scanloom-server: {}\n", note));
    const auto repaired = store::open_rocksdb(options.repaired);
    if (!repaired) return repaired.error();
    Sum sum;
    for (const auto& [id, record] : (*salvage)->sessions()) {
        const auto session =
            session::repair_session(**salvage, id, record, **repaired, beside(options.repaired, ".lost"));
        if (!session) return session.error();
        std::cout << line_of(*session) << std::flush;
        sum.add(*session);
    }
    return sum;
}

} // namespace

ExitCode repair_store(const ServerOptions& options) {
    const auto begin = std::chrono::steady_clock::now();
    const auto sum = repair(options);
    if (!sum) {
        standard_error().write(fmt::format("scanloom-server: {}\n", sum.error().message));
        return kExitFailed;
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    const boost::json::object summary{
        {"event", "repaired"},       {"sessions", sum->sessions},   {"kept", sum->kept},         {"lost", sum->missing},
        {"stood_in", sum->stood_in}, {"set_aside", sum->set_aside}, {"seconds", seconds.count()}};
    std::cout << json_text(summary) << std::endl;
    return kExitDone;
}

} // namespace scanloom::app
