#include "robot_client/recordings/rosbag2.hpp"

#include "tests/support/temporary_directory.hpp"
#include "tests/unit/robot_client/recordings/read_recording.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include <sqlite3.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kTables = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
                                "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
                                "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
                                "timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
                                "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
                                "INSERT INTO topics VALUES(1, '/scan', 'sensor_msgs/msg/LaserScan', 'cdr', '');"
                                "INSERT INTO topics VALUES(2, '/odom', 'nav_msgs/msg/Odometry', 'cdr', '');"
                                "INSERT INTO topics VALUES(3, '/x', 'x/msg/X', 'json', '');";

/// Makes databases in a directory that is removed at the end of the test.
class Rosbag2Test : public testing::Test {
protected:
    void TearDown() override {
        if (database_ != nullptr) sqlite3_close(database_);
    }

    void execute(const std::string& sql) {
        ASSERT_TRUE(database_ != nullptr || sqlite3_open(path_.c_str(), &database_) == SQLITE_OK);
        char* error = nullptr;
        ASSERT_EQ(sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
    }

    void insert(int topic, std::int64_t time, const std::string& bytes) {
        sqlite3_stmt* statement = nullptr;
        sqlite3_prepare_v2(database_, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?1, ?2, ?3)", -1,
                           &statement, nullptr);
        sqlite3_bind_int(statement, 1, topic);
        sqlite3_bind_int64(statement, 2, time);
        sqlite3_bind_blob(statement, 3, bytes.data(), static_cast<int>(bytes.size()), SQLITE_TRANSIENT);
        ASSERT_EQ(sqlite3_step(statement), SQLITE_DONE);
        sqlite3_finalize(statement);
    }

    void close() {
        sqlite3_close(database_);
        database_ = nullptr;
    }

    /// A database of so many messages of 600 bytes, six on a page.
    void make_large(int messages) {
        execute("PRAGMA page_size=4096; BEGIN;" + std::string(kTables));
        for (int i = 1; i <= messages; ++i) insert(1 + i % 2, i, fmt::format("{:>600}", i));
        execute("COMMIT");
        close();
    }

