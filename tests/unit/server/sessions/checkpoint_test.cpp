#include "server/sessions/checkpoint.hpp"
#include "server/sessions/checkpoint_reader.hpp"

#include "tests/support/digests.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

#include <fmt/format.h>

#include <map>

/// Checkpoints: written, merged, damaged, cut and read.
namespace scanloom::sessions {
namespace {

using testing::HasSubstr;

using Parts = std::map<std::string, std::string>; // as the store keeps them

void merge(Parts& parts, Parts newer) {
    for (auto& [key, value] : newer) parts[key] = std::move(value);
}

std::vector<LogEntry> log_of_two_robots(std::size_t scans) {
    Sensor second = small_laser();
    second.id = 40;
    std::vector<LogEntry> log{RobotJoined{0, "a", "carmen:12", 0.35}, SensorDescribed{0, small_laser()},
                              SensorDescribed{0, second}, RobotJoined{1, "b"}, SensorDescribed{1, small_laser()}};
    for (std::uint64_t seq = 1; seq <= scans; ++seq) {
        for (RobotIndex robot = 0; robot < 2; ++robot) log.push_back(ScanTaken{robot, random_scan(robot, seq)});
    }
    return log;
}

void apply(mapping::Projection& projection, const std::vector<LogEntry>& log, std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) ASSERT_TRUE(projection.apply(log[n]));
}

std::vector<Sensor> sensors_of(const mapping::ProjectionState::Robot& robot) {
    std::vector<Sensor> sensors;
    for (const auto& [id, known] : robot.sensors) sensors.push_back(*known.sensor);
    return sensors;
}

/// Returns the parts of a checkpoint of `projection`.
Parts parts_of(mapping::Projection& projection, Revision since) {
    store::MemoryScanLog log;
    const auto id = log.create_session("s").value();
    EXPECT_TRUE(write_checkpoint(log, id, projection.snapshot(), projection.state(), since, false));
    return store::checkpoint_of(log, id).value();
}

Result<mapping::Projection> read(const Parts& parts) {
    CheckpointReader reader{mapping::MapConfig{}};
    for (const auto& [key, value] : parts) {
        if (auto added = reader.add(key, value); !added) return added.error();
    }
    auto maps = std::move(reader).finish();
    if (!maps) return maps.error();
    return std::move(maps->projection());
}

void expect_same(mapping::Projection& a, mapping::Projection& b) {
    const auto left = a.snapshot();
    const auto right = b.snapshot();
    EXPECT_EQ(left.revision, right.revision);
    EXPECT_EQ(left.bounds, right.bounds);
    EXPECT_EQ(testing_support::digests_of(left), testing_support::digests_of(right));
    ASSERT_EQ(left.robots.size(), right.robots.size());
    for (RobotIndex n = 0; n < left.robots.size(); ++n) {
        const auto& l = left.robots[n];
        const auto& r = right.robots[n];
        EXPECT_EQ(std::tie(l.name, l.body_radius, l.last_seq, l.scan_count, l.stamp, l.pose),
                  std::tie(r.name, r.body_radius, r.last_seq, r.scan_count, r.stamp, r.pose));
        EXPECT_EQ(sensors_of(a.state().robots[n]), sensors_of(b.state().robots[n]));
        EXPECT_EQ(a.state().robots[n].source, b.state().robots[n].source);
        ASSERT_EQ(l.trajectory.size(), r.trajectory.size());
        for (std::size_t i = std::max(l.trajectory.begin(), r.trajectory.begin()); i < l.trajectory.size(); ++i) {
            ASSERT_EQ(l.trajectory[i], r.trajectory[i]);
        }
    }
}

TEST(Checkpoint, ReadingReturnsAnEqualProjection) {
    const auto log = log_of_two_robots(700);
    mapping::Projection projection{mapping::MapConfig{}};
    apply(projection, log, 0, log.size());
    Parts parts;
    merge(parts, parts_of(projection, 0));
    auto again = read(parts).value();
    expect_same(projection, again);
    Parts parts_again;
    merge(parts_again, parts_of(again, 0));
    EXPECT_EQ(parts, parts_again);
}

TEST(Checkpoint, RobotWithoutBodyRadiusKeepsTheOldFormat) {
    mapping::Projection projection{mapping::MapConfig{}};
    apply(projection, {RobotJoined{0, "b", "carmen:12"}}, 0, 1);
    const auto part = parts_of(projection, 0).at("robot/00000000");
    EXPECT_EQ(part.substr(16), std::string("b\0carmen:12", 11));
}

TEST(Checkpoint, EmptyCheckpointIsAnEmptyProjection) {
    auto projection = read({}).value();
    EXPECT_EQ(projection.revision(), 0U);
    EXPECT_TRUE(projection.snapshot().robots.empty());
}

TEST(Checkpoint, IncrementalCheckpointsMergeToAFullOne) {
    auto log = log_of_two_robots(700);
    Sensor changed = small_laser();
    changed.range_max = 3.0;
    log.insert(log.begin() + 500, SensorDescribed{1, changed});
    mapping::Projection projection{mapping::MapConfig{}};
    Parts merged;
    Revision since = 0;
    std::mt19937 random(9);
    for (std::size_t at = 0; at < log.size();) {
        const std::size_t end = std::min<std::size_t>(log.size(), at + 1 + random() % 250);
        apply(projection, log, at, end);
        at = end;
        merge(merged, parts_of(projection, since));
        since = projection.revision();
    }
    Parts full;
    merge(full, parts_of(projection, 0));
    EXPECT_EQ(merged, full);
}

TEST(Checkpoint, IncrementalCheckpointContainsOnlyChangedChunks) {
    mapping::Projection projection{mapping::MapConfig{}};
    apply(projection, log_of_two_robots(20), 0, 45);
    const auto full = parts_of(projection, 0).size();
    const Revision since = projection.revision();
    Scan scan = random_scan(0, 21);
    scan.ranges = {100}; // one short beam: changes at most the chunks around a corner
    ASSERT_TRUE(projection.apply(ScanTaken{0, scan}));
    const auto parts = parts_of(projection, since);
    const auto chunks = std::count_if(parts.begin(), parts.end(),
                                      [](const auto& part) { return part.first.starts_with("weave/laser/"); });
    EXPECT_GE(chunks, 1);
    EXPECT_LE(chunks, 4);
    EXPECT_TRUE(
        std::none_of(parts.begin(), parts.end(), [](const auto& part) { return part.first.starts_with("sensor/"); }));
    EXPECT_LT(parts.size(), full);
}

TEST(Checkpoint, TruncatedPartIsRefused) {
    mapping::Projection projection{mapping::MapConfig{}};
    apply(projection, log_of_two_robots(30), 0, 65);
    Parts parts;
    merge(parts, parts_of(projection, 0));
    for (const auto& [key, value] : parts) {
        const bool is_robot = key.starts_with("robot/"); // ends with a name of any length
        const std::size_t shortest = is_robot ? 16 : value.size();
        for (const std::size_t kept : {std::size_t{0}, std::size_t{7}, shortest / 2, shortest - 1}) {
            Parts damaged = parts;
            damaged[key].resize(kept);
            const auto refused = read(damaged);
            ASSERT_FALSE(refused) << key << " cut to " << kept;
            const bool is_of_version_1 = key == "format" && kept == 4; // which ended with the mapping version
            EXPECT_EQ(refused.error().code, is_of_version_1 ? Errc::kUnsupportedVersion : Errc::kMalformed);
        }
    }
}

TEST(Checkpoint, MissingFormatIsRefused) {
    mapping::Projection projection{mapping::MapConfig{}};
    apply(projection, log_of_two_robots(3), 0, 11);
    Parts parts;
    merge(parts, parts_of(projection, 0));
    parts.erase("format");
    EXPECT_THAT(read(parts).error().message, HasSubstr("part 'format' is missing"));
}

/// The tracks contain the newest poses; in version 2 only the tracks do.
TEST(Checkpoint, MissingPosesOfEarlierVersionsAreRefused) {
    mapping::Projection projection{mapping::MapConfig{}};
    apply(projection, log_of_two_robots(3), 0, 11);
    Parts parts;
    merge(parts, parts_of(projection, 0));
    parts["format"][4] = 2;
    parts["head"].resize(parts["head"].size() - 8);
    for (auto& [key, value] : parts) {
        if (key.starts_with("robot/")) value.erase(16, sizeof(mapping::TrajectoryPoint));
    }
    const auto refused = read(parts);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("no pose of robot 'a', which took 3 scans"));
    const auto newest = projection.state().robots[0].newest.value();
    parts["track/00000000/00000000"] = std::string(reinterpret_cast<const char*>(&newest), sizeof(newest));
    EXPECT_THAT(read(parts).error().message, HasSubstr("no pose of robot 'b', which took 3 scans"));
    parts["track/00000001/00000000"] = parts["track/00000000/00000000"];
    const auto restored = read(parts);
    ASSERT_TRUE(restored) << restored.error().message;
    EXPECT_EQ(restored->state().robots[0].newest, newest);
}

