#include "server/store/postgres_scan_log.hpp"

#include "server/store/postgres_append_queue.hpp"
#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_owned_sessions.hpp"
#include "server/store/postgres_ownership.hpp"
#include "server/store/postgres_readers.hpp"
#include "server/store/postgres_schema.hpp"
#include "server/store/postgres_segments.hpp"
#include "server/store/postgres_sweeper.hpp"
#include "server/store/postgres_writer.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::store {
namespace postgres {
namespace {

constexpr std::size_t kQueues = 4;

class PostgresScanLog final : public ScanLog {
public:
    PostgresScanLog(Place place, const PostgresOptions& options)
        : place_(std::move(place)), options_(options), size_limit_(options.bytes_max), readers_(place_) {
        for (auto& queue : queues_) queue = std::make_unique<AppendQueue>(place_, shared_, size_limit_);
    }

    /// Takes the store over. Called once.
    [[nodiscard]] Result<> start();

    /// Reads what is there, instead. @return sessions without a record
    [[nodiscard]] Result<std::vector<SessionId>> start_reading();

    [[nodiscard]] Result<SessionId> create_session(std::string_view record) override;
    [[nodiscard]] Result<std::vector<StoredSession>> sessions() override;
    [[nodiscard]] Result<Revision> end_of(SessionId session) override;
    [[nodiscard]] Result<> remove_session(SessionId session) override;
    void append(SessionId session, Revision first, std::vector<std::string> entries, Done done) override;
    [[nodiscard]] Result<> read(SessionId session, Revision after, const VisitEntry& visit) override;
    [[nodiscard]] Result<> clear_checkpoint(SessionId session) override;
    [[nodiscard]] Result<> write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) override;
    [[nodiscard]] Result<> read_checkpoint(SessionId session, const VisitPart& visit) override;
    [[nodiscard]] bool reopen() override;
    [[nodiscard]] StoreStats stats() const override;
    [[nodiscard]] Result<std::string> identity() override;
    [[nodiscard]] Result<> backup_to(const std::filesystem::path& directory, const std::stop_token& stop) override;
    [[nodiscard]] std::uint64_t bytes_on_disk() const override;

private:
    [[nodiscard]] Result<Connection> open_replicated() const;
    [[nodiscard]] Result<> take_sessions_again();
    [[nodiscard]] Result<> change_checkpoint(SessionId session, const Writer::Change& change);
    [[nodiscard]] Result<> wait_for_appends(SessionId session);
    [[nodiscard]] Result<> read_entries(SessionId session, Revision after, const VisitEntry& visit);
    [[nodiscard]] AppendQueue& queue_of(SessionId session) { return *queues_[session % kQueues]; }

