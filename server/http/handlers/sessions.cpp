#include "server/http/handlers/sessions.hpp"

#include "common/scan/limits.hpp"
#include "server/http/handlers/session_json.hpp"
#include "server/http/handlers/session_lookup.hpp"
#include "server/http/in_quotes.hpp"
#include "server/http/json_text.hpp"
#include "server/http/number.hpp"

#include <boost/json/array.hpp>
#include <fmt/format.h>

#include <algorithm>

namespace scanloom::http {
namespace {

constexpr std::size_t kLimitMax = 1000;

struct Page {
    std::size_t limit = 100;
    std::string_view after; ///< empty: from the first
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
        if (!is_valid_name(*after)) {
            return Error{Errc::kInvalidField,
                         fmt::format("after is {}; the name of a session is needed", in_quotes(*after))};
        }
        page.after = *after;
    }
    return page;
}

} // namespace

Result<Response> list_sessions(const session::SessionRegistry& sessions, const Call& call) {
    const auto page = parse_page(call.query);
    if (!page) return page.error();
    const auto all = sessions.list();
    const auto first = std::ranges::upper_bound(
        all, page->after, {}, [](const auto& session) -> std::string_view { return session->info().name; });
    boost::json::array shown;
    boost::json::value next = nullptr;
    for (auto session = first; session != all.end() && shown.size() < page->limit; ++session) {
        shown.push_back(to_json(**session));
        if (shown.size() == page->limit && session + 1 != all.end())
            next = boost::json::string((*session)->info().name);
    }
    return ok(boost::json::object{{"sessions", std::move(shown)}, {"next", std::move(next)}});
}

Result<Response> create_session(session::SessionRegistry& sessions, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    const auto wanted = parse_session_request(call.request.body);
    if (!wanted) return wanted.error();
    const auto session = sessions.create(wanted->name, wanted->options);
    if (!session) return session.error();
    auto response = ok(to_json(**session)).set("Location", fmt::format("/api/v1/sessions/{}", wanted->name));
    response.status = Status::created;
    return response;
}

Result<Response> get_session(const session::SessionRegistry& sessions, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    const auto session = find_session(sessions, call);
    if (!session) return session.error();
    return ok(to_json(**session));
}

Result<Response> delete_session(session::SessionRegistry& sessions, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    if (auto removed = sessions.remove(call.arguments["session"]); !removed) return removed.error();
    return Response{.status = Status::no_content, .fields = {}, .body = {}};
}

} // namespace scanloom::http