TEST(Checkpoint, InvalidPartIsRefusedByItsKey) {
    mapping::Projection projection{mapping::MapConfig{}};
    apply(projection, log_of_two_robots(3), 0, 11);
    Parts parts;
    merge(parts, parts_of(projection, 0));
    const std::string sensor = parts.at("sensor/00000000/00000002");
    const std::string scan = wire::encode_entry(ScanTaken{0, random_scan(0, 1)});
    const std::string point(40, '\0');
    const std::pair<std::string, std::string> kImpossible[] = {
        {"robot/00000003", std::string(17, 'x')},
        {"robot/00000000", std::string(16, '\1') + std::string("a\0s\0short", 9)},
        {"robot/00000000", std::string(16, '\1') + std::string("a\0s\0\0\0\0\0\0\0\0\0", 12)}, // a body radius of 0 m
        {"robot/", ""},
        {"sensor/00000002/00000000", sensor},
        {"sensor/00000001/00000009", scan},
        {"sensor/", ""},
        {"track/00000002/00000000", point},
        {"track/xyz/00000000", point},
        {"track", ""},
        {"weave/occupancy/00000000", ""},
        {"weave/occupancy/0/0/0", ""},
        {"weave/", ""},
        {"zebra", ""},
    };
    for (const auto& [key, value] : kImpossible) {
        Parts damaged = parts;
        damaged[key] = value;
        const auto refused = read(damaged);
        ASSERT_FALSE(refused) << key;
        EXPECT_EQ(refused.error().message, "checkpoint part '" + key + "' is damaged");
    }
}

