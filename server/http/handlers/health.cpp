#include "server/http/handlers/health.hpp"

#include "server/http/problem.hpp"

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

namespace scanloom::http {

Result<Response> get_livez(const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    return ok("text/plain; charset=utf-8", Body("ok\n")).set("Cache-Control", kNotKept);
}

Result<Response> get_readyz(const session::SessionRegistry& sessions, const store::ScanLog& log, bool recovered,
                            const Call& call) {
    if (auto known = call.query.check_only({}); !known) return known.error();
    boost::json::array reasons;
    if (!recovered) reasons.emplace_back("the sessions are still being recovered from the store");
    if (sessions.is_draining()) reasons.emplace_back("the server is shutting down");
    if (const auto error = log.stats().last_error) reasons.emplace_back("the store failed: " + *error);
    if (reasons.empty()) return ok(boost::json::object{{"status", "ready"}});
    return problem(Status::service_unavailable, "the server is not ready", "/readyz", {{"reasons", reasons}});
}

} // namespace scanloom::http
