#include "common/wire/prepared_scan.hpp"

#include "tests/unit/common/wire/example_messages.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace scanloom::wire {
namespace {

std::string encoded(const ScanBatch& batch) {
    std::string frame;
    encode(batch, frame);
    return frame;
}

/// Returns the batch for encoding from prepared scans; each scan is prepared under another number and stamp than it is
/// sent.
std::vector<NumberedScan> numbered(const ScanBatch& batch, std::vector<PreparedScan>& prepared) {
    prepared.clear();
    for (Scan scan : batch.scans) {
        scan.seq += 1000;
        scan.stamp = -1.0;
        prepared.emplace_back(std::move(scan));
    }
    std::vector<NumberedScan> scans;
    for (std::size_t i = 0; i < batch.scans.size(); ++i) {
        scans.push_back({&prepared[i], batch.scans[i].seq, batch.scans[i].stamp});
    }
    return scans;
}

std::string encoded_as_prepared(const ScanBatch& batch) {
    std::vector<PreparedScan> prepared;
    const auto scans = numbered(batch, prepared);
    std::string frame;
    encode_batch(scans, frame);
    EXPECT_EQ(batch_frame_size(scans), frame.size());
    return frame;
}

TEST(PreparedScan, FramesEqualThoseOfTheRegularEncoder) {
    EXPECT_EQ(encoded_as_prepared(example_batch()), encoded(example_batch()));
    ScanBatch one{{example_scan(std::numeric_limits<std::uint64_t>::max())}};
    for (const double stamp : {0.0, -0.0, 1e-300, -976052857.28}) {
        one.scans[0].stamp = stamp;
        EXPECT_EQ(encoded_as_prepared(one), encoded(one)) << stamp;
    }
}

TEST(PreparedScan, RandomBatchesEqualThoseOfTheRegularEncoder) {
    std::mt19937_64 random(7);
    for (int round = 0; round < 200; ++round) {
        ScanBatch batch;
        for (auto left = random() % 5 + 1; left > 0; --left) {
            Scan scan;
            scan.seq = (random() >> random() % 64) | 1;
            scan.stamp = static_cast<double>(random() % 1'000'000) / 7.0;
            scan.sensor = static_cast<std::uint32_t>(random() % 64);
            scan.pose = {static_cast<double>(random() % 100), 0.0, static_cast<double>(random() % 3)};
            scan.ranges.resize(random() % 300);
            for (auto& range : scan.ranges) range = static_cast<RangeMm>(random());
            batch.scans.push_back(std::move(scan));
        }
        ASSERT_EQ(encoded_as_prepared(batch), encoded(batch)) << "round " << round;
    }
}

TEST(PreparedScan, FrameIsAppendedToTheBuffer) {
    std::vector<PreparedScan> prepared;
    std::string out = "before";
    encode_batch(numbered(example_batch(), prepared), out);
    EXPECT_EQ(out, "before" + encoded(example_batch()));
}

} // namespace
} // namespace scanloom::wire
