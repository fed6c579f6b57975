#pragma once

#include "robot_client/spool/spool.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::robot {

inline constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;

/// Returns an observation whose pose contains its number, so that scans cannot be confused.
inline Observation numbered(std::uint64_t number, std::uint32_t sensor_id = 0, std::size_t beams = 500) {
    Sensor sensor;
    sensor.id = sensor_id;
    sensor.name = "laser";
    sensor.angles = UniformAngles{0.0, 0.01, 500};
    sensor.range_max = 10.0;
    Observation made{std::make_shared<const Sensor>(sensor), {}};
    made.scan.sensor = sensor_id;
    made.scan.pose = {static_cast<double>(number), 0.0, 0.0};
    made.scan.ranges.assign(beams, static_cast<RangeMm>(number % 10'000));
    return made;
}

class SpoolTest : public testing::Test {
protected:
    void open(std::uint64_t bytes_max = 64 * kMebibyte, WhenFull when_full = WhenFull::kDropOldest) {
        spool_.reset();
        spool_ = Spool::open({directory_.path(), bytes_max, when_full}, [&](const std::string& text) {
                     messages_.push_back(text);
                 }).value();
    }

    /// Appends the scans first..last.
    void take(std::uint64_t first, std::uint64_t last) {
        for (std::uint64_t number = first; number <= last; ++number) {
            ASSERT_TRUE(spool_->append(numbered(number)).value()) << number;
        }
    }

    /// Returns the numbers of the scans from next(), at most `count`.
    std::vector<std::uint64_t> handed_out(std::size_t count = SIZE_MAX) {
        std::vector<std::uint64_t> numbers;
        while (numbers.size() < count) {
            const auto next = spool_->next().value();
            if (!next) break;
            const auto number = static_cast<std::uint64_t>(next->scan.pose->x);
            Observation expected = numbered(number, next->scan.sensor, next->scan.ranges.size());
            expected.scan.seq = next->scan.seq;
            EXPECT_EQ(next->scan, expected.scan);
            EXPECT_EQ(*next->sensor, *expected.sensor);
            numbers.push_back(number);
        }
        return numbers;
    }

    static std::vector<std::uint64_t> from_to(std::uint64_t first, std::uint64_t last) {
        std::vector<std::uint64_t> numbers;
        for (std::uint64_t number = first; number <= last; ++number) numbers.push_back(number);
        return numbers;
    }

    std::vector<std::filesystem::path> files() const {
        std::vector<std::filesystem::path> found;
        for (const auto& entry : std::filesystem::directory_iterator(directory_.path())) {
            if (entry.path().extension() == ".spool") found.push_back(entry.path());
        }
        std::ranges::sort(found);
        return found;
    }

    TemporaryDirectory directory_;
    std::vector<std::string> messages_;
    std::unique_ptr<Spool> spool_;
};

} // namespace scanloom::robot
