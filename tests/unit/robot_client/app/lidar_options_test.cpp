#include "robot_client/app/lidar_options.hpp"

#include "common/app/standard_streams.hpp"
#include "robot_client/app/make_source.hpp"
#include "robot_client/app/options.hpp"
#include "robot_client/lidars/lidar_models.hpp"
#include "tests/support/ld06_bytes.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;

std::variant<RobotOptions, GroundTruthOptions, InfoOptions, LidarsOptions, Leave>
parse(const std::vector<std::string>& words, const char* command) {
    std::vector<const char*> argv{"scanloom-robot", "--session", "s", "--robot", "r", command};
    for (const auto& word : words) argv.push_back(word.c_str());
    return parse_options(static_cast<int>(argv.size()), argv.data());
}

RobotOptions parsed(const std::vector<std::string>& words, const char* command = "ld06") {
    auto result = parse(words, command);
    if (auto* options = std::get_if<RobotOptions>(&result)) return *options;
    ADD_FAILURE() << std::get<Leave>(result).text;
    return {};
}

std::string refused(const std::vector<std::string>& words, const char* command = "ld06") {
    const auto result = parse(words, command);
    const auto* leave = std::get_if<Leave>(&result);
    if (leave == nullptr) return "nothing was refused";
    EXPECT_EQ(leave->code, kExitUsage);
    return leave->text;
}

TEST(Ld06OptionsOf, AreReadFromTheCommandLine) {
    const auto options =
        std::get<LidarOptions>(parsed({"/dev/ttyUSB0", "--pose", "-1,2.5,6", "--mount=0.1,0,-1.5", "--min-range", "0.2",
                                       "--min-confidence", "0", "--median", "5", "--speed", "1", "--reopen-for", "0"})
                                   .source);
    EXPECT_EQ(options.input, "/dev/ttyUSB0");
    EXPECT_EQ(options.pose, (Pose2{-1.0, 2.5, normalize_angle(6.0)}));
    EXPECT_EQ(options.mount, (Pose2{0.1, 0.0, -1.5}));
    EXPECT_EQ(options.range_min, 0.2);
    EXPECT_EQ(options.confidence_min, 0);
    EXPECT_EQ(options.median_window, 5);
    EXPECT_EQ(options.speed, 1.0);
    EXPECT_EQ(options.reopen_for, 0.0);
}

TEST(Ld06OptionsOf, AreTheDefaultsWithoutFlags) {
    const auto options = std::get<LidarOptions>(parsed({"f", "--pose-file", "-"}).source);
    EXPECT_EQ(options.pose_file, "-");
    EXPECT_FALSE(options.pose || options.range_min || options.confidence_min || options.median_window);
    EXPECT_EQ(options.mount, Pose2{});
    EXPECT_EQ(options.speed, 0.0);
    EXPECT_EQ(options.reopen_for, 60.0);
}

TEST(Ld06OptionsOf, LocalizationIsAccepted) {
    const auto bare = std::get<LidarOptions>(parsed({"/dev/ttyUSB0", "--locate"}).source);
    EXPECT_TRUE(bare.locate);
    EXPECT_FALSE(bare.pose || bare.near);
    const auto located = std::get<LidarOptions>(parsed({"f", "--locate", "--near=-1,2.5,4", "--pose", "1,2,3"}).source);
    EXPECT_EQ(located.near, (wire::Near{{-1.0, 2.5}, 4.0}));
    EXPECT_EQ(located.pose, (Pose2{1.0, 2.0, 3.0}));
}

TEST(Ld06OptionsOf, LocalizationWithAGivenPoseIsRefused) {
    EXPECT_THAT(refused({"f", "--locate", "--pose-file", "p"}), HasSubstr("leave one of them out"));
    EXPECT_THAT(refused({"f", "--pose", "0,0,0", "--near", "0,0,1"}), HasSubstr("--near needs --locate"));
    EXPECT_THAT(refused({"f", "--locate", "--speed", "1"}), HasSubstr("leave --speed out"));
    EXPECT_THAT(refused({"f"}), HasSubstr("or let the server determine it with --locate"));
    EXPECT_THAT(refused({"f", "--locate", "--near", ""}), HasSubstr("given but empty"));
    for (const auto* near : {"1,2", "1,2,3,4", "1,2,x", "nan,0,1", "0,0,inf"}) {
        EXPECT_THAT(refused({"f", "--locate", "--near", near}), HasSubstr("is not X,Y,RADIUS in metres")) << near;
    }
    for (const auto* near : {"0,0,0", "0,0,-1", "0,0,1001", "0,0,1e9", "0,0,1e-300"}) {
        EXPECT_THAT(refused({"f", "--locate", "--near", near}), HasSubstr("out of range: 0.1 to 1000")) << near;
    }
    EXPECT_THAT(refused({"f", "--locate", "--near", "0,-2e6,1"}), HasSubstr("-2000000 m is outside the map"));
}

