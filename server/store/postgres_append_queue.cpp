#include "server/store/postgres_append_queue.hpp"

#include "server/store/postgres_ownership.hpp"
#include "server/store/postgres_segments.hpp"
#include "server/store/store_error.hpp"

#include <fmt/format.h>

#include <map>
#include <string_view>
#include <utility>

namespace scanloom::store::postgres {
namespace {

// The end of each session moves on only where it is as expected and the session is still this server's; rows are
// inserted for these sessions alone.
constexpr const char* kAppend =
    "WITH advanced AS ("
    " UPDATE scanloom.session s SET end_rev = a.last, entry_bytes = s.entry_bytes + a.bytes"
    " FROM unnest($1::bigint[], $2::bigint[], $3::bigint[], $4::bigint[], $5::bigint[])"
    " AS a(id, epoch, before, last, bytes)"
    " WHERE s.id = a.id AND s.epoch = a.epoch AND s.end_rev = a.before AND NOT s.removed RETURNING s.id),"
    " stored AS ("
    " INSERT INTO scanloom.segment (session, first, last, body) SELECT g.session, g.first, g.last, g.body"
    " FROM unnest($6::bigint[], $7::bigint[], $8::bigint[], $9::bytea[]) AS g(session, first, last, body)"
    " JOIN advanced ON advanced.id = g.session)"
    " SELECT id FROM advanced";

} // namespace

/// The appends of one statement: per session, what continues its log.
struct AppendQueue::Group {
    struct Run {
        OwnedSession owned;
        std::vector<std::string> entries;
    };
    std::map<SessionId, Run> runs;
    std::map<SessionId, Error> refused; // by the database, or because this server does not own the session
    std::uint64_t bytes = 0;            // of entries

    /// Adds entries that continue the log.
    Result<> add(const SharedState& shared, Append& append) {
        auto run = runs.find(append.session);
        const auto owned = run == runs.end() ? shared.find(append.session) : std::optional(run->second.owned);
        if (!owned) {
            refused.try_emplace(append.session, no_such_session(append.session)); // write() finds out more
            return {};
        }
        if (append.entries.empty()) return {};
        const Revision end = owned->end + (run == runs.end() ? 0 : run->second.entries.size());
        if (append.first != end + 1) {
            return Error{Errc::kConflict, fmt::format("an append to session {} begins with revision {}, but its log "
                                                      "ends with {}",
                                                      append.session, append.first, end)};
        }
        if (run == runs.end()) run = runs.try_emplace(append.session, Run{*owned, {}}).first;
        bytes += append.bytes;
        auto& entries = run->second.entries;
        entries.insert(entries.end(), std::move_iterator(append.entries.begin()),
                       std::move_iterator(append.entries.end()));
        return {};
    }

    [[nodiscard]] Parameters parameters() const {
        std::vector<std::int64_t> ids, epochs, befores, lasts, sizes;
        std::vector<std::int64_t> sessions, firsts, ends;
        std::vector<std::vector<Segment>> segments;
        std::vector<std::string_view> bodies;
        for (const auto& [id, run] : runs) {
            ids.push_back(signed_of(id));
            epochs.push_back(run.owned.epoch);
            befores.push_back(signed_of(run.owned.end));
            lasts.push_back(signed_of(run.owned.end + run.entries.size()));
            sizes.push_back(0);
            segments.push_back(segments_of(id, run.owned.end + 1, run.entries));
            for (const Segment& segment : segments.back()) {
                sizes.back() += signed_of(segment.body.size());
                sessions.push_back(signed_of(id));
                firsts.push_back(signed_of(segment.first));
                ends.push_back(signed_of(segment.last));
                bodies.push_back(segment.body);
            }
        }
        Parameters parameters;
        for (const auto* numbers : {&ids, &epochs, &befores, &lasts, &sizes, &sessions, &firsts, &ends})
            parameters.add(*numbers);
        parameters.add(bodies);
        return parameters;
    }
};

AppendQueue::AppendQueue(const WriteAccess& access, SharedState& shared, SizeLimit& size_limit)
    : access_(access), shared_(shared), size_limit_(size_limit), thread_([this] { run(); }) {}

AppendQueue::~AppendQueue() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    waiting_.notify_one();
    thread_.join();
}

