#pragma once

#include "common/wire/log_codec.hpp"
#include "server/sessions/replay_jobs.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/memory_scan_log.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/support/replay_waiting.hpp"

#include <boost/asio/thread_pool.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::sessions {

using State = ReplayJob::State;
using testing_support::digests_of;

constexpr std::chrono::minutes kTimeout{2}; // upper bound for events that must happen

/// A log that can pause before an entry and counts how often each entry is read.
class WatchedLog final : public store::MemoryScanLog {
public:
    Result<> read(store::SessionId session, Revision after, const VisitEntry& visit) override {
        return MemoryScanLog::read(session, after, [&](Revision revision, std::string_view bytes) -> store::Visited {
            pause_before(revision);
            auto visited = visit(revision, bytes);
            const std::lock_guard lock(mutex_);
            if (visited && *visited == store::Visit::kContinue) ++taken_[revision];
            return visited;
        });
    }

    /// A reader pauses once at the entry.
    class Pause {
    public:
        /// Waits until a reader has reached the entry.
        void wait() { reached.get_future().wait(); }
        void end() { ended.set_value(); }

    private:
        friend WatchedLog;
        std::promise<void> reached;
        std::promise<void> ended;
    };
    std::shared_ptr<Pause> pause_at(Revision revision) {
        const std::lock_guard lock(mutex_);
        return pauses_[revision] = std::make_shared<Pause>();
    }

    /// Returns how often each entry was read, in log order.
    [[nodiscard]] std::vector<int> taken() const {
        const std::lock_guard lock(mutex_);
        std::vector<int> counts;
        for (const auto& [revision, count] : taken_) counts.push_back(count);
        return counts;
    }

private:
    void pause_before(Revision revision) {
        std::shared_ptr<Pause> pause;
        {
            const std::lock_guard lock(mutex_);
            if (const auto found = pauses_.extract(revision)) pause = found.mapped();
        }
        if (!pause) return;
        pause->reached.set_value();
        pause->ended.get_future().wait();
    }

    mutable std::mutex mutex_; // guards the members below
    std::map<Revision, std::shared_ptr<Pause>> pauses_;
    std::map<Revision, int> taken_;
};

/// A log of 40 scans at intervals of 1 s; a test appends all or a part of its entries.
class ReplayFixture : public testing::Test {
protected:
    static constexpr std::uint64_t kScans = 40;

    ReplayFixture() {
        entries_ = {RobotJoined{0, "r"}, SensorDescribed{0, testing_support::small_laser()}};
        for (std::uint64_t seq = 1; seq <= kScans; ++seq) {
            Scan scan = testing_support::random_scan(static_cast<unsigned>(seq), seq);
            scan.stamp = 1000.0 + static_cast<double>(seq);
            entries_.push_back(ScanTaken{0, std::move(scan)});
        }
        session_.id = log_.create_session("s").value();
        session_.name = "s";
    }
    ~ReplayFixture() override {
        replay_jobs_.stop();
        pool_.join();
    }

    /// Appends the log's next entries up to `revision`.
    void append_up_to(Revision revision) {
        while (appended_ < revision) append(entries_[appended_]);
    }
    void append_all() { append_up_to(entries_.size()); }
    void append(const LogEntry& entry) {
        std::promise<Result<>> done;
        log_.append(session_.id, appended_ + 1, {wire::encode_entry(entry)},
                    [&](Result<> appended) { done.set_value(std::move(appended)); });
        ASSERT_TRUE(done.get_future().get());
        ++appended_;
    }

    /// Returns a laser whose range has too many cells at a resolution of 0.01 m.
    static Sensor far_laser() {
        Sensor sensor = testing_support::small_laser();
        sensor.name = "far";
        sensor.range_max = 500.0;
        return sensor;
    }

    [[nodiscard]] static ReplayRequest request(const SessionOptions& options, ReplayEnd end = {}) {
        return {mapping::resolve(options).value(), end};
    }

    /// Returns the digests of a session that was created with these options and got the first `entries` entries.
    [[nodiscard]] std::string digests_of_session(const SessionOptions& options, std::size_t entries) const {
        mapping::Projection projection(mapping::resolve(options).value());
        for (std::size_t n = 0; n < entries; ++n) EXPECT_TRUE(projection.apply(entries_[n]));
        return digests_of(projection.snapshot());
    }

    /// Starts a replay job when the session shows all entries of its log.
    [[nodiscard]] std::shared_ptr<ReplayJob> start(const ReplayRequest& wanted) {
        return replay_jobs_.start(session_, wanted, appended_).value();
    }

    /// Waits until the job has ended.
    static void finish(ReplayJob& job) {
        static_cast<void>(testing_support::wait_for_maps(job, job.progress().target, kTimeout));
    }

    [[nodiscard]] std::shared_ptr<ReplayJob> finished(const ReplayRequest& wanted) {
        auto job = start(wanted);
        finish(*job);
        return job;
    }

    WatchedLog log_;
    SessionInfo session_;
    std::vector<LogEntry> entries_;
    Revision appended_ = 0; // entries
    boost::asio::thread_pool pool_{2};
    ReplayJobs replay_jobs_{log_, pool_.get_executor()};
};

} // namespace scanloom::sessions