/// A store that fails after a given number of checkpoint pieces, as after a power cut.
class PowerCutLog : public store::MemoryScanLog {
public:
    [[nodiscard]] Result<> write_checkpoint(store::SessionId session,
                                            std::vector<store::CheckpointPart> parts) override {
        if (pieces_left == 0) return Error{Errc::kStoreFailed, "no power"};
        --pieces_left;
        return MemoryScanLog::write_checkpoint(session, std::move(parts));
    }

    std::size_t pieces_left = 1'000'000;
};

/// A map that takes several pieces, and a robot that joins in its second half.
struct CutCheckpointTest : testing::Test {
    CutCheckpointTest() {
        std::vector<std::string> entries;
        for (const auto& entry : log_of_two_robots(40)) entries.push_back(wire::encode_entry(entry));
        half_ = entries.size() / 2;
        entries.insert(entries.begin() + half_, wire::encode_entry(RobotJoined{2, "late"}));
        id_ = log_.create_session("s").value();
        EXPECT_TRUE(store::append_and_wait(log_, id_, 1, entries));
        EXPECT_TRUE(whole_.replay_all(log_, id_));
    }

    struct LogReplay {
        explicit LogReplay(const mapping::MapConfig& config) : projection(config) {}
        Result<> replay_all(store::ScanLog& log, store::SessionId id) { return replay_to(log, id, ~Revision{0}); }
        Result<> replay_to(store::ScanLog& log, store::SessionId id, Revision last) {
            return log.read(id, projection.revision(), [&](Revision revision, std::string_view bytes) -> Result<> {
                return revision <= last ? projection.apply(wire::decode_entry(bytes).value()) : Result<>();
            });
        }
        mapping::Projection projection;
    };

