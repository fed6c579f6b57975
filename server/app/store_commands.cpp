#include "server/app/store_commands.hpp"

#include "common/app/standard_streams.hpp"
#include "common/json/json_text.hpp"
#include "server/sessions/repair.hpp"
#include "server/sessions/session_check.hpp"
#include "server/store/backups.hpp"
#include "server/store/copy.hpp"
#include "server/store/damaged_store.hpp"
#include "server/store/files.hpp"
#include "server/store/open_store.hpp"
#include "server/store/unfinished_store.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <iostream>

namespace scanloom::app {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// Prints the summary of a command, as its last line.
void print(const boost::json::object& summary) { std::cout << json_text(summary) << std::endl; }

ExitCode failed(const Error& why) {
    standard_error().write(fmt::format("scanloom-server: {}\n", why.message));
    return kExitFailed;
}

/// Progress is printed each time this many entries and parts have been read.
constexpr std::uint64_t kProgressEvery = 100'000;

/// Prints the findings, and counts them for the summary.
class Findings {
public:
    void whole(const sessions::SessionCheck& session) {
        count(session);
        std::cout << fmt::format("{}: {} entries, whole\n", session.name, session.entries) << std::flush;
    }

    void damaged(const sessions::SessionCheck& session) {
        count(session);
        std::cout << fmt::format("{}: {} entries, then DAMAGED: {}\n", session.name, session.entries,
                                 session.damage->message)
                  << std::flush;
        damaged_.push_back(boost::json::object{{"session", session.name}, {"reason", session.damage->message}});
    }

    void store_damaged(const Error& why) {
        std::cout << fmt::format("DAMAGED: {}\n", why.message) << std::flush;
        damaged_.push_back(boost::json::object{{"reason", why.message}});
    }

    /// Prints the summary, as the last line.
    [[nodiscard]] ExitCode conclude(double seconds) const {
        const boost::json::object summary{{"event", "checked"},
                                          {"sessions", sessions_},
                                          {"entries", entries_},
                                          {"damaged", damaged_},
                                          {"seconds", seconds}};
        print(summary);
        return damaged_.empty() ? kExitDone : kExitFailed;
    }

private:
    void count(const sessions::SessionCheck& session) {
        ++sessions_;
        entries_ += session.entries;
    }

    std::uint64_t sessions_ = 0;
    std::uint64_t entries_ = 0;
    boost::json::array damaged_;
};

/// Prints the progress of the check.
class Progress {
public:
    Result<> operator()(std::size_t bytes) {
        bytes_ += bytes;
        if (++read_ % kProgressEvery == 0) {
            standard_error().write(
                fmt::format("scanloom-server: {} entries and parts read, {} MiB\n", read_, bytes_ >> 20));
        }
        return {};
    }

private:
    std::uint64_t read_ = 0;
    std::uint64_t bytes_ = 0;
};

void check_sessions(store::ReadOnlyStore& store, sessions::CheckDepth depth, Findings& findings) {
    const auto sessions = store.log->sessions();
    if (!sessions) return findings.store_damaged(sessions.error());
    Progress progress;
    for (const auto& stored : *sessions) {
        const auto checked = sessions::check_session(*store.log, stored, depth, std::ref(progress));
        if (checked->damage) {
            findings.damaged(*checked);
        } else {
            findings.whole(*checked);
        }
    }
    for (const auto id : store.without_record) {
        findings.damaged(
            {fmt::format("#{}", id), 0, Error{Errc::kDataLoss, "its record, with name and settings, is missing"}});
    }
}

/// Checks all tables of the store. Data that no session needs any more counts, because merging tables reads it.
void check_tables(const std::filesystem::path& store, Findings& findings) {
    for (const auto& table : store::regular_files(store, ".sst")) {
        if (const auto whole = store::check_table(table); !whole) findings.store_damaged(whole.error());
    }
}

} // namespace

ExitCode check_store(const ServerOptions& options) {
    const auto begin = Clock::now();
    auto store = store::open_store_read_only(options.store);
    Findings findings;
    if (!store) {
        const auto code = store.error().code;
        if (code != Errc::kStoreFailed && code != Errc::kDataLoss) return failed(store.error()); // not examined
        findings.store_damaged(store.error());
        return findings.conclude(seconds_since(begin));
    }
    if (store->unfinished_bytes > 0) {
        std::cout << fmt::format("the write-ahead log ends with {} bytes of an unfinished write, which was never "
                                 "acknowledged; this is no damage, and the next start drops them\n",
                                 store->unfinished_bytes);
    }
    const bool is_deep = options.task == Task::kCheckMaps;
    check_sessions(*store, is_deep ? sessions::CheckDepth::kMaps : sessions::CheckDepth::kCheckpoint, findings);
    if (!store::is_in_database(options.store)) check_tables(options.store, findings);
    return findings.conclude(seconds_since(begin));
}

