#include "robot_client/recordings/recording.hpp"

#include "tests/support/bag_writer.hpp"
#include "tests/support/mcap_writer.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/robot_client/recordings/read_recording.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;
using Counts = std::map<std::string, std::size_t>;

TEST(RecordingFormatOf, IsToldByContent) {
    EXPECT_EQ(format_of(testing_support::small_bag().file), RecordingFormat::kRosbag);
    EXPECT_EQ(format_of("#ROSRECORD V1.2\n"), RecordingFormat::kRosbag) << "refused by open_recording()";
    EXPECT_EQ(format_of(testing_support::small_mcap().file), RecordingFormat::kMcap);
    EXPECT_EQ(format_of(std::string_view("SQLite format 3\0\x10", 17)), RecordingFormat::kRosbag2);
    EXPECT_EQ(format_of("PARAM robot_frontlaser_offset 0.0"), std::nullopt);
    EXPECT_EQ(format_of("#ROS"), std::nullopt);
    EXPECT_EQ(format_of(""), std::nullopt);
}

TEST(RecordingFormatOf, LooksIntoFilesCompressedAsAWhole) {
    const auto packed = testing_support::zstd_compressed(testing_support::small_mcap({}, 1000).file);
    EXPECT_EQ(format_of(std::string_view(packed).substr(0, kFormatBytes)), RecordingFormat::kMcap);
    EXPECT_EQ(format_of(testing_support::zstd_compressed("text")), std::nullopt);
}

class OpenRecording : public testing::Test {
protected:
    Error error_of(std::string_view bytes) {
        const auto path = directory_.path() / "file";
        std::ofstream(path, std::ios::binary) << bytes;
        auto recording = open_recording(path);
        EXPECT_FALSE(recording);
        return recording ? Error{} : recording.error();
    }

    TemporaryDirectory directory_;
};

TEST_F(OpenRecording, ReadsFilesOfManyWindows) {
    testing_support::BagWriter writer({.chunk_bytes = std::size_t{1} << 20U});
    const auto connection = writer.connect("/scan", "sensor_msgs/LaserScan");
    for (int i = 0; i < 3000; ++i) {
        writer.write(connection, i, std::string(static_cast<std::size_t>(i), static_cast<char>(i)));
    }
    const auto bag = writer.finish();
    const auto path = directory_.path() / "large.bag";
    std::ofstream(path, std::ios::binary) << bag.file;
    auto recording = open_recording(path);
    ASSERT_TRUE(recording) << recording.error().message;
    const auto read = read_whole(**recording);
    EXPECT_TRUE(read.messages == all_of(bag));
    EXPECT_EQ(read.losses_count, 0U);
}

TEST_F(OpenRecording, RefusesWhatIsNoRecording) {
    EXPECT_EQ(error_of("PARAM robot_frontlaser_offset 0.0\n").code, Errc::kMalformed);
    EXPECT_EQ(error_of("").code, Errc::kMalformed);
    EXPECT_EQ(open_recording(directory_.path() / "absent").error().code, Errc::kNotFound);
}

TEST_F(OpenRecording, RefusesFileCompressedAsAWholeAndSaysHowToDecompressIt) {
    const auto error = error_of(testing_support::zstd_compressed(testing_support::small_mcap().file));
    EXPECT_EQ(error.code, Errc::kUnsupportedVersion);
    EXPECT_THAT(error.message, HasSubstr("`zstd -d`"));
}

class PartsOfARecording : public testing::Test {
protected:
    void write(const std::string& name, const std::string& bytes) {
        std::ofstream(directory_.path() / name, std::ios::binary) << bytes;
    }

    /// Writes a part with one message. @param text  the message
    void write_part(const std::string& name, const std::string& topic, const std::string& text) {
        testing_support::McapWriter writer;
        writer.write(writer.connect(topic, "sensor_msgs/msg/LaserScan"), 1, text);
        write(name, writer.finish().file);
    }

    TemporaryDirectory directory_;
};

TEST_F(PartsOfARecording, AreReadInTheOrderOfTheirNumbers) {
    write("metadata.yaml", "rosbag2_bagfile_information:\n");
    write_part("drive_10.mcap", "/b", "third");
    write_part("drive_8.mcap", "/a", "first");
    write_part("drive_9.mcap", "/b", "second");
    write("drive_11.mcap", "");
    auto recording = open_recording(directory_.path());
    ASSERT_TRUE(recording) << recording.error().message;
    const auto read = read_whole(**recording);
    EXPECT_THAT(read.messages, testing::ElementsAre(ReadMessage{"/a", 1, "first"}, ReadMessage{"/b", 1, "second"},
                                                    ReadMessage{"/b", 1, "third"}));
    EXPECT_EQ(read.topics.size(), 2U);
    ASSERT_EQ(read.losses.size(), 1U);
    EXPECT_THAT(read.losses[0].reason, HasSubstr("drive_11.mcap: not a recording of ROS"));
    EXPECT_EQ(read.progress.bytes, read.progress.bytes_total);
}

