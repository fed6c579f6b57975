#include "lab/recording.hpp"

#include "tests/support/ld06_bytes.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;
using testing_support::Bytes;

class Ld06Recordings : public testing::Test {
protected:
    std::filesystem::path file(const Bytes& bytes) {
        const auto path = directory_.path() / "room.bin";
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        return path;
    }

    TemporaryDirectory directory_;
};

TEST_F(Ld06Recordings, ContainTheTurnsOfAStationaryLidar) {
    testing_support::Ld06Spinner sensor;
    const auto recorded = read_ld06_recording(file(sensor.next_bytes(400))).value();
    EXPECT_EQ(recorded.name, "room.bin");
    EXPECT_EQ(recorded.remarks, "0 damaged packets, 9 turns");
    ASSERT_EQ(recorded.capture.scans.size(), 9U);
    EXPECT_EQ(recorded.capture.scans[8].seq, 9U);
    EXPECT_EQ(recorded.capture.scans[8].pose, Pose2());
    EXPECT_EQ(points_of(recorded.capture.scans, recorded.capture.sensor).size(), 9U * 450U);
}

TEST_F(Ld06Recordings, WithoutTwoTurnsAreRefusedByName) {
    testing_support::Ld06Spinner sensor;
    EXPECT_THAT(read_ld06_recording(file(sensor.next_bytes(90))).error().message, HasSubstr("room.bin: only one turn"));
    EXPECT_THAT(read_ld06_recording(file({})).error().message, HasSubstr("room.bin: no full turn of an LD06"));
    EXPECT_THAT(read_ld06_recording(directory_.path() / "missing").error().message,
                HasSubstr("missing: cannot be opened"));
}

TEST_F(Ld06Recordings, WithoutReturnsAreRefusedWithTheirCount) {
    testing_support::Ld06Spinner sensor;
    Bytes bytes;
    for (int n = 0; n < 400; ++n) {
        robot::Ld06Packet packet = sensor.next();
        if (n < 200) {
            for (auto& point : packet.points) point.distance = 0;
        }
        testing_support::append(bytes, testing_support::bytes_of(packet));
    }
    EXPECT_THAT(
        read_ld06_recording(file(bytes)).error().message,
        HasSubstr(
            "room.bin: in the first 4 of 9 turns only 0 points were observed; record where the lidar can see walls"));
}

} // namespace
} // namespace scanloom::lab
