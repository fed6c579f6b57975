#include "tests/fault/original_stores.hpp"
#include "server/store/rocksdb_store.hpp"

#include "common/wire/log_codec.hpp"
#include "core/mapping/map_config.hpp"
#include "server/sessions/session_registry.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/support/store_files.hpp"

#include <boost/asio/thread_pool.hpp>
#include <fmt/format.h>

namespace scanloom::fault {
namespace {

constexpr std::uint64_t kCreated = 1'700'000'000;
constexpr std::uint64_t kScansPerAppend = 5;

std::string name_of_session(store::SessionId id) { return fmt::format("session{}", id); }

void append(store::ScanLog& log, store::SessionId id, Held& held, const std::vector<LogEntry>& entries) {
    std::vector<std::string> bytes;
    for (const auto& entry : entries) bytes.push_back(wire::encode_entry(entry));
    store::append_and_wait(log, id, held.log.size() + 1, std::move(bytes)).value();
    held.log.insert(held.log.end(), entries.begin(), entries.end());
}

} // namespace

OriginalStores::OriginalStores() {
    const auto directory = place_.path() / "store";
    {
        const auto log = store::open_rocksdb(directory).value();
        create_sessions(*log);
        append_scans(*log, kScans / 3);
        keep("a log only");
    }
    {
        const auto log = store::open_rocksdb(directory).value(); // moves the log's data to a table
        append_scans(*log, kScans / 3);
        write_checkpoints(*log);
        keep("a table and a log with checkpoints");
    }
    {
        const auto log = store::open_rocksdb(directory).value();
        append_scans(*log, kScans / 3);
        keep("tables, checkpoints and a log");
    }
    keep("the files of a closed store");
}

void OriginalStores::create_sessions(store::ScanLog& log) {
    const auto options = mapping::options_of(mapping::resolve(fleet_options()).value());
    for (store::SessionId id = 1; id <= kSessions; ++id) {
        log.create_session(wire::encode_session({name_of_session(id), kCreated, options})).value();
        append(log, id, sessions_[name_of_session(id)],
               {RobotJoined{0, "robot"}, SensorDescribed{0, testing_support::small_laser()}});
    }
}

void OriginalStores::append_scans(store::ScanLog& log, std::uint64_t count) {
    for (std::uint64_t done = 0; done < count; done += kScansPerAppend) {
        for (store::SessionId id = 1; id <= kSessions; ++id) {
            Held& held = sessions_[name_of_session(id)];
            std::vector<LogEntry> entries;
            const std::uint64_t first = held.log.size() - 1; // two entries are not scans
            for (std::uint64_t seq = first; seq < first + kScansPerAppend; ++seq) {
                entries.emplace_back(ScanTaken{0, testing_support::random_scan(static_cast<unsigned>(id), seq)});
            }
            append(log, id, held, entries);
        }
    }
}

/// Does the same as a server that stops.
void OriginalStores::write_checkpoints(store::ScanLog& log) const {
    boost::asio::thread_pool compute(1);
    sessions::SessionRegistry sessions(log, {compute.get_executor(), [] { return double{kCreated}; }});
    sessions.recover().value();
    sessions.drain();
    compute.join();
}

void OriginalStores::keep(std::string what) {
    OriginalStore store{std::move(what), place_.path() / fmt::format("original{}", stores_.size()), sessions_};
    for (auto& [name, held] : store.sessions) {
        held.revision = held.log.size();
        held.digests = undisturbed_digests(held.log, fleet_options()).value();
    }
    store::copy_store(place_.path() / "store", store.path);
    stores_.push_back(std::move(store));
}

} // namespace scanloom::fault
