#include "tests/fault/readiness.hpp"

#include "tests/support/running_server.hpp"

#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace scanloom::fault {

Readiness readiness(const ServerProcess& server) {
    auto answer = test::http_request(server.http_port(), "GET", "/readyz");
    return {answer.status, std::move(answer.body)};
}

Readiness wait_for_readiness(const ServerProcess& server, unsigned status, const std::function<void()>& doing) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    for (;;) {
        auto found = readiness(server);
        if (found.status == status || std::chrono::steady_clock::now() > until) return found;
        doing();
        server.let_be(std::chrono::milliseconds(5));
    }
}

void check_that_maps_are_served(const ServerProcess& server, std::string_view when, Outcome& outcome) {
    const auto status = test::http_request(server.http_port(), "GET", "/api/v1/sessions/shared/digest").status;
    if (status != 200)
        outcome.failures.push_back(fmt::format("the digest request is answered with {} {}", status, when));
}

} // namespace scanloom::fault
