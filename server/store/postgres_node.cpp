#include "server/store/postgres_node.hpp"

#include <fmt/format.h>

#include <optional>
#include <string_view>
#include <utility>

namespace scanloom::store::postgres {
namespace {

constexpr std::chrono::seconds kRenewEvery{1};

} // namespace

OwnNode::~OwnNode() {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    thread_.join();
    auto connection = Connection::open(access_.place);
    if (!connection) return; // the others find out after kDeadAfter
    Parameters parameters;
    parameters.add(id_);
    static_cast<void>(connection->run("DELETE FROM scanloom.node WHERE id = $1", parameters));
}

Result<> OwnNode::enter(Connection& connection, std::string name) {
    Parameters parameters;
    parameters.add(std::string_view(name));
    const auto left = connection.run("DELETE FROM scanloom.node WHERE name = convert_from($1, 'UTF8')"
                                     " OR seen < now() - interval '1 day'",
                                     parameters);
    if (!left) return left.error();
    const auto entered = connection.run("INSERT INTO scanloom.node (name, seen)"
                                        " VALUES (convert_from($1, 'UTF8'), now()) RETURNING id",
                                        parameters);
    if (!entered) return entered.error();
    name_ = std::move(name);
    id_ = entered->number(0, 0);
    thread_ = std::jthread([this](const std::stop_token& stop) { keep(stop); });
    return {};
}

Result<> OwnNode::renew(Connection& connection) {
    Parameters parameters;
    parameters.add(id_);
    {
        const std::lock_guard lock(mutex_);
        for (const std::string* text : {&info_.robots, &info_.http, &info_.build}) {
            parameters.add(std::string_view(*text));
        }
    }
    const auto rows = connection.run("UPDATE scanloom.node SET seen = now(), robots = convert_from($2, 'UTF8'),"
                                     " http = convert_from($3, 'UTF8'), build = convert_from($4, 'UTF8')"
                                     " WHERE id = $1 RETURNING id",
                                     parameters);
    if (!rows) return rows.error();
    if (rows->size() > 0) {
        const auto now = Clock::now();
        if (now - renewed_at_.exchange(now) > kDeadAfter / 2) steady_since_ = now;
        return {};
    }
    return Error{Errc::kNotOwner,
                 fmt::format("this server is not node '{}' of the store {} any more: another server was started with "
                             "this name, or the database was restored; give each server a --node of its own, and start "
                             "this one again",
                             name_, access_.place.text)};
}

Result<> OwnNode::announce(const NodeInfo& info) {
    {
        const std::lock_guard lock(mutex_);
        info_ = info;
    }
    auto connection = Connection::open(access_.place);
    return connection ? renew(*connection) : Result<>(connection.error());
}

/// Renews the row until the end. A database that cannot be used is tried again. Appends find out by themselves; without
/// them, the log fails when others consider the server dead.
void OwnNode::keep(const std::stop_token& stop) {
    std::optional<Connection> connection;
    renewed_at_ = Clock::now();
    steady_since_ = renewed_at_.load();
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            waiting_.wait_for(lock, stop, kRenewEvery, [] { return false; });
        }
        if (stop.stop_requested()) return;
        const auto renewed = renew_over(connection);
        const bool counts_as_dead = Clock::now() - renewed_at_.load() >= kDeadAfter;
        if (!renewed && (counts_as_dead || renewed.error().code == Errc::kNotOwner)) {
            static_cast<void>(shared_.fail(renewed.error()));
        }
    }
}

/// Renews the row over a connection, which is opened if it does not exist and closed if it fails.
Result<> OwnNode::renew_over(std::optional<Connection>& connection) {
    if (!connection) {
        auto opened = access_.open();
        if (!opened) return opened.error();
        connection = std::move(*opened);
    }
    auto renewed = renew(*connection);
    if (!renewed) connection.reset();
    return renewed;
}

} // namespace scanloom::store::postgres
