#include "server/store/postgres_scan_log.hpp"

#include "server/store/postgres_append_queue.hpp"
#include "server/store/postgres_checkpoints.hpp"
#include "server/store/postgres_connection.hpp"
#include "server/store/postgres_list.hpp"
#include "server/store/postgres_node.hpp"
#include "server/store/postgres_owned_sessions.hpp"
#include "server/store/postgres_ownership.hpp"
#include "server/store/postgres_readers.hpp"
#include "server/store/postgres_schema.hpp"
#include "server/store/postgres_session_table.hpp"
#include "server/store/postgres_sweeper.hpp"
#include "server/store/postgres_write_access.hpp"
#include "server/store/postgres_writer.hpp"
#include "server/store/shared_sessions.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <future>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::store {
namespace postgres {
namespace {

constexpr std::size_t kQueues = 4;

class PostgresScanLog final : public ScanLog, public SharedSessions {
public:
    PostgresScanLog(Place place, const PostgresOptions& options)
        : options_(options), access_{std::move(place), options.is_unfinished ? Sharing::kAlone : Sharing::kWithNodes,
                                     options.allow_unreplicated},
          size_limit_(options.bytes_max), readers_(access_.place) {
        for (auto& queue : queues_) queue = std::make_unique<AppendQueue>(access_, shared_, size_limit_);
    }

    /// Begins to use the store, as one of its nodes. Called once.
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

    [[nodiscard]] SharedSessions* shared() override { return this; }
    [[nodiscard]] Result<> own(SessionId session) override;
    [[nodiscard]] Result<> disown(SessionId session) override;
    [[nodiscard]] Result<> confirm(SessionId session) override;
    [[nodiscard]] Result<std::optional<FoundSession>> find(std::string_view name) override;
    [[nodiscard]] Result<SharedList> list() override;
    [[nodiscard]] const std::string& secret() const override { return secret_; }
    [[nodiscard]] Result<> announce(const NodeInfo& info) override;

private:
    [[nodiscard]] Result<Connection> open_locked();
    [[nodiscard]] Error in_store(const Error& error) const { return prefixed(access_.place.text + ": ", error); }
    [[nodiscard]] Result<> take_sessions_again();
    [[nodiscard]] Result<> wait_for_appends(SessionId session);
    [[nodiscard]] Result<> read_entries(SessionId session, Revision after, const VisitEntry& visit);
    [[nodiscard]] AppendQueue& queue_of(SessionId session) { return *queues_[session % kQueues]; }

