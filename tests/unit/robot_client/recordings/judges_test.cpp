#include "robot_client/recordings/recording.hpp"

#include "tests/support/bag_writer.hpp"
#include "tests/support/mcap_writer.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/robot_client/recordings/read_recording.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <fstream>

#include <sys/wait.h>

// The readers against the libraries of others: each reads what the other wrote, and both read real recordings alike.

namespace scanloom::robot {
namespace {

constexpr int kJudgeIsAbsent = 77;

/// A program that writes and lists recordings.
struct Judge {
    const char* command; ///< with its script
    const char* package; ///< that has what it needs
};

const Judge kRosbagJudge{"/usr/bin/python3 " SCANLOOM_SOURCE_DIR "/tests/unit/robot_client/recordings/rosbag_judge.py",
                         "Debian's package python3-rosbag"};
const Judge kMcapJudge{"node " SCANLOOM_SOURCE_DIR "/tests/readers/mcap_judge.mjs",
                       "npm's package @mcap/core, in tests/readers"};

class RecordingJudgesTrials : public testing::Test {
protected:
    /// Runs a judge. @return the lines that it prints; nullopt, and a skipped test, if it is absent
    std::optional<std::vector<std::string>> run(const Judge& judge, const std::string& arguments) {
        const auto messages = (directory_.path() / "stderr").string();
        std::FILE* pipe = popen(fmt::format("{} {} 2>{}", judge.command, arguments, messages).c_str(), "r");
        std::string output;
        std::array<char, 4096> piece{};
        for (std::size_t got = 0; (got = std::fread(piece.data(), 1, piece.size(), pipe)) > 0;) {
            output.append(piece.data(), got);
        }
        const int status = pclose(pipe);
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        constexpr int kNoSuchCommand = 127;
        if (code == kJudgeIsAbsent || code == kNoSuchCommand) {
            skip(judge);
            return std::nullopt;
        }
        std::ifstream file(messages);
        EXPECT_EQ(code, 0) << std::string(std::istreambuf_iterator<char>(file), {});
        std::vector<std::string> lines;
        for (std::size_t at = 0; at < output.size();) {
            const auto end = output.find('\n', at);
            lines.push_back(output.substr(at, end - at));
            at = end == std::string::npos ? output.size() : end + 1;
        }
        return lines;
    }

    /// Lists a recording as judges do, with a type as ROS 1 names it.
    [[nodiscard]] static std::vector<std::string> lines_of(const std::filesystem::path& path) {
        auto recording = open_recording(path);
        EXPECT_TRUE(recording) << recording.error().message;
        std::vector<std::string> lines;
        while (const auto message = *(*recording)->next()) {
            const auto& topic = (*recording)->topics()[message->topic];
            std::string hex = message->bytes.empty() ? "-" : "";
            for (const char byte : message->bytes) hex += fmt::format("{:02x}", static_cast<unsigned char>(byte));
            lines.push_back(fmt::format("{} {} {} {}", topic.name, topic.type, message->time, hex));
        }
        EXPECT_EQ((*recording)->losses_count(), 0U);
        std::ranges::sort(lines);
        return lines;
    }

    /// Expects that a judge and the reader list the same messages.
    void expect_agreement(const Judge& judge, const std::filesystem::path& path, std::size_t messages) {
        auto judged = run(judge, "list " + path.string());
        if (!judged) return;
        for (auto& line : *judged) {
            if (const auto at = line.find("/msg/"); at != std::string::npos) line.erase(at, 4);
        }
        std::ranges::sort(*judged);
        EXPECT_EQ(judged->size(), messages);
        EXPECT_TRUE(*judged == lines_of(path)) << path;
    }

    std::filesystem::path written(std::string_view bytes) {
        const auto path = directory_.path() / "written";
        std::ofstream(path, std::ios::binary) << bytes;
        return path;
    }

private:
    static void skip(const Judge& judge) { GTEST_SKIP() << "the judge needs " << judge.package; }

    TemporaryDirectory directory_;
};

TEST_F(RecordingJudgesTrials, RosbagWritesBags) {
    for (const char* compression : {"none", "bz2", "lz4"}) {
        const auto path = written("");
        if (!run(kRosbagJudge, fmt::format("write {} {}", path.string(), compression))) return;
        expect_agreement(kRosbagJudge, path, 300);
    }
}

TEST_F(RecordingJudgesTrials, RosbagReadsBagsOfTheTests) {
    for (const char* compression : {"none", "bz2", "lz4"}) {
        const auto path = written(testing_support::small_bag({.compression = compression}, 50).file);
        expect_agreement(kRosbagJudge, path, 50);
    }
}

TEST_F(RecordingJudgesTrials, RosbagReadsRealBags) {
    const auto path = real_recording("fuse_turtlebot3.bag");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent: it is not part of the product";
    expect_agreement(kRosbagJudge, path, 10'527);
    expect_agreement(kRosbagJudge, real_recording("foxglove_example-lz4.bag"), 8647);
    expect_agreement(kRosbagJudge, real_recording("leg_tracker_positive_7.bag"), 510);
}

TEST_F(RecordingJudgesTrials, McapWritesFiles) {
    for (const char* compression : {"none", "zstd"}) {
        const auto path = written("");
        if (!run(kMcapJudge, fmt::format("write {} {}", path.string(), compression))) return;
        expect_agreement(kMcapJudge, path, 300);
    }
}

TEST_F(RecordingJudgesTrials, McapReadsFilesOfTheTests) {
    for (const char* compression : {"", "lz4", "zstd"}) {
        const auto path = written(testing_support::small_mcap({.compression = compression}, 50).file);
        expect_agreement(kMcapJudge, path, 50);
    }
}

TEST_F(RecordingJudgesTrials, McapReadsRealFiles) {
    const auto path = real_recording("turtlebot3_ros2_zstd.mcap");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent: it is not part of the product";
    expect_agreement(kMcapJudge, path, 5940);
    expect_agreement(kMcapJudge, real_recording("rosbag2_talker.mcap"), 20);
}

} // namespace
} // namespace scanloom::robot