    const Place place_;
    const PostgresOptions options_;
    std::int64_t owner_ = 0; // this server's number in the database
    SharedState shared_;
    SizeLimit size_limit_;
    mutable std::shared_mutex in_use_; // held alone by reopen()
    std::optional<Connection> lock_;   // holds the lock of the store
    Writer sessions_{place_, shared_}; // creates and removes sessions
    Writer checkpoints_{place_, shared_};
    mutable Readers readers_;
    std::array<std::unique_ptr<AppendQueue>, kQueues> queues_;
    std::optional<Sweeper> sweeper_; // last: uses the others
};

Result<Connection> PostgresScanLog::open_replicated() const {
    auto connection = Connection::open(place_);
    if (!connection || options_.allow_unreplicated) return connection;
    if (auto replicated = connection->check_replication(); !replicated) return replicated.error();
    return connection;
}

Result<> PostgresScanLog::start() {
    auto connection = open_replicated();
    if (!connection) return connection.error();
    if (auto locked = lock_store(*connection, place_); !locked) return locked;
    const auto created = options_.is_unfinished ? begin_unfinished_store(*connection) : create_tables(*connection);
    if (!created) return created;
    const auto owner = new_owner(*connection);
    if (!owner) return owner.error();
    owner_ = *owner;
    auto taken = take_all(*connection, owner_);
    if (!taken) return taken.error();
    shared_.restart(std::move(*taken));
    lock_ = std::move(*connection);
    sweeper_.emplace(place_);
    return {};
}

Result<std::vector<SessionId>> PostgresScanLog::start_reading() {
    auto connection = Connection::open(place_);
    if (!connection) return connection.error();
    if (auto found = check_tables(*connection); !found) return found.error();
    if (auto locked = lock_store(*connection, place_); !locked) return locked.error();
    auto all = all_sessions(*connection);
    if (!all) return all.error();
    auto lacking = sessions_without_record(*connection);
    if (!lacking) return lacking;
    shared_.restart(std::move(*all));
    shared_.fail({Errc::kStoreFailed, "the store is open for reading only"});
    lock_ = std::move(*connection);
    return lacking;
}

Result<SessionId> PostgresScanLog::create_session(std::string_view record) {
    const std::shared_lock use(in_use_);
    SessionId session = 0;
    const auto created = sessions_.make([&](Connection& connection) -> Result<> {
        if (auto room = size_limit_.check(connection); !room) return room;
        Parameters parameters;
        parameters.add(record);
        parameters.add(owner_);
        const auto rows = connection.run(
            "INSERT INTO scanloom.session (record, owner) VALUES ($1, $2) RETURNING id, epoch", parameters);
        if (!rows) return rows.error();
        session = static_cast<SessionId>(rows->number(0, 0));
        shared_.put(session, {rows->number(0, 1), 0});
        return {};
    });
    if (!created) return created.error();
    return session;
}

Result<std::vector<StoredSession>> PostgresScanLog::sessions() {
    const std::shared_lock use(in_use_);
    auto sessions = readers_.sessions();
    if (sessions) std::erase_if(*sessions, [this](const StoredSession& stored) { return !shared_.find(stored.id); });
    return sessions;
}

Result<Revision> PostgresScanLog::end_of(SessionId session) {
    const std::shared_lock use(in_use_);
    const auto owned = shared_.find(session);
    if (!owned) return no_such_session(session);
    return owned->end;
}

Result<> PostgresScanLog::wait_for_appends(SessionId session) {
    const auto outcome = std::make_shared<std::promise<Result<>>>();
    auto done = outcome->get_future();
    queue_of(session).append(session, 0, {}, [outcome](Result<> result) { outcome->set_value(std::move(result)); });
    return done.get();
}

Result<> PostgresScanLog::remove_session(SessionId session) {
    const std::shared_lock use(in_use_);
    if (auto waited = wait_for_appends(session); !waited) return waited;
    auto removed = sessions_.make([&](Connection& connection) -> Result<> {
        const auto owned = shared_.find(session);
        if (!owned) return no_such_session(session);
        Parameters parameters;
        parameters.add(signed_of(session));
        parameters.add(owned->epoch);
        const auto rows = connection.run("UPDATE scanloom.session SET removed = true, record = ''"
                                         " WHERE id = $1 AND epoch = $2 AND NOT removed RETURNING id",
                                         parameters);
        if (!rows) return rows.error();
        if (rows->size() == 0) return taken_over(session);
        shared_.remove(session);
        return {};
    });
    if (removed) sweeper_->wake();
    return removed;
}

void PostgresScanLog::append(SessionId session, Revision first, std::vector<std::string> entries, Done done) {
    queue_of(session).append(session, first, std::move(entries), std::move(done));
}

Result<> PostgresScanLog::read(SessionId session, Revision after, const VisitEntry& visit) {
    auto read = read_entries(session, after, visit);
    if (!read && options_.on_unreadable &&
        (read.error().code == Errc::kDataLoss || read.error().code == Errc::kStoreFailed)) {
        options_.on_unreadable(session, read.error());
    }
    return read;
}

Result<> PostgresScanLog::read_entries(SessionId session, Revision after, const VisitEntry& visit) {
    const std::shared_lock use(in_use_);
    const auto owned = shared_.find(session);
    if (!owned) return no_such_session(session);
    if (after > owned->end) return readers_.damage(session, fmt::format("the log ends before revision {}", after));
    if (after == owned->end) return {};
    return readers_.entries(session, after, owned->end, visit);
}

/// Changes a checkpoint in one transaction. Its last statement checks that this server still owns the session.
Result<> PostgresScanLog::change_checkpoint(SessionId session, const Writer::Change& change_parts) {
    const std::shared_lock use(in_use_);
    if (auto waited = wait_for_appends(session); !waited) return waited; // so that it is never ahead of the log
    return checkpoints_.make([&](Connection& connection) -> Result<> {
        const auto owned = shared_.find(session);
        if (!owned) return no_such_session(session);
        if (auto begun = connection.run("BEGIN"); !begun) return begun.error();
        if (auto changed = change_parts(connection); !changed) return changed;
        Parameters parameters;
        parameters.add(signed_of(session));
        parameters.add(owned->epoch);
        const auto rows = connection.run("UPDATE scanloom.session SET checkpoint_bytes = (SELECT"
                                         " coalesce(sum(octet_length(value)), 0) FROM scanloom.part WHERE session = $1)"
                                         " WHERE id = $1 AND epoch = $2 AND NOT removed RETURNING id",
                                         parameters);
        if (!rows) return rows.error();
        if (rows->size() == 0) return shared_.find(session) ? taken_over(session) : no_such_session(session);
        const auto committed = connection.run("COMMIT");
        return committed ? Result<>() : Result<>(committed.error());
    });
}

Result<> PostgresScanLog::clear_checkpoint(SessionId session) {
    return change_checkpoint(session, [&](Connection& connection) -> Result<> {
        Parameters parameters;
        parameters.add(signed_of(session));
        const auto cleared =
            connection.run("DELETE FROM scanloom.part WHERE session = $1", parameters, Connection::kLongTimeout);
        return cleared ? Result<>() : Result<>(cleared.error());
    });
}

Result<> PostgresScanLog::write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) {
    std::map<std::string_view, std::string> sealed_parts; // a statement accepts each key once
    for (const CheckpointPart& part : parts) sealed_parts[part.key] = sealed_part(session, part.key, part.value);
    return change_checkpoint(session, [&](Connection& connection) -> Result<> {
        if (auto room = size_limit_.check(connection); !room) return room;
        for (auto part = sealed_parts.begin(); part != sealed_parts.end();) {
            std::vector<std::string_view> keys;
            std::vector<std::string_view> values;
            std::size_t bytes = 0;
            for (; part != sealed_parts.end() && bytes < AppendQueue::kStatementBytes; ++part) {
                keys.push_back(part->first);
                values.push_back(part->second);
                bytes += part->second.size();
            }
            size_limit_.add(bytes);
            Parameters parameters;
            parameters.add(signed_of(session));
            parameters.add(keys);
            parameters.add(values);
            const auto written =
                connection.run("INSERT INTO scanloom.part (session, key, value) SELECT $1, p.key, p.value"
                               " FROM unnest($2::bytea[], $3::bytea[]) AS p(key, value)"
                               " ON CONFLICT (session, key) DO UPDATE SET value = excluded.value",
                               parameters);
            if (!written) return written.error();
        }
        return {};
    });
}