TEST(Ld06OptionsOf, PosesDecideWhichPosesAreNeeded) {
    const auto none = parsed({"/dev/ttyUSB0", "--poses", "none"});
    EXPECT_EQ(none.poses, Poses::kNone);
    EXPECT_EQ(std::get<LidarOptions>(none.source).pose_file, "");
    const auto odometry = parsed({"f", "--poses", "odometry", "--pose-file", "p"});
    EXPECT_EQ(odometry.poses, Poses::kOdometry);
    EXPECT_EQ(std::get<LidarOptions>(odometry.source).pose_file, "p");
    EXPECT_FALSE(std::get<LidarOptions>(odometry.source).is_old_name);
    EXPECT_EQ(parsed({"f", "--poses", "map", "--pose", "0,0,0"}).poses, Poses::kMap);
    for (const char* poses : {"odometry", "none"}) {
        EXPECT_THAT(refused({"f", "--locate", "--poses", poses}), HasSubstr("leave one of them out")) << poses;
        EXPECT_THAT(refused({"f", "--pose", "0,0,0", "--poses", poses}), HasSubstr("leave --pose")) << poses;
    }
    EXPECT_THAT(refused({"f", "--poses", "none", "--pose-file", "p"}), HasSubstr("leave --pose and --pose-file out"));
    EXPECT_THAT(refused({"f", "--poses", "odometry"}), HasSubstr("give it with --pose-file FILE"));
    EXPECT_THAT(refused({"f", "--poses", "map"}), HasSubstr("state the robot's pose"));
}

TEST(Ld06OptionsOf, PosesNameTheFileForOneRelease) {
    for (const char* file : {"-", "p", "Map"}) {
        const auto options = parsed({"f", "--poses", file});
        EXPECT_EQ(options.poses, std::nullopt);
        EXPECT_EQ(std::get<LidarOptions>(options.source).pose_file, file);
        EXPECT_TRUE(std::get<LidarOptions>(options.source).is_old_name);
    }
    EXPECT_THAT(refused({"f", "--poses", "p", "--pose-file", "p"}), HasSubstr("'p' is not map, odometry or none"));
    EXPECT_THAT(refused({"f", "--locate", "--poses", "p"}), HasSubstr("leave one of them out"));
}

TEST(Ld06OptionsOf, YawInDegreesIsRefused) {
    for (const auto* pose : {"0,0,90", "0,0,-90", "0,0,6.2832"}) {
        EXPECT_THAT(refused({"f", "--pose", pose}), HasSubstr("yaw is in radians")) << pose;
        EXPECT_THAT(refused({"f", "--pose", "0,0,0", "--mount", pose}), HasSubstr("90 degrees are 1.570796")) << pose;
    }
    const auto options = std::get<LidarOptions>(parsed({"f", "--pose", "0,0,-6.2831853"}).source);
    EXPECT_NEAR(options.pose->yaw, 0.0, 1e-6);
}

TEST(Ld06OptionsOf, InvalidCommandLinesAreRefused) {
    EXPECT_THAT(refused({"--pose", "0,0,0"}), HasSubstr("name the INPUT"));
    EXPECT_THAT(refused({"f"}), HasSubstr("state the robot's pose"));
    EXPECT_THAT(refused({"f", "--pose", "0,0,0", "--pose-file", "p"}), HasSubstr("state the robot's pose"));
    EXPECT_THAT(refused({"f", "--pose", ""}), HasSubstr("given but empty"));
    for (const auto* pose : {"1,2", "1,2,3,4", "1,2,x", "1,2,nan", "1,inf,0", "1 2 3"}) {
        EXPECT_THAT(refused({"f", "--pose", pose}), HasSubstr("is not X,Y,YAW")) << pose;
        EXPECT_THAT(refused({"f", "--pose", "0,0,0", "--mount", pose}), HasSubstr("is not X,Y,YAW")) << pose;
    }
    for (const auto* window : {"1", "4", "103", "-3", "3.5", "x"}) {
        EXPECT_THAT(refused({"f", "--pose", "0,0,0", "--median", window}), HasSubstr("is not an odd number")) << window;
    }
    for (const auto* confidence : {"-1", "256", "x"}) {
        EXPECT_THAT(refused({"f", "--pose", "0,0,0", "--min-confidence", confidence}), HasSubstr("from 0 to 255"));
    }
    EXPECT_THAT(refused({"f", "--pose", "1e7,0,0"}),
                HasSubstr("10000000 m is outside the map, which extends 1000000 m"));
    EXPECT_THAT(refused({"tcp://lidar", "--pose", "0,0,0"}), HasSubstr("'tcp://lidar' is not tcp://HOST:PORT"));
    EXPECT_THAT(refused({"f", "--pose", "0,0,0", "--reopen-for", "-1"}), HasSubstr("--reopen-for"));
}