    Result<> write(LogReplay& replay, Revision since) {
        return write_checkpoint(log_, id_, replay.projection.snapshot(), replay.projection.state(), since, false);
    }

    void expect_recovery_gives_the_whole(std::size_t pieces) {
        auto recovered = recover(log_, id_, config_, false);
        ASSERT_TRUE(recovered) << recovered.error().message;
        EXPECT_FALSE(recovered->checkpoint_rejected) << recovered->checkpoint_rejected->message;
        SCOPED_TRACE("cut after piece " + std::to_string(pieces));
        expect_same(recovered->maps.projection(), whole_.projection);
    }

    mapping::MapConfig config_ = *mapping::resolve({.cell_size = 0.01});
    PowerCutLog log_;
    store::SessionId id_ = 0;
    std::ptrdiff_t half_ = 0;
    LogReplay whole_{config_};
};

TEST_F(CutCheckpointTest, RecoveryUsesAPartlyWrittenFirstCheckpoint) {
    for (std::size_t pieces = 0;; ++pieces) {
        log_.pieces_left = pieces;
        const bool complete = write(whole_, 0).has_value();
        expect_recovery_gives_the_whole(pieces);
        if (complete) {
            EXPECT_GE(pieces, 3U) << "the test needs several pieces";
            return;
        }
    }
}

TEST_F(CutCheckpointTest, RecoveryUsesAPartlyWrittenLaterCheckpoint) {
    LogReplay first(config_);
    ASSERT_TRUE(first.replay_to(log_, id_, static_cast<Revision>(half_)));
    for (std::size_t pieces = 0;; ++pieces) {
        log_.pieces_left = 1'000'000;
        ASSERT_TRUE(write(first, 0)); // removes the parts of the previous round
        log_.pieces_left = pieces;
        const bool complete = write(whole_, static_cast<Revision>(half_)).has_value();
        EXPECT_EQ(recover(log_, id_, config_, false)->checkpointed,
                  complete ? whole_.projection.revision() : static_cast<Revision>(half_));
        expect_recovery_gives_the_whole(pieces);
        if (complete) {
            EXPECT_GE(pieces, 2U) << "the test needs several pieces";
            return;
        }
    }
}

TEST_F(CutCheckpointTest, RecoverySucceedsAfterAStoppedCheckpoint) {
    const auto stopped = write_checkpoint(log_, id_, whole_.projection.snapshot(), whole_.projection.state(), 0, true);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().code, Errc::kShuttingDown);
    expect_recovery_gives_the_whole(0);
}

TEST_F(CutCheckpointTest, ChunksNewerThanTheLogAreRefused) {
    ASSERT_TRUE(write(whole_, 0));
    const auto parts = store::checkpoint_of(log_, id_).value();
    PowerCutLog shorter;
    const auto id = shorter.create_session("s").value();
    std::vector<std::string> entries;
    for (const auto& entry : log_of_two_robots(10)) entries.push_back(wire::encode_entry(entry));
    ASSERT_TRUE(store::append_and_wait(shorter, id, 1, entries));
    for (const auto& [key, value] : parts) {
        if (key != "format" && !key.starts_with("weave/")) continue;
        ASSERT_TRUE(shorter.write_checkpoint(id, {{key, value}}));
    }
    const auto recovered = recover(shorter, id, config_, false);
    ASSERT_FALSE(recovered);
    EXPECT_THAT(recovered.error().message, HasSubstr("the log ends with entry 25, but its checkpoint holds entry"));
}

TEST(Checkpoint, OtherMappingVersionIsRefused) {
    mapping::Projection projection{mapping::MapConfig{}};
    Parts parts;
    merge(parts, parts_of(projection, 0));
    parts["format"][0] = static_cast<char>(mapping::kProjectionVersion + 1);
    const auto refused = read(parts);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kUnsupportedVersion);
    EXPECT_THAT(refused.error().message,
                HasSubstr(fmt::format("computed by version {}", mapping::kProjectionVersion + 1)));
}

} // namespace
} // namespace scanloom::sessions
