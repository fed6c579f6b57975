#include "server/sessions/session_check.hpp"

#include "server/sessions/checkpoint.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

/// Checks of a session with a log and a checkpoint.
namespace scanloom::sessions {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::size_t kEntries = 42; // a robot, its laser, 40 scans

class SessionCheckTest : public testing::Test {
protected:
    SessionCheckTest() {
        id_ = log_.create_session(wire::encode_session({"lab", 0.0, mapping::options_of(config_)})).value();
        append(RobotJoined{0, "r"});
        append(SensorDescribed{0, small_laser()});
        for (std::uint64_t seq = 1; seq <= 40; ++seq) append(ScanTaken{0, random_scan(1, seq)});
        auto recovered = recover(log_, id_, config_, false).value();
        auto& maps = recovered.maps.projection();
        write_checkpoint(log_, id_, maps.snapshot(), maps.state(), {}, false).value();
    }

    void append(const LogEntry& entry) { append_bytes(wire::encode_entry(entry)); }
    void append_bytes(std::string bytes) { store::append_and_wait(log_, id_, ++end_, {std::move(bytes)}).value(); }
    void put(std::string key, std::string value) {
        log_.write_checkpoint(id_, {{std::move(key), std::move(value)}}).value();
    }

    SessionCheck check(CheckDepth depth) {
        const auto sessions = log_.sessions().value();
        return check_session(log_, sessions.at(0), depth, [](std::size_t) -> Result<> { return {}; }).value();
    }

    /// Checks at every depth.
    void expect_whole(Revision entries) {
        for (const auto depth : {CheckDepth::kLog, CheckDepth::kCheckpoint, CheckDepth::kMaps}) {
            const auto found = check(depth);
            EXPECT_EQ(found.damage.value_or(Error{}).message, "");
            EXPECT_EQ(found.name, "lab");
            EXPECT_EQ(found.entries, entries);
        }
    }

    store::MemoryScanLog log_;
    mapping::MapConfig config_;
    store::SessionId id_ = 0;
    Revision end_ = 0;
};

TEST_F(SessionCheckTest, IntactSessionHasNoDamage) {
    expect_whole(kEntries);
    append(ScanTaken{0, random_scan(1, 41)}); // not in the checkpoint
    expect_whole(kEntries + 1);
}

TEST_F(SessionCheckTest, ReportsAnInvalidEntry) {
    append_bytes("no entry");
    const auto found = check(CheckDepth::kLog);
    EXPECT_EQ(found.entries, kEntries);
    EXPECT_THAT(found.damage.value().message, HasSubstr("log entry 43: "));
}

TEST_F(SessionCheckTest, ReportsAnEntryOutOfSequence) {
    append(ScanTaken{0, random_scan(1, 77)});
    EXPECT_THAT(check(CheckDepth::kLog).damage.value().message,
                HasSubstr("log entry 43: scan 77 of robot 'r' follows scan 40"));
}

TEST_F(SessionCheckTest, ReportsADamagedCheckpointWithAnIntactLog) {
    put("head", "?");
    EXPECT_FALSE(check(CheckDepth::kLog).damage) << "its checksum is valid";
    const auto found = check(CheckDepth::kCheckpoint);
    EXPECT_EQ(found.entries, kEntries);
    EXPECT_THAT(found.damage.value().message, AllOf(HasSubstr("its log is whole"), HasSubstr("'head' is damaged")));
}

TEST_F(SessionCheckTest, ReportsACheckpointAheadOfItsLog) {
    auto head = store::checkpoint_of(log_, id_).value().at("head");
    head[0] = static_cast<char>(head[0] + 1);
    put("head", head);
    EXPECT_THAT(check(CheckDepth::kCheckpoint).damage.value().message,
                HasSubstr("the log ends with entry 42, but its checkpoint holds entry 43"));
}

TEST_F(SessionCheckTest, IgnoresACheckpointOfAnotherVersion) {
    auto format = store::checkpoint_of(log_, id_).value().at("format");
    format[0] = 99;
    put("format", format);
    expect_whole(kEntries);
}

TEST_F(SessionCheckTest, ReportsMapsThatDifferFromTheReplayedLog) {
    mapping::Projection other(config_); // the same revision, but made of other scans
    static_cast<void>(other.apply(RobotJoined{0, "r"}));
    static_cast<void>(other.apply(SensorDescribed{0, small_laser()}));
    for (std::uint64_t seq = 1; seq <= 40; ++seq) static_cast<void>(other.apply(ScanTaken{0, random_scan(2, seq)}));
    write_checkpoint(log_, id_, other.snapshot(), other.state(), {}, false).value();
    EXPECT_FALSE(check(CheckDepth::kCheckpoint).damage);
    EXPECT_THAT(check(CheckDepth::kMaps).damage.value().message, HasSubstr("layer occupancy"));
}

TEST_F(SessionCheckTest, StopsWhenThePaceReturnsAnError) {
    const auto sessions = log_.sessions().value();
    std::size_t read = 0;
    const auto ended = check_session(log_, sessions.at(0), CheckDepth::kLog, [&](std::size_t) -> Result<> {
        if (++read == 10) return Error{Errc::kShuttingDown, "enough"};
        return {};
    });
    EXPECT_EQ(ended.error().message, "enough");
    EXPECT_EQ(read, 10U);
}

TEST_F(SessionCheckTest, ReportsAnInvalidRecord) {
    static_cast<void>(log_.create_session("\xff"));
    const auto found =
        check_session(log_, log_.sessions().value().at(1), CheckDepth::kLog, [](std::size_t) -> Result<> {
            return {};
        }).value();
    EXPECT_EQ(found.name, "#2");
    EXPECT_TRUE(found.damage);
}

} // namespace
} // namespace scanloom::sessions
