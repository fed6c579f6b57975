#include "common/wire/log_codec.hpp"
#include "server/sessions/replay_jobs.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/replay_waiting.hpp"
#include "tests/support/whole_log.hpp"

#include <boost/asio/thread_pool.hpp>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <future>
#include <string>
#include <vector>

/// Steps through the history of a real recording.
namespace scanloom {
namespace {

std::filesystem::path intel_log() {
    return std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data/logs/intel-corrected.log.gz";
}

class RealReplay : public testing::Test {
protected:
    static constexpr Revision kStep = 9; // entries

    void SetUp() override {
        if (!std::filesystem::exists(intel_log())) {
            GTEST_SKIP() << "the recorded data, which are no part of the project, are missing: " << intel_log();
        }
        const auto log = robot::read_whole_log(intel_log(), {.no_return = robot::NoReturn::kFree, .limits = {}},
                                               [](const robot::SkippedLine& line) { ADD_FAILURE() << line.reason; });
        ASSERT_TRUE(log) << log.error().message;
        session_.id = log_.create_session("intel").value();
        session_.name = "intel";
        append(RobotJoined{0, "intel"});
        std::shared_ptr<const Sensor> described;
        for (auto [sensor, scan] : log->observations) {
            if (sensor != described) append(SensorDescribed{0, *sensor});
            described = sensor;
            scan.seq = ++scans_;
            append(ScanTaken{0, std::move(scan)});
        }
        std::promise<void> written;
        log_.append(session_.id, 1, std::move(bytes_), [&](const Result<>&) { written.set_value(); });
        written.get_future().wait();
    }
    ~RealReplay() override {
        replay_jobs_.stop();
        pool_.join();
    }

    void append(LogEntry entry) {
        bytes_.push_back(wire::encode_entry(entry));
        entries_.push_back(std::move(entry));
    }

    std::shared_ptr<const mapping::Snapshot> maps_until(sessions::ReplayJobs& replay_jobs, Revision until) {
        const sessions::ReplayRequest request{session_.config, {until, std::nullopt}};
        const auto job = replay_jobs.start(session_, request, entries_.size()).value();
        return testing_support::wait_for_maps(*job, until, std::chrono::minutes(5));
    }

    store::MemoryScanLog log_;
    sessions::SessionInfo session_;
    std::vector<std::string> bytes_;
    std::vector<LogEntry> entries_;
    std::uint64_t scans_ = 0;
    boost::asio::thread_pool pool_{2};
    sessions::ReplayJobs replay_jobs_{log_, pool_.get_executor()};
};

TEST_F(RealReplay, EveryStepEqualsAMapComputedFromTheStart) {
    for (Revision until = kStep; until <= entries_.size(); until += kStep) {
        const auto maps = maps_until(replay_jobs_, until);
        ASSERT_NE(maps, nullptr);
        ASSERT_EQ(maps->revision, until);
        if (until / kStep % 10 != 1) continue; // digests cost more than the steps
        mapping::Projection from_nothing(session_.config);
        for (Revision n = 0; n < until; ++n) ASSERT_TRUE(from_nothing.apply(entries_[n]));
        ASSERT_EQ(testing_support::digests_of(*maps), testing_support::digests_of(from_nothing.snapshot())) << until;
    }
}

} // namespace
} // namespace scanloom
