#include "server/foxglove/mcap_writer.hpp"

#include "tests/unit/robot_client/recordings/read_recording.hpp"

#include <gmock/gmock.h>

#include <random>

namespace scanloom::foxglove {
namespace {

using robot::read_mcap;
using testing::ElementsAre;

/// A file of 3 MB on two topics, as the writer gives it piece by piece.
struct Written {
    std::vector<std::string> pieces;
    std::vector<robot::ReadMessage> messages;

    Written() {
        McapWriter writer;
        const auto scans = writer.add_channel("/r/scan", schema_of(Message::kScan));
        const auto poses = writer.add_channel("/r/pose", schema_of(Message::kPose));
        std::mt19937 random(1);
        for (int n = 0; n < 300; ++n) {
            std::string bytes(random() % 20'000, '\0');
            std::ranges::generate(bytes, [&] { return static_cast<char>(random()); });
            const std::int64_t time = 1'000 + 1'000 * (n ^ 1); // stamps that go back
            messages.push_back({n % 3 == 0 ? "/r/pose" : "/r/scan", time, bytes});
            writer.write(n % 3 == 0 ? poses : scans, static_cast<std::uint64_t>(time), bytes);
            if (auto piece = writer.take(); !piece.empty()) pieces.push_back(std::move(piece));
        }
        writer.finish();
        pieces.push_back(writer.take());
    }

    [[nodiscard]] std::string file() const {
        std::string all;
        for (const auto& piece : pieces) all += piece;
        return all;
    }
};

TEST(McapWriter, WritesWhatReadersRead) {
    const Written written;
    const auto read = read_mcap(written.file());
    EXPECT_EQ(read.messages, written.messages);
    EXPECT_EQ(read.losses_count, 0U);
    EXPECT_THAT(
        read.topics,
        ElementsAre(robot::RecordedTopic{"/r/scan", "sensor_msgs/LaserScan", robot::MessageEncoding::kCdr},
                    robot::RecordedTopic{"/r/pose", "geometry_msgs/PoseStamped", robot::MessageEncoding::kCdr}));
}

TEST(McapWriter, APieceHasWholeChunks) {
    const Written written;
    ASSERT_GE(written.pieces.size(), 4U) << "the head, chunks, and the end with the last one";
    std::string begun;
    for (std::size_t n = 0; n + 1 < written.pieces.size(); ++n) {
        begun += written.pieces[n];
        const auto read = read_mcap(begun).messages;
        ASSERT_TRUE(std::equal(read.begin(), read.end(), written.messages.begin()));
        EXPECT_EQ(read.empty(), n == 0);
    }
}

TEST(McapWriter, AFileWithoutMessagesIsWhole) {
    McapWriter writer;
    writer.finish();
    const auto read = read_mcap(writer.take());
    EXPECT_TRUE(read.messages.empty());
    EXPECT_EQ(read.losses_count, 0U);
}

} // namespace
} // namespace scanloom::foxglove
