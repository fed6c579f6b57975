#include "server/http/handlers/sessions.hpp"

#include "common/json/json_text.hpp"
#include "common/scan/limits.hpp"
#include "server/http/handlers/session_json.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/number.hpp"

#include <boost/json/array.hpp>
#include <fmt/format.h>

#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace scanloom::http {
namespace {

constexpr std::size_t kLimitMax = 1000;

/// Accepts a session's name, or '#' and the number of a session whose record cannot be read.
bool is_listed_name(std::string_view text) { return is_valid_name(text.substr(text.starts_with('#') ? 1 : 0)); }

struct Page {
    std::size_t limit = 100;
    std::string_view after; ///< empty: starts with the first
};

Result<Page> parse_page(const Query& query) {
    if (auto ok = query.check_only({"limit", "after"}); !ok) return ok.error();
    Page page;
    if (const auto text = query.find("limit")) {
        const auto limit = parse_integer<std::size_t>(*text);
        if (!limit || *limit < 1 || *limit > kLimitMax) {
            return Error{Errc::kInvalidField, fmt::format("limit is {}; a whole number from 1 to {} is needed",
                                                          in_quotes(*text), kLimitMax)};
        }
        page.limit = *limit;
    }
    if (const auto after = query.find("after")) {
        if (!is_listed_name(*after)) {
            return Error{Errc::kInvalidField,
                         fmt::format("after is {}; the name of a session is needed", in_quotes(*after))};
        }
        page.after = *after;
    }
    return page;
}

/// A session that is served, or the reason why it is not.
using Listed = Result<session::Listed>;

std::map<std::string, Listed, std::less<>> sessions_by_name(const session::SessionRegistry& sessions,
                                                            const access::Token& seen_by) {
    std::map<std::string, Listed, std::less<>> listed;
    for (auto& session : sessions.all()) listed.emplace(session.info.name, session);
    for (const auto& [name, reason] : sessions.damaged()) listed.emplace(name, reason);
    std::erase_if(listed, [&](const auto& entry) { return !is_for(seen_by, entry.first); });
    return listed;
}

/// Returns the damage found since the start in sessions that are still served as far as possible.
std::map<std::string, Error> found_by(const session::BackgroundCheck* check) {
    return check == nullptr ? std::map<std::string, Error>() : check->damaged();
}

boost::json::object listed_json(const session::Listed& listed, const std::map<std::string, Error>& found) {
    auto json = to_json(listed);
    const auto damage = found.find(listed.info.name);
    if (damage != found.end()) json["damage"] = damage->second.message;
    return json;
}

boost::json::object listed_json(const Listed& listed, std::string_view name,
                                const std::map<std::string, Error>& found) {
    return listed ? listed_json(*listed, found) : damaged_json(name, listed.error());
}

} // namespace

Result<Response> list_sessions(const session::SessionRegistry& sessions, const session::BackgroundCheck* check,
                               const Call& call) {
    const auto page = parse_page(call.query);
    if (!page) return page.error();
    const auto found = found_by(check);
    const auto listed = sessions_by_name(sessions, *call.token);
    boost::json::array shown;
    boost::json::value next = nullptr;
    auto entry = listed.upper_bound(page->after);
    for (; entry != listed.end() && shown.size() < page->limit; ++entry) {
        shown.push_back(listed_json(entry->second, entry->first, found));
        if (shown.size() == page->limit && std::next(entry) != listed.end()) next = boost::json::string(entry->first);
    }
    return ok(boost::json::object{{"sessions", std::move(shown)}, {"next", std::move(next)}});
}

Result<Response> create_session(session::SessionRegistry& sessions, const Doorman& doorman, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    const auto wanted = parse_session_request(call.request.body);
    if (!wanted) return wanted.error();
    if (const auto why = Doorman::objection(*call.token, wanted->name))
        return doorman.refuse(call.request, *why, wanted->name);
    const auto session = sessions.create(wanted->name, wanted->options, session::maker_of(*call.token));
    if (!session) return doorman.noted(call, session.error(), wanted->name);
    auto response = ok(to_json(**session)).set("Location", fmt::format("/api/v1/sessions/{}", wanted->name));
    response.status = Status::created;
    return response;
}

Result<Response> get_session(const session::SessionRegistry& sessions, const session::BackgroundCheck* check,
                             const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    const auto& name = call.arguments["session"];
    if (const auto listed = sessions.listed(name)) return ok(listed_json(*listed, found_by(check)));
    const auto damage = damage_of(sessions, name);
    return damage ? *damage : session::no_such_session(name);
}

Result<Response> delete_session(session::SessionRegistry& sessions, const Forgetful& forgetful, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    const auto& name = call.arguments["session"];
    const auto info = sessions.info(name);
    if (auto removed = sessions.remove(name); !removed) return removed.error();
    if (info) {
        forgetful.weaves.remove_all(info->id);
        forgetful.landmarks.remove(info->id);
        if (forgetful.locator != nullptr) forgetful.locator->remove(info->id);
        forgetful.tiles.forget(session::tag_of(*info));
    }
    return Response{.status = Status::no_content, .fields = {}, .body = {}};
}

} // namespace scanloom::http
