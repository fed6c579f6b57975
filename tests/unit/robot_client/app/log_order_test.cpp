#include "common/app/standard_streams.hpp"
#include "robot_client/app/make_source.hpp"
#include "robot_client/app/options.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <unistd.h>

#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;

/// Returns why a file cannot be replayed.
std::string refusal_of(std::string_view bytes) {
    const TemporaryDirectory directory;
    const auto path = directory.path() / "file";
    std::ofstream(path, std::ios::binary) << bytes;
    StandardError error(STDERR_FILENO);
    Console console(error);
    RobotOptions robot;
    robot.source = ReplayOptions{path.string()};
    const auto prepared = make_source(robot, console);
    return prepared ? "" : prepared.error().message;
}

TEST(FileToReplay, IsRefusedWithItsReason) {
    EXPECT_THAT(refusal_of(""), HasSubstr("the file is empty"));
    const std::string_view bag_by_gzip("\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\xff\x53\x0e\xf2\x0f\x76\x72\x74"
                                       "\x57\x08\x33\xd2\x33\xe0\x02\x00\x3d\x6c\x71\xb5\x0d\x00\x00\x00",
                                       33);
    EXPECT_THAT(refusal_of(bag_by_gzip), HasSubstr("decompress it with `gunzip`"));
}

/// Returns what the client reports about a log whose scans have these stamps, and the order in its summary.
std::pair<std::string, std::string> reported(std::initializer_list<double> stamps) {
    const TemporaryDirectory directory;
    const auto path = directory.path() / "stamps.clf";
    std::ofstream file(path);
    for (const double stamp : stamps) file << fmt::format("FLASER 1 1.0 0 0 0 0 0 0 {} host {}\n", stamp, stamp);
    file.close();
    const auto shown = directory.path() / "shown";
    const int descriptor = ::open(shown.c_str(), O_RDWR | O_CREAT | O_APPEND, 0600);
    StandardError error(descriptor);
    Console console(error);
    RobotOptions options;
    options.source = ReplayOptions{path.string()};
    const auto prepared = make_source(options, console);
    EXPECT_TRUE(prepared);
    ::close(descriptor);
    std::stringstream lines;
    lines << std::ifstream(shown).rdbuf();
    return {lines.str(), prepared ? std::string(prepared->order) : ""};
}

TEST(OrderOfALog, IsReportedWithItsReason) {
    EXPECT_EQ(reported({1, 2, 3}), std::pair(std::string(), std::string("file")));
    const auto [jitter, kept] = reported({1, 3, 2, 4});
    EXPECT_THAT(jitter, HasSubstr("they jitter, so the scans are sent in the order of the file"));
    EXPECT_EQ(kept, "file");
    const auto [parts, sorted] = reported({11, 12, 1, 2});
    EXPECT_THAT(parts, HasSubstr("stamps decrease 1 times, by up to 11.000 s: parts are out of order"));
    EXPECT_EQ(sorted, "time");
    const auto [clock, unsorted] = reported({1, 5, 10, 5.5, 10.5});
    EXPECT_THAT(clock, HasSubstr("by up to 4.500 s: the clock was set back or a stamp is wrong, so the scans are sent "
                                 "in the order of the file"));
    EXPECT_EQ(unsorted, "file");
}

} // namespace
} // namespace scanloom::robot