    const PostgresOptions options_;
    const WriteAccess access_;
    std::string secret_; // of the servers that share the store
    SharedState shared_;
    SizeLimit size_limit_;
    mutable std::shared_mutex in_use_; // held alone by reopen()
    std::optional<Connection> lock_;   // holds the lock of the store
    std::array<Writer, kQueues> confirming_{Writer(access_, shared_), Writer(access_, shared_),
                                            Writer(access_, shared_), Writer(access_, shared_)};
    Checkpoints checkpoints_{access_, shared_, size_limit_};
    mutable Readers readers_;
    OwnNode node_{access_, shared_}; // leaves after the queues have ended
    SessionTable sessions_{access_, shared_, size_limit_, node_};
    std::array<std::unique_ptr<AppendQueue>, kQueues> queues_;
    std::optional<Sweeper> sweeper_; // last: uses the others
};

/// Opens the connection that holds the lock of the store as long as the store is open.
Result<Connection> PostgresScanLog::open_locked() {
    auto connection = access_.open();
    if (!connection) return connection;
    if (options_.is_unfinished) {
        if (auto locked = lock_store(*connection, access_.place, Sharing::kAlone); !locked) return locked.error();
    }
    auto fault = connection->replication_fault();
    if (!fault) return fault.error();
    shared_.warn(std::move(*fault));
    return connection;
}

Result<> PostgresScanLog::start() {
    auto connection = open_locked();
    if (!connection) return connection.error();
    const auto created = options_.is_unfinished ? begin_unfinished_store(*connection) : create_tables(*connection);
    if (!created) return in_store(created.error());
    auto secret = read_secret(*connection);
    if (!secret) return in_store(secret.error());
    secret_ = std::move(*secret);
    if (auto entered = node_.enter(*connection, options_.node); !entered) return entered;
    lock_ = std::move(*connection);
    sweeper_.emplace(access_.place);
    return {};
}

Result<std::vector<SessionId>> PostgresScanLog::start_reading() {
    auto connection = Connection::open(access_.place);
    if (!connection) return connection.error();
    if (auto found = check_tables(*connection); !found) return in_store(found.error());
    if (auto locked = lock_store(*connection, access_.place, Sharing::kAlone); !locked) return locked.error();
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
    return sessions_.create(record);
}

Result<std::vector<StoredSession>> PostgresScanLog::sessions() {
    const std::shared_lock use(in_use_);
    return readers_.sessions();
}

Result<Revision> PostgresScanLog::end_of(SessionId session) {
    const std::shared_lock use(in_use_);
    const auto owned = shared_.find(session);
    return owned ? Result<Revision>(owned->end) : readers_.end_of(session);
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
    auto removed = sessions_.remove(session);
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
    const auto end = owned ? Result<Revision>(owned->end) : readers_.end_of(session);
    if (!end) return end.error();
    if (after > *end) return readers_.damage(session, fmt::format("the log ends before revision {}", after));
    return after == *end ? Result<>() : readers_.entries(session, after, *end, visit);
}

Result<> PostgresScanLog::clear_checkpoint(SessionId session) {
    const std::shared_lock use(in_use_);
    if (auto waited = wait_for_appends(session); !waited) return waited;
    return checkpoints_.clear(session);
}

Result<> PostgresScanLog::write_checkpoint(SessionId session, std::vector<CheckpointPart> parts) {
    const std::shared_lock use(in_use_);
    if (auto waited = wait_for_appends(session); !waited) return waited; // so that it is never ahead of the log
    return checkpoints_.write(session, parts);
}

Result<> PostgresScanLog::read_checkpoint(SessionId session, const VisitPart& visit) {
    const std::shared_lock use(in_use_);
    if (!shared_.find(session)) {
        if (const auto end = readers_.end_of(session); !end) return end.error();
    }
    return readers_.checkpoint(session, visit);
}

// Shared sessions

Result<> PostgresScanLog::own(SessionId session) {
    const std::shared_lock use(in_use_);
    return sessions_.own(session);
}

Result<> PostgresScanLog::disown(SessionId session) {
    const std::shared_lock use(in_use_);
    if (!shared_.find(session)) return {};
    if (auto waited = wait_for_appends(session); !waited) return waited;
    return sessions_.disown(session);
}

Result<> PostgresScanLog::confirm(SessionId session) {
    const std::shared_lock use(in_use_);
    const auto owned = shared_.find(session);
    return confirming_[session % kQueues].make([&](Connection& connection) {
        return owned ? confirm_owned(connection, session, *owned) : Result<>(why_not_owned(connection, session));
    });
}

Result<std::optional<FoundSession>> PostgresScanLog::find(std::string_view name) {
    const std::shared_lock use(in_use_);
    return readers_.with_connection([&](Connection& connection) { return find_session(connection, name, node_.id()); });
}

Result<SharedList> PostgresScanLog::list() {
    const std::shared_lock use(in_use_);
    return readers_.with_connection(
        [&](Connection& connection) { return list_sessions(connection, node_, shared_.sessions()); });
}

Result<> PostgresScanLog::announce(const NodeInfo& info) { return node_.announce(info); }

// After a failure

Result<> PostgresScanLog::take_sessions_again() {
    auto connection = open_locked();
    if (!connection) return connection.error();
    auto taken = take_again(*connection, access_.place, node_.id(), shared_.sessions());
    if (!taken) return taken.error();
    if (auto renewed = node_.renew(*connection); !renewed) return renewed;
    lock_ = std::move(*connection);
    shared_.restart(std::move(*taken));
    return {};
}

bool PostgresScanLog::reopen() {
    if (!shared_.failure() || node_.id() == 0) return false; // 0: it is open for reading
    const std::unique_lock use(in_use_);
    std::vector<std::unique_lock<std::mutex>> pauses;
    for (auto& queue : queues_) pauses.push_back(queue->pause());
    sessions_.close();
    checkpoints_.close();
    for (auto& writer : confirming_) writer.close();
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
    stats.warning = shared_.warning();
    return stats;
}

Result<std::string> PostgresScanLog::identity() {
    return Error{Errc::kInvalidField, "the store is in a database: make backups with the tools of PostgreSQL"};
}

Result<> PostgresScanLog::backup_to(const std::filesystem::path&, const std::stop_token&) {
    return Error{Errc::kInvalidField, "the store is in a database: make backups with the tools of PostgreSQL"};
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
