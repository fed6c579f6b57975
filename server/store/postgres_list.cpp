#include "server/store/postgres_list.hpp"

#include "server/store/postgres_node.hpp"

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace scanloom::store::postgres {
namespace {

/// Returns the nodes by their numbers.
Result<std::map<std::int64_t, Node>> nodes_by_id(Connection& connection, std::int64_t self, bool is_steady) {
    const auto rows = connection.run("SELECT id, (extract(epoch FROM now() - seen) * 1000)::bigint, name, robots, http,"
                                     " build FROM scanloom.node",
                                     {}, Connection::kReadTimeout);
    if (!rows) return rows.error();
    std::map<std::int64_t, Node> nodes;
    for (int row = 0; row < rows->size(); ++row) {
        const auto text = [&](int column) { return std::string(rows->bytes(row, column)); };
        const auto id = rows->number(row, 0);
        const std::chrono::milliseconds silent(rows->number(row, 1));
        nodes[id] = {.info = std::make_shared<const NodeInfo>(NodeInfo{text(2), text(3), text(4), text(5)}),
                     .silent = silent,
                     .is_alive = silent < kDeadAfter,
                     .is_dead = is_steady && silent >= kDeadAfter,
                     .is_self = id == self};
    }
    return nodes;
}

/// Returns the owner of a session for SharedSession.
std::shared_ptr<const NodeInfo> owner_of(std::int64_t id, const std::map<std::int64_t, Node>& nodes) {
    const auto node = nodes.find(id);
    return node != nodes.end() && node->second.is_alive && !node->second.is_self ? node->second.info : nullptr;
}

} // namespace

Result<SharedList> list_sessions(Connection& connection, const OwnNode& self, const OwnedSessions& owned) {
    auto nodes = nodes_by_id(connection, self.id(), self.is_steady());
    if (!nodes) return nodes.error();
    const auto rows = connection.run("SELECT id, owner, end_rev, epoch FROM scanloom.session"
                                     " WHERE NOT removed AND name IS NOT NULL",
                                     {}, Connection::kReadTimeout);
    if (!rows) return rows.error();
    SharedList list;
    for (int row = 0; row < rows->size(); ++row) {
        const auto owner = rows->number(row, 1);
        const auto id = static_cast<SessionId>(rows->number(row, 0));
        const auto known = owned.find(id);
        list.sessions[id] = {static_cast<Revision>(rows->number(row, 2)), owner_of(owner, *nodes),
                             known != owned.end() && known->second.epoch == rows->number(row, 3)};
        if (const auto node = nodes->find(owner); node != nodes->end()) ++node->second.sessions;
    }
    std::map<std::string, Node> by_name;
    for (auto& [id, node] : *nodes) by_name[node.info->name] = std::move(node);
    for (auto& [name, node] : by_name) list.nodes.push_back(std::move(node));
    return list;
}

Result<std::optional<FoundSession>> find_session(Connection& connection, std::string_view name, std::int64_t self) {
    Parameters parameters;
    parameters.add(name);
    const auto rows = connection.run("SELECT id, owner, end_rev, record FROM scanloom.session"
                                     " WHERE name = convert_from($1, 'UTF8') AND NOT removed",
                                     parameters, Connection::kReadTimeout);
    if (!rows) return rows.error();
    if (rows->size() == 0) return std::optional<FoundSession>();
    const auto nodes = nodes_by_id(connection, self, false);
    if (!nodes) return nodes.error();
    return std::optional(
        FoundSession{{static_cast<SessionId>(rows->number(0, 0)), std::string(rows->bytes(0, 3))},
                     {static_cast<Revision>(rows->number(0, 2)), owner_of(rows->number(0, 1), *nodes)}});
}

} // namespace scanloom::store::postgres
