#include "server/app/check_command.hpp"

#include "common/app/standard_streams.hpp"
#include "common/json/json_text.hpp"
#include "server/sessions/session_check.hpp"
#include "server/store/block_scan.hpp"
#include "server/store/files.hpp"
#include "server/store/rocksdb_store.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <iostream>

namespace scanloom::app {
namespace {

/// Progress is printed each time this many entries and parts have been read.
constexpr std::uint64_t kProgressEvery = 100'000;

/// Prints the findings, and counts them for the summary.
class Findings {
public:
    void whole(const session::SessionCheck& session) {
        count(session);
        std::cout << fmt::format("{}: {} entries, whole\n", session.name, session.entries) << std::flush;
    }

    void damaged(const session::SessionCheck& session) {
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
        std::cout << json_text(summary) << std::endl;
        return damaged_.empty() ? kExitDone : kExitFailed;
    }

private:
    void count(const session::SessionCheck& session) {
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

void check_sessions(store::ReadOnlyStore& store, session::CheckDepth depth, Findings& findings) {
    const auto sessions = store.log->sessions();
    if (!sessions) return findings.store_damaged(sessions.error());
    Progress progress;
    for (const auto& stored : *sessions) {
        const auto checked = session::check_session(*store.log, stored, depth, std::ref(progress));
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
    const auto begin = std::chrono::steady_clock::now();
    auto store = store::open_read_only(options.store);
    Findings findings;
    if (!store) {
        if (store.error().code != Errc::kStoreFailed &&
            store.error().code != Errc::kDataLoss) { // the store could not be examined
            standard_error().write(fmt::format("scanloom-server: {}\n", store.error().message));
            return kExitFailed;
        }
        findings.store_damaged(store.error());
    } else {
        if (store->unfinished_bytes > 0) {
            std::cout << fmt::format("the write-ahead log ends with {} bytes of an unfinished write, which was never "
                                     "acknowledged; this is no damage, and the next start drops them\n",
                                     store->unfinished_bytes);
        }
        const auto depth =
            options.task == Task::kCheckMaps ? session::CheckDepth::kMaps : session::CheckDepth::kCheckpoint;
        check_sessions(*store, depth, findings);
        check_tables(options.store, findings);
    }
    return findings.conclude(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
}

} // namespace scanloom::app
