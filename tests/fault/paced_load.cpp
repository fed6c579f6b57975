#include "tests/fault/paced_load.hpp"

#include "tests/support/running_server.hpp"

#include <boost/json/parse.hpp>
#include <fmt/format.h>

namespace scanloom::fault {

PacedLoad::PacedLoad(const ServerProcess& server, const Robots& robots, std::uint64_t seed,
                     std::chrono::seconds duration, const std::filesystem::path& place)
    : server_(server), robots_(robots), seed_(seed),
      program_(test::program("scanloom-load"),
               {"--server", fmt::format("127.0.0.1:{}", server.robot_port()), "--http",
                fmt::format("127.0.0.1:{}", server.http_port()), "--robots", std::to_string(robots.count), "--sessions",
                std::to_string(robots.sessions), "--rate", std::to_string(robots.rate), "--course", "100", "--seed",
                std::to_string(seed), "--duration", std::to_string(duration.count()), "--json", "-"},
               place / fmt::format("load-{}.log", seed)) {}

void PacedLoad::wait_until_it_streams() const {
    const auto last = "/api/v1/sessions/" + session(robots_.sessions - 1);
    while (test::http_request(server_.http_port(), "GET", last).status != 200) {
        if (program_.has_output_within(std::chrono::milliseconds(5))) return; // ended: finish() reports the cause
    }
}

PacedLoad::Report PacedLoad::finish() {
    std::string text;
    while (const auto line = program_.read_line()) text += *line;
    return read_report(text, program_.wait());
}

PacedLoad::Report PacedLoad::read_report(std::string_view text, int code) {
    Report report;
    boost::system::error_code failed;
    const auto json = boost::json::parse(text, failed);
    if (failed) {
        report.outcome.failures.push_back(fmt::format("scanloom-load ended with {} and no report", code));
        return report;
    }
    const auto* from_intended = json.as_object().if_contains("ack_from_intended"); // present if robots keep a pace
    if (from_intended != nullptr && from_intended->at("count").to_number<std::uint64_t>() > 0)
        report.p99_ms = from_intended->at("p99_ms").to_number<double>();
    report.outcome.acknowledged = json.at("scans").at("acknowledged").to_number<std::uint64_t>();
    report.outcome.lost = json.at("scans").at("lost").to_number<std::uint64_t>();
    const auto& verdict = json.at("verdict");
    report.outcome.digest_equal = verdict.at("nothing_lost").as_bool();
    if (code != 0 || !report.outcome.digest_equal)
        report.outcome.failures.emplace_back(verdict.at("sentence").as_string());
    return report;
}

} // namespace scanloom::fault
