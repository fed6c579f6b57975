#pragma once

#include "common/wire/log_codec.hpp"
#include "server/sessions/recovery.hpp"
#include "server/sessions/session.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/log_reading.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/random_scans.hpp"

#include <boost/asio/io_context.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::sessions {

using testing_support::random_scan;
using testing_support::random_scans;
using testing_support::small_laser;

/// A link that records its events.
struct RecordedLink : RobotListener {
    void on_durable(std::uint64_t seq, std::size_t bytes) override {
        durable_seqs.push_back(seq);
        bytes_released += bytes;
    }
    void on_failed(const Error& error) override { failures.push_back(error); }

    [[nodiscard]] std::uint64_t durable_seq() const { return durable_seqs.empty() ? 0 : durable_seqs.back(); }

    std::vector<std::uint64_t> durable_seqs;
    std::size_t bytes_released = 0;
    std::vector<Error> failures;
};

/// A session with a log in memory. All work runs in run(), on the test's thread.
class SessionTest : public testing::Test {
protected:
    void SetUp() override {
        id_ = log_.create_session("an unused record").value();
        start_session();
    }

    /// Starts the session from its log, as after a restart.
    void start_session() {
        auto recovered = recover(log_, id_, config_, false).value();
        session_ = std::make_shared<Session>(SessionInfo{id_, "lab", 0.0, config_}, std::move(recovered.maps),
                                             recovered.checkpointed, log_, compute_.get_executor(), counters_, limits_);
    }

    void run() {
        compute_.restart();
        compute_.run();
    }

    /// `answer` contains nullopt until the join is answered.
    struct Join {
        std::shared_ptr<RecordedLink> link = std::make_shared<RecordedLink>();
        std::shared_ptr<std::optional<Result<Joined>>> answer = std::make_shared<std::optional<Result<Joined>>>();
    };

    Join begin_join(const std::string& robot, const std::string& source = {}, std::optional<double> body_radius = {},
                    Poses poses = Poses::kMap) {
        Join join;
        session_->join({robot, source, body_radius, poses}, join.link,
                       [answer = join.answer](Result<Joined> joined) { answer->emplace(std::move(joined)); });
        run();
        return join;
    }

    /// Joins a robot and, by default, describes its laser. Returns its link.
    std::shared_ptr<RecordedLink> join(const std::string& robot, bool describe = true) {
        const auto join = begin_join(robot);
        EXPECT_TRUE(join.answer->has_value() && join.answer->value()) << robot;
        if (describe) session_->submit(join.link, small_laser(), 0);
        run();
        return join.link;
    }

    std::uint64_t last_durable_seq_on_joining(const std::string& robot) {
        return begin_join(robot).answer->value().value().last_durable_seq;
    }

    [[nodiscard]] std::vector<LogEntry> logged() {
        std::vector<LogEntry> entries;
        for (const auto& bytes : store::entries_after(log_, id_, 0).value()) {
            entries.push_back(wire::decode_entry(bytes).value());
        }
        return entries;
    }

    /// Returns the digests of the map that results from applying the whole log.
    [[nodiscard]] std::string digest_of_log() {
        mapping::Projection projection(config_);
        for (const auto& entry : logged()) EXPECT_TRUE(projection.apply(entry));
        return testing_support::digests_of(projection.snapshot());
    }

    [[nodiscard]] std::string digest() const { return testing_support::digests_of(*session_->snapshot()); }

    boost::asio::io_context compute_;
    store::MemoryScanLog log_;
    store::SessionId id_ = 0;
    mapping::MapConfig config_;
    SessionLimits limits_;
    std::shared_ptr<SessionCounters> counters_ = std::make_shared<SessionCounters>();
    std::shared_ptr<Session> session_;
};

} // namespace scanloom::sessions