TEST(LidarOptionsOf, AreReadFromTheCommandLine) {
    const auto options =
        parsed({"stl27l", "/dev/ttyUSB0", "--poses", "odometry", "--pose-file", "p", "--mount", "1,2,3", "--max-range",
                "9", "--min-range", "0.2", "--median", "5", "--baud", "460800"},
               "lidar");
    const auto& lidar = std::get<LidarOptions>(options.source);
    EXPECT_EQ(lidar.model, "stl27l");
    EXPECT_EQ(lidar.input, "/dev/ttyUSB0");
    EXPECT_EQ(lidar.pose_file, "p");
    EXPECT_EQ(lidar.mount, (Pose2{1.0, 2.0, 3.0}));
    EXPECT_EQ(lidar.range_min, 0.2);
    EXPECT_EQ(lidar.baud, 460'800U);
    EXPECT_EQ(options.range_max, 9.0);
    EXPECT_EQ(options.poses, Poses::kOdometry);
}

TEST(LidarOptionsOf, InvalidCommandLinesAreRefused) {
    EXPECT_THAT(refused({}, "lidar"), HasSubstr("lidar: name the MODEL and the DEVICE"));
    EXPECT_THAT(refused({"ld06"}, "lidar"), HasSubstr("lidar: name the MODEL and the DEVICE"));
    EXPECT_THAT(refused({"velodyne", "/dev/x"}, "lidar"),
                HasSubstr("'velodyne' is not one of the models: ld06, ld19,"));
    EXPECT_THAT(refused({"ld06", "tcp://x", "--pose", "0,0,0"}, "lidar"), HasSubstr("lidar: 'tcp://x' is not tcp://"));
    EXPECT_THAT(refused({"ld06", "/dev/x"}, "lidar"), HasSubstr("or let the server estimate it with --poses none"));
    EXPECT_THAT(refused({"ld06", "/dev/x", "--poses", "p.txt"}, "lidar"), HasSubstr("not map, odometry or none"));
    EXPECT_THAT(refused({"ld06", "/dev/x", "--locate"}, "lidar"), HasSubstr("--locate"));
    EXPECT_THAT(refused({"ld06", "/dev/x", "--pose", "0,0,0", "--baud", "110"}, "lidar"), HasSubstr("--baud"));
}

class PreparedLd06 : public testing::Test {
protected:
    Result<PreparedSource> prepare(const std::vector<std::string>& words, const char* command = "ld06") {
        const auto options = parsed(words, command);
        return make_source(options, console_);
    }

    std::string file(const char* name, const std::string& text) {
        const auto path = directory_.path() / name;
        std::ofstream(path, std::ios::binary) << text;
        return path;
    }

    std::string capture() {
        const auto bytes = testing_support::Ld06Spinner().next_bytes(200);
        return file("capture.bin", std::string(bytes.begin(), bytes.end()));
    }

private:
    TemporaryDirectory directory_;
    Console console_{standard_error()};
};

TEST_F(PreparedLd06, CaptureFileIsARecording) {
    const auto prepared = prepare({capture(), "--pose-file", file("poses", "0 0 0 0\noops\n9 9 0 0\n"), "--speed", "2",
                                   "--max-range", "2", "--min-range", "1.5", "--mount", "1,0,0"});
    ASSERT_TRUE(prepared) << prepared.error().message;
    ASSERT_TRUE(prepared->source);
    EXPECT_FALSE(prepared->live);
    EXPECT_EQ(prepared->skipped_lines, 1U);
    EXPECT_EQ(prepared->speed, 2.0);
    EXPECT_EQ(prepared->source->scan_count(), 4U);
    const auto observation = prepared->source->next().value().value();
    EXPECT_EQ(observation.sensor->mount, (Pose2{1.0, 0.0, 0.0}));
    EXPECT_EQ(observation.sensor->range_max, 2.0);
    EXPECT_EQ(observation.scan.ranges.front(), kNoReturn);
    EXPECT_EQ(observation.scan.ranges.back(), kInvalidRange);
}

TEST_F(PreparedLd06, CaptureFileHasThePosesOfTheOptions) {
    const auto poses = file("poses", "0 0 0 0\n9 9 0 0\n");
    const auto map = prepare({capture(), "--poses", poses}); // the earlier name of --pose-file
    const auto odometry = prepare({capture(), "--poses", "odometry", "--pose-file", poses});
    const auto none = prepare({capture(), "--poses", "none"});
    ASSERT_TRUE(map && odometry && none);
    const Scan with_odometry = odometry->source->next().value()->scan;
    EXPECT_FALSE(with_odometry.pose);
    EXPECT_TRUE(with_odometry.odometry);
    EXPECT_EQ(map->source->next().value()->scan.pose, with_odometry.odometry);
    const Scan without = none->source->next().value()->scan;
    EXPECT_FALSE(without.pose || without.odometry);
    EXPECT_EQ(map->fingerprint, prepare({capture(), "--pose-file", poses})->fingerprint);
    EXPECT_NE(map->fingerprint, odometry->fingerprint);
    EXPECT_NE(map->fingerprint, none->fingerprint);
}

TEST_F(PreparedLd06, DeviceAndAddressAreLive) {
    for (const auto* input : {"/dev/null", "tcp://127.0.0.1:4001"}) {
        const auto prepared = prepare({input, "--pose", "0,0,0"});
        ASSERT_TRUE(prepared) << prepared.error().message;
        EXPECT_TRUE(prepared->live);
        EXPECT_FALSE(prepared->source);
        EXPECT_EQ(prepared->fingerprint, "") << "sent scans cannot be sent again";
        EXPECT_TRUE(prepare({input, "--poses", "none"})->live);
    }
}

TEST_F(PreparedLd06, LocalizingSourceIsLive) {
    for (const auto& input : {std::string("/dev/null"), std::string("tcp://127.0.0.1:4001"), capture()}) {
        const auto prepared = prepare({input, "--locate", "--near", "1,2,3"});
        ASSERT_TRUE(prepared) << prepared.error().message;
        ASSERT_TRUE(prepared->live);
        EXPECT_EQ(prepared->locating, prepared->live.get());
        EXPECT_EQ(prepared->near, (wire::Near{{1.0, 2.0}, 3.0}));
        EXPECT_FALSE(prepared->source);
        EXPECT_EQ(prepared->fingerprint, "") << "its scans depend on the reply";
        EXPECT_EQ(prepared->live->can_wait(), input == capture());
        EXPECT_THAT(prepared->remarks(), HasSubstr("carried 0 times, 0 turns while carried or not localized"));
    }
}

TEST_F(PreparedLd06, EveryModelIsLive) {
    for (const auto& model : lidar_models()) {
        const auto prepared = prepare({std::string(model.name), "/dev/null", "--poses", "none"}, "lidar");
        ASSERT_TRUE(prepared) << prepared.error().message;
        EXPECT_TRUE(prepared->live) << model.name;
        EXPECT_EQ(prepared->poses, Poses::kNone);
    }
    EXPECT_THAT(prepare({"ld19", capture(), "--poses", "none"}, "lidar").error().message,
                HasSubstr("a file, not a device; files with the bytes of an LD06 are read by scanloom-robot ld06"));
}

TEST_F(PreparedLd06, OtherSourcesAreAnError) {
    EXPECT_THAT(prepare({"/dev/nonexistent", "--pose", "0,0,0"}).error().message, HasSubstr("no such device or file"));
    EXPECT_THAT(prepare({"/tmp", "--pose", "0,0,0"}).error().message, HasSubstr("not a serial device or a file"));
    EXPECT_THAT(prepare({capture(), "--pose-file", "/nonexistent"}).error().message, HasSubstr("no such file"));
    EXPECT_THAT(prepare({capture(), "--pose", "0,0,0", "--spool", "/tmp/none"}).error().message,
                HasSubstr("a capture file is a recording and needs no --spool"));
    EXPECT_THAT(prepare({capture(), "--locate", "--spool", "/tmp/none"}).error().message,
                HasSubstr("needs no --spool: it can be read again; leave --spool out"));
    EXPECT_THAT(prepare({capture(), "--pose", "0,0,0", "--min-range", "13"}).error().message,
                HasSubstr("--min-range is 13 m, but --max-range is only 12 m"));
}

} // namespace
} // namespace scanloom::robot