void AppendQueue::append(SessionId session, Revision first, std::vector<std::string> entries, ScanLog::Done done) {
    std::uint64_t bytes = 0;
    for (const std::string& entry : entries) bytes += entry.size();
    {
        const std::lock_guard lock(mutex_);
        queue_.push_back({session, first, std::move(entries), std::move(done), bytes});
        stats_.queued_bytes += bytes;
    }
    waiting_.notify_one();
}

std::unique_lock<std::mutex> AppendQueue::pause() {
    std::unique_lock lock(running_);
    connection_.reset();
    return lock;
}

StoreStats AppendQueue::stats() const {
    const std::lock_guard lock(mutex_);
    return stats_;
}

void AppendQueue::run() {
    for (auto appends = next(); !appends.empty(); appends = next()) store(std::move(appends));
}

/// Waits for appends. @return none at the end
std::vector<AppendQueue::Append> AppendQueue::next() {
    std::unique_lock lock(mutex_);
    waiting_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    std::vector<Append> appends;
    for (std::uint64_t bytes = 0; !queue_.empty() && bytes < kStatementBytes; queue_.pop_front()) {
        bytes += queue_.front().bytes;
        appends.push_back(std::move(queue_.front()));
    }
    return appends;
}

void AppendQueue::store(std::vector<Append> appends) {
    std::vector<Result<>> results;
    std::vector<std::size_t> counts;
    Result<> written;
    bool has_entries = false;
    {
        const std::lock_guard running(running_); // from here on, reopening the log does not change what is owned
        Group group;
        for (Append& append : appends) {
            counts.push_back(append.entries.size());
            const auto failure = shared_.failure();
            results.push_back(failure ? Result<>(*failure) : group.add(shared_, append));
        }
        has_entries = !group.runs.empty();
        if (has_entries || !group.refused.empty()) written = write(group);
        for (std::size_t n = 0; n < appends.size(); ++n) {
            const auto refused = group.refused.find(appends[n].session);
            if (results[n] && !written) results[n] = written.error();
            if (results[n] && refused != group.refused.end()) results[n] = refused->second;
        }
    }
    {
        const std::lock_guard lock(mutex_);
        if (has_entries && written) ++stats_.synced_writes;
        stats_.no_room.reset();
        if (!written && written.error().code == Errc::kOverloaded) stats_.no_room = written.error().message;
        for (std::size_t n = 0; n < appends.size(); ++n) {
            stats_.queued_bytes -= appends[n].bytes;
            if (results[n]) stats_.entries += counts[n];
            if (results[n] && counts[n] > 0) ++stats_.appends;
        }
    }
    for (std::size_t n = 0; n < appends.size(); ++n) {
        if (appends[n].done) appends[n].done(results[n]);
    }
}

/// Stores the entries of the sessions that this server owns: all, or it is not known which. Empties the group.
Result<> AppendQueue::write(Group& group) {
    if (connection_ && !connection_->is_alive()) connection_.reset(); // nothing was under way
    if (!connection_) {
        auto opened = access_.open();
        if (!opened) return shared_.fail(opened.error());
        connection_ = std::move(*opened);
    }
    for (auto& [session, why] : group.refused) why = why_not_owned(*connection_, session);
    if (group.runs.empty()) return {};
    const auto room = size_limit_.check(*connection_);
    const auto rows = room ? connection_->run_prepared(kAppend, group.parameters()) : Result<Rows>(room.error());
    if (!rows && rows.error().code == Errc::kOverloaded) return rows.error();
    if (!rows) {
        connection_.reset();
        return shared_.fail(rows.error());
    }
    size_limit_.add(group.bytes);
    for (int row = 0; row < rows->size(); ++row) {
        const auto stored = group.runs.extract(static_cast<SessionId>(rows->number(row, 0)));
        const auto& [owned, entries] = stored.mapped();
        shared_.put(stored.key(), {owned.epoch, owned.end + entries.size()});
    }
    for (const auto& [session, run] : group.runs) {
        auto why = forget_lost(*connection_, shared_, session, run.owned);
        if (why.code != Errc::kNotFound && why.code != Errc::kNotOwner) return shared_.fail(why);
        group.refused.insert_or_assign(session, std::move(why));
    }
    return {};
}

} // namespace scanloom::store::postgres
