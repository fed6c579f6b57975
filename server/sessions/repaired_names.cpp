#include "server/sessions/repaired_names.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/log_codec.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

namespace scanloom::session {
namespace {

std::string with_id(std::string name, store::SessionId id) {
    const auto ending = fmt::format("-{}", id);
    name.resize(std::min(name.size(), kNameBytesMax - ending.size()));
    return name + ending;
}

/// Returns the name in a record; nullopt if it is lost or cannot be decoded.
std::optional<std::string> name_in(const std::optional<std::string>& record) {
    if (!record) return std::nullopt;
    const auto decoded = wire::decode_session(*record);
    if (!decoded) return std::nullopt;
    return decoded->name;
}

} // namespace

std::map<store::SessionId, std::string>
repaired_names(const std::map<store::SessionId, std::optional<std::string>>& records) {
    std::map<store::SessionId, std::string> names;
    std::set<std::string> taken;
    const auto give = [&](store::SessionId id, std::string name) {
        while (!taken.insert(name).second) name = with_id(std::move(name), id);
        names.emplace(id, std::move(name));
    };
    for (auto session = records.rbegin(); session != records.rend(); ++session) {
        const auto name = name_in(session->second);
        if (name && !taken.contains(*name)) give(session->first, *name);
    }
    for (const auto& [id, record] : records) { // sessions whose name is taken or lost
        if (!names.contains(id)) give(id, with_id(name_in(record).value_or("session"), id));
    }
    return names;
}

} // namespace scanloom::session
