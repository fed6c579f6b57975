#pragma once

#include "tests/support/whole_log.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::robot {

/// Reads CARMEN logs from files that are removed at the end of the test.
class CarmenLogFile : public testing::Test {
protected:
    std::filesystem::path write(std::string_view bytes) {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        const auto path = std::filesystem::path(testing::TempDir()) / fmt::format("scanloom_{}.log", test->name());
        std::ofstream(path, std::ios::binary) << bytes;
        paths_.push_back(path);
        return path;
    }

    Result<WholeLog> read(std::string_view bytes, const CarmenOptions& options = {}) {
        return read_whole_log(write(bytes), options, [&](const SkippedLine& line) { skipped_.push_back(line); });
    }

    void TearDown() override {
        for (const auto& path : paths_) std::filesystem::remove(path);
    }

    std::vector<SkippedLine> skipped_;

private:
    std::vector<std::filesystem::path> paths_;
};

inline std::string flaser(double stamp, std::string_view ranges = "2 1.0 2.0") {
    return fmt::format("FLASER {} {} 0 0 {} 0 0 {} host 1\n", ranges, stamp, stamp, stamp);
}

inline std::string robot_laser(std::string_view laser, std::string_view robot, double range_max = 30.0) {
    return fmt::format("ROBOTLASER1 0 -1.5 3 0.1 {} 0.01 0 2 1.0 {} 0 {} {} 0 0 0 0 0 13.0 host 13.1\n", range_max,
                       range_max, laser, robot);
}

/// Returns the text of a log, given lines that end with a line break.
inline std::string text_of(std::initializer_list<std::string_view> lines) {
    return fmt::format("{}", fmt::join(lines, ""));
}

/// Returns one reading of each scan; it identifies the scan.
inline std::vector<RangeMm> first_ranges(const WholeLog& log) {
    std::vector<RangeMm> ranges;
    for (const auto& observation : log.observations) ranges.push_back(observation.scan.ranges[0]);
    return ranges;
}

inline constexpr std::string_view kRawLaser = "RAWLASER1 0 -1.5 3 0.1 30 0.01 0 1 1.0 0 10.5 host 1\n";

} // namespace scanloom::robot
