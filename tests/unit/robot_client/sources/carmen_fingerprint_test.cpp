#include "robot_client/sources/carmen_log.hpp"

#include "tests/support/packed_text.hpp"
#include "tests/unit/robot_client/sources/carmen_log_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

namespace scanloom::robot {
namespace {

using testing_support::bzip2;
using testing_support::gzip;

class CarmenFingerprint : public CarmenLogFile {};

TEST_F(CarmenFingerprint, DependsOnTheScanOrder) {
    const auto rising = text_of({flaser(1), flaser(2), flaser(3)});
    const auto jittering = text_of({flaser(2), flaser(1), flaser(3)});
    EXPECT_NE(read(rising)->fingerprint, read(jittering)->fingerprint);
    EXPECT_EQ(read(flaser(1))->fingerprint, "carmen:d4bfaa8d490f9a80ff3f167a63709ac5");
    EXPECT_NE(read(jittering)->fingerprint, "carmen:b4e2f736ab9cae529515ea4b23307515")
        << "the fingerprint of the order by stamp";
    const auto set_back = text_of({flaser(10), flaser(20), flaser(12), flaser(15), flaser(14.5)});
    EXPECT_NE(read(set_back)->fingerprint, "carmen:8c8fcc02c3b3391d76899009e4c1bfb5")
        << "the fingerprint of clients that sorted parts which overlap";
}

TEST_F(CarmenFingerprint, IsThatOfTheScans) {
    const auto text = text_of({"# made on Monday\n", flaser(1), robot_laser("0 0 0", "0 0 0")});
    const std::string fingerprint = read(text)->fingerprint;
    EXPECT_THAT(fingerprint, testing::MatchesRegex("carmen:[0-9a-f]+"));
    EXPECT_LE(fingerprint.size(), 64U);
    EXPECT_EQ(read(gzip(text))->fingerprint, fingerprint);
    EXPECT_EQ(read(bzip2(text))->fingerprint, fingerprint);
    EXPECT_EQ(read(text_of({flaser(1), "# made on Tuesday\n", robot_laser("0 0 0", "0 0 0")}))->fingerprint,
              fingerprint);
    EXPECT_EQ(read(text_of({flaser(1), "FLASER 3 1 2\n", robot_laser("0 0 0", "0 0 0")}))->fingerprint, fingerprint)
        << "an unusable line does not change the fingerprint";
    EXPECT_NE(read(text_of({flaser(1), flaser(2), robot_laser("0 0 0", "0 0 0")}))->fingerprint, fingerprint);
    EXPECT_NE(read(text_of({flaser(1), robot_laser("0 0 0", "0 0 0.1")}))->fingerprint, fingerprint);
    EXPECT_NE(read(text_of({robot_laser("0 0 0", "0 0 0"), flaser(1)}))->fingerprint, fingerprint);
}

TEST_F(CarmenFingerprint, DependsOnOptionsThatChangeScans) {
    const std::string text = flaser(1);
    const auto with = [&](std::optional<NoReturn> no_return, std::optional<double> range_max) {
        return read(text, {no_return, range_max, {}})->fingerprint;
    };
    EXPECT_EQ(with(NoReturn::kDrop, kCarmenRangeMax), with({}, {})) << "the explicit defaults";
    EXPECT_NE(with(NoReturn::kFree, {}), with({}, {}));
    EXPECT_NE(with({}, 20.0), with({}, {}));
    const auto stated = read(robot_laser("0 0 0", "0 0 0", 30.0));
    EXPECT_EQ(read(robot_laser("0 0 0", "0 0 0", 30.0), {NoReturn::kFree, {}, {}})->fingerprint, stated->fingerprint);
    EXPECT_NE(read(robot_laser("0 0 0", "0 0 0", 30.0), {NoReturn::kDrop, {}, {}})->fingerprint, stated->fingerprint);
}

} // namespace
} // namespace scanloom::robot
