#pragma once

#include "server/http/api.hpp"

#include <boost/asio/system_executor.hpp>

#include <functional>
#include <optional>
#include <utility>

namespace scanloom::http {

/// An Api over given parts; what tests seldom look at is its own.
class TestApi {
public:
    TestApi(session::SessionRegistry& sessions, session::Weaves& weaves, guide::GoalBook& goals, store::ScanLog& log,
            const metrics::Metrics& metrics, Doorman doorman, WebFiles web = {})
        : check_(log, sessions, boost::asio::system_executor()), locator_(log), services_{.sessions = sessions,
                                                                                          .weaves = weaves,
                                                                                          .goals = goals,
                                                                                          .locator = locator_,
                                                                                          .log = log,
                                                                                          .check = check_,
                                                                                          .metrics = metrics,
                                                                                          .doorman = doorman,
                                                                                          .web = std::move(web)} {}

    [[nodiscard]] Services& services() { return services_; }
    void set_recovered() { services_.recovered = true; }

    [[nodiscard]] Response answer(const Request& request) { return api_.answer(request); }
    [[nodiscard]] Outlook look(const Request& request) { return api_.look(request); }
    void wake(const Asleep& asleep, std::function<void()> on_loaded) { api_.wake(asleep, std::move(on_loaded)); }
    [[nodiscard]] std::optional<Response> refuse(const Request& request) const { return api_.refuse(request); }

private:
    session::BackgroundCheck check_; // never started
    guide::Locator locator_;
    Services services_;
    Api api_{services_};
};

} // namespace scanloom::http
