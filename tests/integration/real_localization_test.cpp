#include "core/landmarks/captures.hpp"
#include "core/landmarks/localization.hpp"
#include "tests/support/angles.hpp"
#include "tests/support/whole_log.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

/// Localizes robots in their own maps of real buildings, with scans from other times.
namespace scanloom::landmarks {
namespace {

constexpr std::size_t kAsked = 20;  // for each log
constexpr std::size_t kLeftOut = 3; // captures before and after the localized one

std::filesystem::path path_of(const std::string& file) {
    return std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data/logs" / file;
}

std::vector<Capture> captures_of(const robot::WholeLog& log) {
    SessionCaptures cutter;
    std::vector<Capture> captures;
    const auto add = [&](LogEntry entry) {
        if (auto ended = cutter.add(entry)) captures.push_back(std::move(ended->capture));
    };
    std::shared_ptr<const Sensor> described;
    for (const auto& [sensor, scan] : log.observations) {
        if (sensor != described) add(SensorDescribed{0, *sensor});
        described = sensor;
        add(ScanTaken{0, scan});
    }
    return captures;
}

ReferenceViews all_but(const std::vector<Capture>& captures, std::size_t asked) {
    ReferenceViews map;
    for (std::size_t n = 0; n < captures.size(); ++n) {
        if (n + kLeftOut >= asked && n <= asked + kLeftOut) continue;
        map.push_back(std::make_shared<const ReferenceView>(ReferenceView{captures[n].from, captures[n].points, n}));
    }
    return map;
}

class RealLocalization : public testing::TestWithParam<const char*> {};

TEST_P(RealLocalization, ClearAnswersAreCorrectAndFrequent) {
    if (!std::filesystem::exists(path_of(GetParam()))) {
        GTEST_SKIP() << "the recorded data, which are no part of the project, are missing: " << path_of(GetParam());
    }
    const auto log = robot::read_whole_log(path_of(GetParam()), {}, [](const robot::SkippedLine&) {});
    ASSERT_TRUE(log) << log.error().message;
    const auto captures = captures_of(*log);
    std::size_t clear = 0;
    for (std::size_t n = 0; n < kAsked; ++n) {
        const std::size_t asked = (2 * n + 1) * captures.size() / (2 * kAsked);
        const Capture& capture = captures[asked];
        std::vector<Point2> seen = in_metres(capture.points); // without the robot's pose
        for (Point2& point : seen) point = transform(inverse(capture.pose), point);
        const Point2 from = transform(inverse(capture.pose), capture.from);
        const auto found = locate(all_but(captures, asked), {.points = seen, .from = from});
        ASSERT_TRUE(found) << found.error().message;
        if (found->certainty != Certainty::kClear) continue;
        ++clear;
        const Pose2 off = compose(inverse(capture.pose), found->T_first_second);
        EXPECT_LT(std::hypot(off.x, off.y), 0.2) << "capture " << asked << ": the poses of the logs have this accuracy";
        EXPECT_LT(std::abs(off.yaw), 3.0 * kDegree) << "capture " << asked;
    }
    EXPECT_GE(clear, kAsked * 6 / 10);
}

INSTANTIATE_TEST_SUITE_P(All, RealLocalization, testing::Values("intel-corrected.log.gz", "fr079-corrected.log.gz"));

} // namespace
} // namespace scanloom::landmarks
