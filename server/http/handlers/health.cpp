#include "server/http/handlers/health.hpp"

#include "server/http/handlers/session_json.hpp"
#include "server/http/problem.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

namespace scanloom::http {
namespace {

/// Damaged and failed sessions do not affect readiness, because the other sessions are available.
boost::json::object readiness(const session::SessionRegistry& sessions, const session::BackgroundCheck* check,
                              const RobotPort& robots, const access::TokenRef& seen_by) {
    const auto is_seen = [&](std::string_view session) { return seen_by && is_for(*seen_by, session); };
    boost::json::array damaged;
    auto found = sessions.damaged();
    if (check != nullptr) found.merge(check->damaged());
    for (const auto& [name, reason] : found) {
        if (is_seen(name)) damaged.push_back(damaged_json(name, reason));
    }
    boost::json::array failed;
    for (const auto& session : sessions.list()) {
        if (!is_seen(session->info().name)) continue;
        if (const auto reason = session->failure()) failed.push_back(failed_json(session->info().name, *reason));
    }
    boost::json::value host;
    if (!robots.host.empty()) host = boost::json::string(robots.host);
    return {{"status", "ready"},
            {"robots", boost::json::object{{"host", std::move(host)}, {"port", robots.port}}},
            {"damaged", std::move(damaged)},
            {"failed", std::move(failed)}};
}

} // namespace

Result<Response> get_livez(const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    return ok("text/plain; charset=utf-8", Body("ok\n")).set("Cache-Control", kNotKept);
}

Result<Response> get_readyz(const session::SessionRegistry& sessions, const session::BackgroundCheck* check,
                            const store::ScanLog& log, bool recovered, const RobotPort& robots, const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    boost::json::array reasons;
    if (!recovered) reasons.emplace_back("the sessions are still being recovered from the store");
    if (sessions.is_draining()) reasons.emplace_back("the server is shutting down");
    const auto store = log.stats();
    if (store.last_error) reasons.emplace_back("the store failed: " + *store.last_error);
    if (store.no_room) reasons.emplace_back(*store.no_room);
    if (reasons.empty()) return ok(readiness(sessions, check, robots, call.token));
    return problem(Status::service_unavailable, "the server is not ready", "/readyz", {{"reasons", reasons}});
}

} // namespace scanloom::http