namespace {

/// Returns the directory's path with `ending` appended to its name, also if the path ends with a slash.
fs::path sibling_path(const fs::path& directory, const char* ending) {
    const auto absolute = fs::absolute(directory).lexically_normal();
    auto path = absolute.has_filename() ? absolute : absolute.parent_path();
    return path += ending;
}

std::string line_of(const sessions::RepairedSession& session) {
    auto line = fmt::format("{}: {} entries kept", session.name, session.kept);
    if (session.missing > 0) line += fmt::format(", {} lost", session.missing);
    if (session.empty_scans > 0) line += fmt::format(" ({} lost scans replaced by empty ones)", session.empty_scans);
    if (session.lost_at_creation > 0) {
        line += fmt::format(", {} of the lost ones from its creation: its imported map is not complete, or its mode is "
                            "another; robots may be placed in another frame",
                            session.lost_at_creation);
    }
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
    std::uint64_t empty_scans = 0;
    std::uint64_t set_aside = 0;
    std::size_t damaged_files = 0; // of the old store

    void add(const sessions::RepairedSession& session) {
        ++sessions;
        kept += session.kept;
        missing += session.missing;
        empty_scans += session.empty_scans;
        set_aside += session.set_aside;
    }
};

/// Writes the intact entries of all sessions to the new store, and closes it.
Result<Sum> save(const store::DamagedStore& from, const store::UnfinishedStore& to, const fs::path& lost) {
    const auto repaired = to.open_log();
    if (!repaired) return repaired.error();
    Sum sum;
    const auto names = sessions::repaired_names(from.sessions());
    for (const auto& [id, record] : from.sessions()) {
        const auto session = sessions::repair_session(from, id, record, names.at(id), **repaired, lost);
        if (!session) return session.error();
        std::cout << line_of(*session) << std::flush;
        sum.add(*session);
    }
    return sum;
}

Result<Sum> repair(const ServerOptions& options) {
    const auto lost = sibling_path(options.repaired, ".lost");
    auto unfinished = store::UnfinishedStore::begin(options.repaired, lost);
    if (!unfinished) return prefixed("--repair ", unfinished.error());
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
    const auto begin = Clock::now();
    const auto sum = repair(options);
    if (!sum) return failed(sum.error());
    print({{"event", "repaired"},
           {"damaged_files", sum->damaged_files},
           {"sessions", sum->sessions},
           {"kept", sum->kept},
           {"lost", sum->missing},
           {"stood_in", sum->empty_scans},
           {"set_aside", sum->set_aside},
           {"seconds", seconds_since(begin)}});
    return kExitDone;
}

namespace {

/// Totals over all sessions.
struct Copied {
    std::uint64_t sessions = 0;
    std::uint64_t entries = 0;
};

Result<Copied> copy(const ServerOptions& options) {
    const auto from = store::open_store_read_only(options.store);
    if (!from) return prefixed("--copy: ", from.error());
    if (!from->without_record.empty()) {
        return Error{Errc::kDataLoss, fmt::format("--copy: the record of session {} is missing; save what is left with "
                                                  "--repair",
                                                  from->without_record.front())};
    }
    auto to = store::NewStore::begin(options.copied, {.allow_unreplicated = options.allow_unreplicated});
    if (!to) return prefixed("--to: ", to.error());
    Copied sum;
    const auto copied = store::copy_log(*from->log, to->log(), [&](const store::CopiedSession& session) {
        ++sum.sessions;
        sum.entries += session.entries;
        std::cout << fmt::format("session {}: {} entries, {} parts of its checkpoint\n", session.from, session.entries,
                                 session.parts)
                  << std::flush;
    });
    if (!copied) return copied.error();
    if (auto finished = to->finish(); !finished) return finished.error();
    return sum;
}

} // namespace

ExitCode copy_store(const ServerOptions& options) {
    const auto begin = Clock::now();
    const auto sum = copy(options);
    if (!sum) return failed(sum.error());
    print({{"event", "copied"},
           {"sessions", sum->sessions},
           {"entries", sum->entries},
           {"seconds", seconds_since(begin)}});
    return kExitDone;
}

ExitCode restore_store(const ServerOptions& options) {
    const auto restored = store::restore_backup(options.backups, options.backup, options.store);
    if (!restored) return failed(restored.error());
    print({{"event", "restored"},
           {"id", restored->id},
           {"time", restored->time},
           {"bytes", restored->bytes},
           {"sessions", restored->sessions}});
    return kExitDone;
}

} // namespace scanloom::app
