#pragma once

#include "server/http/routes.hpp"
#include "server/sessions/session_registry.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/replay_waiting.hpp"
#include "tests/unit/server/http/described_answer.hpp"
#include "tests/unit/server/http/test_api.hpp"

#include <boost/asio/thread_pool.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <map>
#include <numbers>

namespace scanloom::http {

using testing::HasSubstr;
using testing::StartsWith;

/// A link that records when a scan has become durable.
class Link final : public sessions::RobotListener {
public:
    explicit Link(std::uint64_t awaited_seq) : awaited_(awaited_seq) {}

    void on_durable(std::uint64_t durable_seq, std::size_t) override {
        if (durable_seq == awaited_) done_.set_value();
    }
    void on_failed(const Error&) override { failed_.set_value(); }
    void wait() { done_.get_future().wait(); }
    void wait_for_failure() { failed_.get_future().wait(); }

private:
    std::uint64_t awaited_;
    std::promise<void> done_;
    std::promise<void> failed_;
};

inline Sensor laser() {
    Sensor sensor;
    sensor.id = 1;
    sensor.name = "laser";
    sensor.angles = UniformAngles{-std::numbers::pi / 2, std::numbers::pi / 180, 181};
    sensor.range_max = 20.0;
    return sensor;
}

/// A wall around the robot at 2 m.
inline Scan scan(std::uint64_t seq) {
    Scan taken;
    taken.seq = seq;
    taken.stamp = 100.0 + static_cast<double>(seq);
    taken.sensor = 1;
    taken.pose = {0.5 * static_cast<double>(seq), 1.25, 0.0};
    taken.ranges.assign(181, 2'000);
    return taken;
}

/// Returns the address of a route with a value for every variable.
inline std::string target_of(const Route& route, std::string_view session) {
    std::string target(route.path);
    const std::map<std::string, std::string> values = {{"{session}", std::string(session)},
                                                       {"{layer}", "occupancy"},
                                                       {"{z}", "9"},
                                                       {"{x}", "256"},
                                                       {"{y}", "255"},
                                                       {"{weave}", "none"},
                                                       {"{exclusion}", "1"},
                                                       {"{file}", "none.js"}};
    for (const auto& [name, value] : values) {
        if (const auto at = target.find(name); at != std::string::npos) target.replace(at, name.size(), value);
    }
    return target;
}

/// An API over sessions in memory.
class ApiTest : public testing::Test {
protected:
    ApiTest() { api_.set_recovered(); }
    ~ApiTest() override {
        registry_.drain();
        weaves_.stop();
        pool_.join();
    }

    Response ask(std::string method, std::string target, std::string body = "", std::string if_none_match = "") {
        Request request;
        request.method = std::move(method);
        request.target = std::move(target);
        request.content_type = "application/json";
        request.if_none_match = std::move(if_none_match);
        request.body = std::move(body);
        return answer(api_, request);
    }

    /// Checks every response against openapi.json.
    static Response answer(TestApi& api, const Request& request) {
        auto response = api.answer(request);
        EXPECT_THAT(undescribed(request, response), testing::IsEmpty());
        return response;
    }

    Response get(std::string target, std::string if_none_match = "") {
        return ask("GET", std::move(target), "", std::move(if_none_match));
    }

    /// Returns a whole log.
    std::string log(const std::string& session, const std::string& query = "") {
        const auto response = get("/api/v1/sessions/" + session + "/log" + query);
        std::string text;
        for (auto piece = response.stream->next().value(); !piece.empty(); piece = response.stream->next().value()) {
            text += piece;
        }
        return text;
    }

    boost::json::value get_json(std::string target) {
        const auto response = get(std::move(target));
        EXPECT_EQ(response.status, Status::ok) << response.body.bytes();
        return boost::json::parse(response.body.bytes());
    }

    /// Returns the detail of a refusal after checking its status.
    std::string detail(const Response& response, Status status) {
        EXPECT_EQ(response.status, status) << response.body.bytes();
        EXPECT_EQ(response.get("Content-Type"), "application/problem+json");
        return std::string(boost::json::parse(response.body.bytes()).at("detail").as_string());
    }

    void create(std::string name) {
        ASSERT_EQ(ask("POST", "/api/v1/sessions", R"({"name":")" + name + R"("})").status, Status::created);
    }

    /// Sends scans `first` to `last` of robot r1 and waits until they are integrated; the link stays open.
    void stream(std::string_view name, std::uint64_t last, std::uint64_t first = 1) {
        std::vector<Scan> scans;
        for (std::uint64_t seq = first; seq <= last; ++seq) scans.push_back(scan(seq));
        stream(name, "r1", std::move(scans));
    }

    /// Sends the robot's next scans and waits until they are integrated; the link stays open.
    void stream(std::string_view name, const std::string& robot, std::vector<Scan> scans) {
        const auto session = registry_.find(name);
        const auto link = join(name, robot, scans.back().seq);
        session->submit(link, laser(), 0);
        session->submit(link, std::move(scans), 1);
        link->wait();
    }

    std::shared_ptr<Link> join(std::string_view name, const std::string& robot, std::uint64_t awaited_seq,
                               std::optional<double> body_radius = {}) {
        const auto link = std::make_shared<Link>(awaited_seq);
        std::promise<void> joined;
        registry_.find(name)->join({robot, "", body_radius}, link,
                                   [&joined](const Result<sessions::Joined>&) { joined.set_value(); });
        joined.get_future().wait();
        links_.push_back(link);
        return link;
    }

    /// Waits for the end of the replay job.
    void finish_weave(std::string_view name, std::string_view id) {
        const auto weave = weaves_.find(registry_.find(name)->info().id, id);
        ASSERT_NE(weave, nullptr);
        static_cast<void>(testing_support::wait_for_maps(*weave, weave->progress().target, std::chrono::minutes(2)));
    }

    boost::asio::thread_pool pool_{2};
    store::MemoryScanLog log_;
    std::atomic<sessions::SessionCache::Clock::time_point> clock_{}; ///< constant, unless a test sets it
    sessions::SessionRegistry registry_{log_,
                                        {.compute = pool_.get_executor(),
                                         .now = [] { return 1795251600.5; },
                                         .clock = [this] { return clock_.load(); }}};
    metrics::Metrics metrics_{"1.2.3"};
    sessions::ReplayJobs weaves_{log_, pool_.get_executor()};
    guidance::GoalAssignments goals_;
    auth::Authenticator authenticator_;
    auth::AuditLog audit_{metrics_.registry()};
    auth::LoginSessions logins_;
    TestApi api_{registry_, weaves_, goals_, log_, metrics_, {authenticator_, audit_, logins_}, {}};
    std::vector<std::shared_ptr<Link>> links_;
};

} // namespace scanloom::http