Result<> PostgresScanLog::read_checkpoint(SessionId session, const VisitPart& visit) {
    const std::shared_lock use(in_use_);
    if (!shared_.find(session)) return no_such_session(session);
    return readers_.checkpoint(session, visit);
}

Result<> PostgresScanLog::take_sessions_again() {
    auto connection = open_replicated();
    if (!connection) return connection.error();
    if (auto locked = lock_store(*connection, place_); !locked) return locked;
    auto taken = take_again(*connection, place_, owner_, shared_.sessions());
    if (!taken) return taken.error();
    lock_ = std::move(*connection);
    shared_.restart(std::move(*taken));
    return {};
}

bool PostgresScanLog::reopen() {
    if (!shared_.failure() || owner_ == 0) return false; // 0: it is open for reading
    const std::unique_lock use(in_use_);
    std::vector<std::unique_lock<std::mutex>> pauses;
    for (auto& queue : queues_) pauses.push_back(queue->pause());
    for (Writer* writer : {&sessions_, &checkpoints_}) writer->close();
    lock_.reset();
    readers_.close();
    auto reopened = take_sessions_again();
    if (!reopened) shared_.fail_again(reopened.error());
    return reopened.has_value();
}

StoreStats PostgresScanLog::stats() const {
    StoreStats stats;
    for (const auto& queue : queues_) {
        const StoreStats one = queue->stats();
        stats.appends += one.appends;
        stats.entries += one.entries;
        stats.synced_writes += one.synced_writes;
        stats.queued_bytes += one.queued_bytes;
        if (one.no_room) stats.no_room = one.no_room;
    }
    if (const auto failure = shared_.failure()) stats.last_error = failure->message;
    return stats;
}

Result<std::string> PostgresScanLog::identity() {
    return Error{Errc::kInvalidField, "the store is in a database: make backups of the database"};
}

Result<> PostgresScanLog::backup_to(const std::filesystem::path&, const std::stop_token&) {
    return Error{Errc::kInvalidField, "the store is in a database: make backups of the database"};
}

std::uint64_t PostgresScanLog::bytes_on_disk() const { return readers_.size(); }

} // namespace
} // namespace postgres

Result<std::unique_ptr<ScanLog>> open_postgres(const std::string& url, const PostgresOptions& options) {
    auto place = postgres::parse_place(url);
    if (!place) return place.error();
    auto log = std::make_unique<postgres::PostgresScanLog>(std::move(*place), options);
    if (auto started = log->start(); !started) return started.error();
    return log;
}

Result<> finish_postgres(const std::string& url) {
    const auto place = postgres::parse_place(url);
    if (!place) return place.error();
    auto connection = postgres::Connection::open(*place);
    return connection ? postgres::finish_store(*connection) : Result<>(connection.error());
}

Result<ReadOnlyStore> open_postgres_read_only(const std::string& url) {
    auto place = postgres::parse_place(url);
    if (!place) return place.error();
    auto log = std::make_unique<postgres::PostgresScanLog>(std::move(*place), PostgresOptions());
    auto without_record = log->start_reading();
    if (!without_record) return without_record.error();
    return ReadOnlyStore{std::move(log), 0, std::move(*without_record)};
}

} // namespace scanloom::store
