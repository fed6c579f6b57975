#include "server/ingest/unacknowledged.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

namespace scanloom::ingest {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::Pair;

class UnacknowledgedTest : public testing::Test {
protected:
    static Unacknowledged::Time at(int ms) { return Unacknowledged::Time(std::chrono::hours(5)) + milliseconds(ms); }

    [[nodiscard]] double in_flight() const { return counters_.scans_in_flight.Value(); }

    /// Returns the upper bounds (s) and counts of the non-empty buckets.
    [[nodiscard]] std::vector<std::pair<double, std::uint64_t>> waits() const {
        std::vector<std::pair<double, std::uint64_t>> waits;
        std::uint64_t before = 0;
        const auto family = counters_.ack_seconds.family();
        for (const auto& bucket : family.metric.at(0).histogram.bucket) {
            if (bucket.cumulative_count > before) {
                waits.emplace_back(bucket.upper_bound, bucket.cumulative_count - before);
            }
            before = bucket.cumulative_count;
        }
        return waits;
    }

    prometheus::Registry registry_;
    metrics::IngestCounters counters_{registry_};
    std::optional<Unacknowledged> link_{std::in_place, counters_};
};

TEST_F(UnacknowledgedTest, ScanIsCountedFromReadToAck) {
    link_->add(10, 10, at(0));
    link_->add(13, 3, at(30));
    EXPECT_EQ(in_flight(), 13.0);
    link_->acknowledge(10, at(40));
    EXPECT_THAT(waits(), ElementsAre(Pair(0.05, 10U)));
    EXPECT_EQ(in_flight(), 3.0);
    link_->acknowledge(13, at(31));
    EXPECT_THAT(waits(), ElementsAre(Pair(0.001, 3U), Pair(0.05, 10U)));
    EXPECT_EQ(in_flight(), 0.0);
}

TEST_F(UnacknowledgedTest, AckCoversBatchesAndAPartOfTheNext) {
    for (std::uint64_t n = 1; n <= 4; ++n) link_->add(10 * n, 10, at(0));
    link_->acknowledge(35, at(2));
    EXPECT_THAT(waits(), ElementsAre(Pair(0.0025, 30U)));
    EXPECT_EQ(in_flight(), 10.0);
    link_->acknowledge(35, at(3)); // no change
    EXPECT_EQ(in_flight(), 10.0);
}

TEST_F(UnacknowledgedTest, ResentScansAreAcknowledgedAtOnce) {
    link_->add(20, 5, at(0));
    link_->acknowledge(100, at(0));
    EXPECT_THAT(waits(), ElementsAre(Pair(0.0005, 5U)));
    EXPECT_EQ(in_flight(), 0.0);
}

TEST_F(UnacknowledgedTest, ClosedLinkHasNoScansInFlight) {
    Unacknowledged other(counters_);
    other.add(1, 1, at(0));
    link_->add(10, 10, at(0));
    link_->add(20, 10, at(0));
    link_.reset();
    EXPECT_EQ(in_flight(), 1.0);
    EXPECT_THAT(waits(), ElementsAre());
}

} // namespace
} // namespace scanloom::ingest