TEST_F(PartsOfARecording, LossesNameThePart) {
    auto damaged = testing_support::small_mcap({.is_closed = false}).file;
    write("drive_0.mcap", damaged);
    write_part("drive_1.mcap", "/scan", "x");
    const auto read = read_whole(**open_recording(directory_.path()));
    EXPECT_EQ(read.messages.back(), (ReadMessage{"/scan", 1, "x"}));
    ASSERT_EQ(read.losses_count, 1U);
    EXPECT_THAT(read.losses[0].reason, HasSubstr("in drive_0.mcap: the recording was not closed"));
}

TEST_F(PartsOfARecording, MustBeOneRecording) {
    EXPECT_EQ(open_recording(directory_.path()).error().code, Errc::kNotFound);
    write_part("monday.mcap", "/a", "x");
    EXPECT_TRUE(open_recording(directory_.path())) << "the only one";
    write_part("tuesday_1.mcap", "/a", "x");
    const auto error = open_recording(directory_.path()).error();
    EXPECT_EQ(error.code, Errc::kInvalidField);
    std::filesystem::rename(directory_.path() / "monday.mcap", directory_.path() / "monday_0.mcap");
    EXPECT_FALSE(open_recording(directory_.path())) << "other names before the numbers";
    EXPECT_THAT(error.message, HasSubstr("or move the others away: monday.mcap, tuesday_1.mcap"));
}

/// What a real recording holds.
struct RealRecording {
    const char* file;
    Counts counts;
};

class RealRecordings : public testing::TestWithParam<RealRecording> {};

TEST_P(RealRecordings, AreReadAsAWhole) {
    const auto path = real_recording(GetParam().file);
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent: it is not part of the product";
    auto recording = open_recording(path);
    ASSERT_TRUE(recording) << recording.error().message;
    const auto read = read_whole(**recording);
    EXPECT_EQ(read.counts(), GetParam().counts);
    EXPECT_EQ(read.losses_count, 0U);
}

INSTANTIATE_TEST_SUITE_P(
    Each, RealRecordings,
    testing::Values(
        RealRecording{"fuse_turtlebot3.bag",
                      {{"/scan", 457}, {"/odom", 2741}, {"/cmd_vel", 2335}, {"/imu", 2253}, {"/joint_states", 2741}}},
        RealRecording{"turtlebot3_ros2_zstd.mcap", {{"/scan", 457}, {"/odom", 2741}, {"/tf", 2741}, {"/tf_static", 1}}},
        RealRecording{"leg_tracker_positive_7.bag", {{"/rear_scan", 510}}},
        RealRecording{"foxglove_example-bz2.bag",
                      {{"/rosout", 10},
                       {"/tf", 2688},
                       {"/tf_static", 1},
                       {"/turtle1/cmd_vel", 357},
                       {"/turtle1/color_sensor", 1351},
                       {"/turtle1/pose", 1344},
                       {"/turtle2/cmd_vel", 208},
                       {"/turtle2/color_sensor", 1344},
                       {"/turtle2/pose", 1344}}},
        RealRecording{"rosbag2_talker.mcap", {{"/rosout", 10}, {"/topic", 10}}},
        RealRecording{"rosbag2_talker.db3", {{"/rosout", 10}, {"/topic", 10}}}),
    [](const auto& each) {
        std::string name = each.param.file;
        std::ranges::replace_if(
            name, [](char c) { return c == '.' || c == '-'; }, '_');
        return name;
    });

TEST(RealRecording, HasTheSameMessagesInBothCompressions) {
    const auto bz2 = real_recording("foxglove_example-bz2.bag");
    const auto lz4 = real_recording("foxglove_example-lz4.bag");
    if (!std::filesystem::exists(bz2)) GTEST_SKIP() << bz2 << " is absent: it is not part of the product";
    EXPECT_TRUE(read_whole(*open_recording(bz2).value()).messages == read_whole(*open_recording(lz4).value()).messages);
}

TEST(RealRecording, OfFormat12IsRefused) {
    const auto path = real_recording("scan_tools_splitter_demo.bag");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent: it is not part of the product";
    const auto recording = open_recording(path);
    ASSERT_FALSE(recording);
    EXPECT_EQ(recording.error().code, Errc::kUnsupportedVersion);
    EXPECT_THAT(recording.error().message, HasSubstr("a ROS bag of format 1.2"));
}

} // namespace
} // namespace scanloom::robot
