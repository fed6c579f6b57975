#include "server/app/repair_command.hpp"

#include "common/app/standard_streams.hpp"
#include "common/json/json_text.hpp"
#include "server/sessions/repair.hpp"
#include "server/sessions/repaired_names.hpp"
#include "server/store/damaged_store.hpp"
#include "server/store/unfinished_store.hpp"

#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <chrono>
#include <iostream>

namespace scanloom::app {
namespace {

namespace fs = std::filesystem;

/// Returns the directory's path with `ending` appended to its name, also if the path ends with a slash.
fs::path sibling_path(const fs::path& directory, const char* ending) {
    const auto absolute = fs::absolute(directory).lexically_normal();
    auto path = absolute.has_filename() ? absolute : absolute.parent_path();
    return path += ending;
}

std::string line_of(const session::RepairedSession& session) {
    auto line = fmt::format("{}: {} entries kept", session.name, session.kept);
    if (session.missing > 0) line += fmt::format(", {} lost", session.missing);
    if (session.stood_in > 0) line += fmt::format(" ({} scans stood in for by empty ones)", session.stood_in);
    if (session.set_aside > 0) {
        line += fmt::format(", {} that cannot be applied in {}", session.set_aside, session.aside.native());
    }
    return line + "\n";
}

/// Totals over all sessions.
struct Sum {
    std::uint64_t sessions = 0;
    std::uint64_t kept = 0;
    std::uint64_t missing = 0;
    std::uint64_t stood_in = 0;
    std::uint64_t set_aside = 0;
    std::size_t damaged_files = 0; // of the old store

    void add(const session::RepairedSession& session) {
        ++sessions;
        kept += session.kept;
        missing += session.missing;
        stood_in += session.stood_in;
        set_aside += session.set_aside;
    }
};

/// Writes the intact entries of all sessions to the new store, and closes it.
Result<Sum> save(const store::DamagedStore& from, const store::UnfinishedStore& to, const fs::path& lost) {
    const auto repaired = to.open_log();
    if (!repaired) return repaired.error();
    Sum sum;
    const auto names = session::repaired_names(from.sessions());
    for (const auto& [id, record] : from.sessions()) {
        const auto session = session::repair_session(from, id, record, names.at(id), **repaired, lost);
        if (!session) return session.error();
        std::cout << line_of(*session) << std::flush;
        sum.add(*session);
    }
    return sum;
}

Result<Sum> repair(const ServerOptions& options) {
    const auto lost = sibling_path(options.repaired, ".lost");
    auto unfinished = store::UnfinishedStore::begin(options.repaired, lost);
    if (!unfinished) return unfinished.error();
    const auto damaged = store::DamagedStore::open(options.store);
    if (!damaged) return damaged.error();
    for (const auto& note : (*damaged)->notes()) standard_error().write(fmt::format("scanloom-server: {}\n", note));
    auto sum = save(**damaged, *unfinished, lost);
    if (!sum) return sum;
    sum->damaged_files = (*damaged)->damaged_files();
    if (auto finished = unfinished->finish(); !finished) return finished.error();
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
        {"event", "repaired"},         {"damaged_files", sum->damaged_files},
        {"sessions", sum->sessions},   {"kept", sum->kept},
        {"lost", sum->missing},        {"stood_in", sum->stood_in},
        {"set_aside", sum->set_aside}, {"seconds", seconds.count()},
    };
    std::cout << json_text(summary) << std::endl;
    return kExitDone;
}

} // namespace scanloom::app