    [[nodiscard]] std::string file() const {
        std::ifstream stream(path_, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    void replace_file(std::string_view bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }

    [[nodiscard]] WholeRecording read() const {
        auto recording = open_rosbag2(path_);
        EXPECT_TRUE(recording) << recording.error().message;
        return recording ? read_whole(**recording) : WholeRecording{};
    }

    const TemporaryDirectory directory_;
    const std::filesystem::path path_ = directory_.path() / "a b%c_0.db3";
    sqlite3* database_ = nullptr;
};

TEST_F(Rosbag2Test, YieldsMessagesInTheOrderOfTheirIds) {
    execute(kTables);
    insert(1, 20, "a");
    insert(2, 10, "");
    insert(3, 30, "c");
    close();
    const auto read_all = read();
    EXPECT_THAT(read_all.messages,
                ElementsAre(ReadMessage{"/scan", 20, "a"}, ReadMessage{"/odom", 10, ""}, ReadMessage{"/x", 30, "c"}));
    EXPECT_THAT(read_all.topics, ElementsAre(RecordedTopic{"/scan", "sensor_msgs/LaserScan", MessageEncoding::kCdr},
                                             RecordedTopic{"/odom", "nav_msgs/Odometry", MessageEncoding::kCdr},
                                             RecordedTopic{"/x", "x/X", MessageEncoding::kOther}));
    EXPECT_EQ(read_all.losses_count, 0U);
    EXPECT_EQ(read_all.progress.bytes, file().size());
    EXPECT_THAT(std::vector<std::filesystem::path>(std::filesystem::directory_iterator(directory_.path()), {}),
                SizeIs(1))
        << "no files are made next to it";
}

TEST_F(Rosbag2Test, OlderAndOtherColumnsAreRead) {
    execute("CREATE TABLE topics(type TEXT, more INT, id INTEGER PRIMARY KEY, name TEXT);"
            "CREATE TABLE messages(data BLOB, timestamp INTEGER, topic_id INTEGER);"
            "INSERT INTO topics VALUES('sensor_msgs/msg/LaserScan', 0, 4, '/scan');"
            "INSERT INTO messages VALUES(x'6162', 7, 4);");
    close();
    const auto read_all = read();
    EXPECT_THAT(read_all.messages, ElementsAre(ReadMessage{"/scan", 7, "ab"}));
    EXPECT_EQ(read_all.topics.at(0).encoding, MessageEncoding::kCdr);
}

TEST_F(Rosbag2Test, MessagesCompressedOneByOneAreDecompressed) {
    const std::string scan = std::string("\0\1\0\0", 4) + std::string(1000, 's');
    execute(kTables);
    insert(1, 1, testing_support::zstd_compressed(scan));
    insert(1, 2, testing_support::zstd_compressed(scan).substr(0, 10));
    insert(1, 3, scan);
    close();
    const auto read_all = read();
    EXPECT_THAT(read_all.messages, ElementsAre(ReadMessage{"/scan", 1, scan}, ReadMessage{"/scan", 3, scan}));
    ASSERT_THAT(read_all.losses, SizeIs(1));
    EXPECT_THAT(read_all.losses[0].reason, HasSubstr("message 2: the zstd data is truncated"));
}

TEST_F(Rosbag2Test, MessageOfUnknownTopicIsALoss) {
    execute(kTables);
    insert(9, 1, "a");
    insert(1, 2, "b");
    close();
    const auto read_all = read();
    EXPECT_THAT(read_all.messages, SizeIs(1));
    EXPECT_THAT(read_all.losses.at(0).reason, HasSubstr("message 1 of topic 9"));
}

TEST_F(Rosbag2Test, DamagedPageCostsOnlyItsMessages) {
    make_large(2000);
    std::string bytes = file();
    const auto page = bytes.find(fmt::format("{:>600}", 1000)) / 4096 * 4096;
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(page), 4096, '\xff');
    replace_file(bytes);
    const auto read_all = read();
    EXPECT_GE(read_all.messages.size(), 1990U);
    EXPECT_LT(read_all.messages.size(), 2000U);
    EXPECT_EQ(read_all.messages.back().time, 2000);
    EXPECT_TRUE(std::ranges::is_sorted(read_all.messages, {}, &ReadMessage::time));
    ASSERT_THAT(read_all.losses, SizeIs(1));
    EXPECT_THAT(read_all.losses[0].reason, HasSubstr("malformed"));
    EXPECT_NEAR(static_cast<double>(read_all.losses[0].offset) / static_cast<double>(bytes.size()), 0.5, 0.01);
}

/// Pages behind a hole have the contents of others: rows come in a wrong order, and some come again.
TEST_F(Rosbag2Test, AFileThatLacksBytesInTheMiddleIsReadToItsEnd) {
    make_large(300);
    const std::string bytes = file();
    for (const std::size_t lacking : {1, 7, 100, 600, 4096, 9000}) {
        for (std::size_t at = 10'000; at + lacking < bytes.size(); at += 9'001) {
            replace_file(bytes.substr(0, at) + bytes.substr(at + lacking));
            const auto read_all = read();
            EXPECT_LE(read_all.messages.size(), 300U) << lacking << " at " << at;
        }
    }
}

TEST_F(Rosbag2Test, TruncatedFileYieldsMessagesBeforeTheCut) {
    make_large(2000);
    const std::string bytes = file();
    for (const double share : {0.2, 0.5, 0.9}) {
        replace_file(
            std::string_view(bytes).substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
        const auto read_all = read();
        EXPECT_GT(static_cast<double>(read_all.messages.size()), 2000 * (share - 0.1)) << share;
        EXPECT_LT(read_all.messages.size(), 2000U) << share;
        EXPECT_GT(read_all.losses_count, 0U) << share;
    }
}

TEST_F(Rosbag2Test, MessagesInTheWriteAheadLogAreRead) {
    execute("PRAGMA journal_mode=WAL; PRAGMA wal_autocheckpoint=0;" + std::string(kTables));
    insert(1, 1, "a");
    // As a recorder leaves it that is killed: copied while it is open.
    const auto copy = directory_.path() / "copy.db3";
    std::filesystem::copy_file(path_, copy);
    std::filesystem::copy_file(path_.string() + "-wal", copy.string() + "-wal");
    auto recording = open_rosbag2(copy);
    ASSERT_TRUE(recording) << recording.error().message;
    EXPECT_THAT(read_whole(**recording).messages, ElementsAre(ReadMessage{"/scan", 1, "a"}));
}

TEST_F(Rosbag2Test, OtherDatabasesAreRefused) {
    execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT); CREATE TABLE notes(x);");
    close();
    EXPECT_EQ(open_rosbag2(path_).error().code, Errc::kMalformed);
    EXPECT_THAT(open_rosbag2(path_).error().message, HasSubstr("not one that rosbag2 recorded"));
    EXPECT_EQ(open_rosbag2(directory_.path() / "absent").error().code, Errc::kNotFound);
}

TEST_F(Rosbag2Test, ViewThatComputesWithoutEndIsRefused) {
    execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT);"
            "CREATE VIEW messages AS WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) "
            "SELECT x AS id, x AS rowid, 1 AS topic_id, x AS timestamp, '' AS data FROM n;");
    close();
    EXPECT_EQ(open_rosbag2(path_).error().code, Errc::kMalformed);
}

} // namespace
} // namespace scanloom::robot
