#include "robot_client/spool/segment.hpp"
#include "tests/unit/robot_client/spool/spool_fixture.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <random>
#include <utility>

namespace scanloom::robot {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(SpoolTest, ReturnsScansInOrder) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    take(1, 5);
    EXPECT_EQ(spool_->waiting(), 5U);
    EXPECT_EQ(handed_out(), from_to(1, 5));
    EXPECT_EQ(spool_->waiting(), 0U);
    take(6, 9);
    EXPECT_EQ(handed_out(), from_to(6, 9)) << "scans appended after reading to the end must be returned";
}

TEST_F(SpoolTest, ReturnsEachScanWithItsSensor) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    for (std::uint64_t number = 1; number <= 40; ++number) {
        ASSERT_TRUE(spool_->append(numbered(number, static_cast<std::uint32_t>(number % 3))).value());
    }
    EXPECT_EQ(handed_out(), from_to(1, 40));
}

TEST_F(SpoolTest, ScansSurviveARestartBeforeTheFirstConnection) {
    open();
    take(1, 3000); // several files
    EXPECT_GT(files().size(), 1U);
    open();
    EXPECT_EQ(spool_->waiting(), 3000U);
    take(3001, 3100);
    ASSERT_TRUE(spool_->begin("a1", 0));
    EXPECT_EQ(handed_out(), from_to(1, 3100));
}

TEST_F(SpoolTest, RestartReturnsOnlyScansThatTheServerLacks) {
    for (const std::uint64_t durable : {0U, 1U, 699U, 700U, 2500U, 2999U, 3000U}) {
        fs::remove_all(directory_.path());
        open();
        ASSERT_TRUE(spool_->begin("a1", 0));
        take(1, 3000);
        EXPECT_EQ(handed_out(), from_to(1, 3000)) << "all scans may have been sent";
        spool_->acknowledge(std::min<std::uint64_t>(durable, 700)); // the other scans are not acknowledged
        open();
        take(3001, 3010);
        ASSERT_TRUE(spool_->begin("a1", durable)) << durable;
        EXPECT_EQ(spool_->waiting(), 3010 - durable);
        EXPECT_EQ(handed_out(), from_to(durable + 1, 3010)) << durable;
        EXPECT_THAT(messages_, IsEmpty());
    }
}

TEST_F(SpoolTest, AcknowledgedFilesAreRemoved) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    take(1, 5000);
    const auto all = files().size();
    const auto bytes = spool_->bytes();
    EXPECT_EQ(handed_out(2500), from_to(1, 2500));
    spool_->acknowledge(2500);
    EXPECT_LT(files().size(), all);
    EXPECT_LT(spool_->bytes(), bytes);
    handed_out();
    spool_->acknowledge(5000);
    spool_->remove_acknowledged();
    EXPECT_THAT(files(), IsEmpty());
    EXPECT_EQ(spool_->bytes(), 0U);
    open();
    take(5001, 5002);
    ASSERT_TRUE(spool_->begin("a1", 5000)) << "the numbering continues";
    EXPECT_EQ(handed_out(), from_to(5001, 5002));
}

TEST_F(SpoolTest, SteadyConnectionNeedsLittleDiskSpace) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    std::uint64_t most = 0;
    for (std::uint64_t number = 1; number <= 10'000; ++number) {
        take(number, number);
        ASSERT_EQ(handed_out(), from_to(number, number));
        spool_->acknowledge(number);
        most = std::max(most, spool_->bytes());
    }
    EXPECT_LE(most, 2 * kMebibyte);
    EXPECT_LE(files().size(), 1U);
}

TEST_F(SpoolTest, FullSpoolDropsTheOldestUnsentScans) {
    open(2 * kMebibyte);
    ASSERT_TRUE(spool_->begin("a1", 0));
    take(1, 10);
    EXPECT_EQ(handed_out(), from_to(1, 10)) << "these scans are sent but not acknowledged";
    take(11, 5000);
    EXPECT_LE(spool_->bytes(), 2 * kMebibyte);
    EXPECT_GT(spool_->dropped(), 3000U);
    EXPECT_THAT(messages_, ElementsAre(HasSubstr("the oldest unsent scans are dropped")));
    const auto rest = handed_out();
    ASSERT_FALSE(rest.empty());
    EXPECT_EQ(rest.back(), 5000U);
    EXPECT_EQ(spool_->dropped() + rest.size(), 4990U);
    EXPECT_TRUE(std::ranges::is_sorted(rest));
}

TEST_F(SpoolTest, FullSpoolDropsTheNewestScansOnRequest) {
    open(2 * kMebibyte, WhenFull::kDropNewest);
    ASSERT_TRUE(spool_->begin("a1", 0));
    std::uint64_t kept = 0;
    for (std::uint64_t number = 1; number <= 3000; ++number) kept += spool_->append(numbered(number)).value() ? 1 : 0;
    EXPECT_LE(spool_->bytes(), 2 * kMebibyte);
    EXPECT_EQ(spool_->dropped(), 3000 - kept);
    EXPECT_EQ(handed_out(), from_to(1, kept));
    EXPECT_THAT(messages_, ElementsAre(HasSubstr("the newest scans are dropped")));
    spool_->acknowledge(kept);
    EXPECT_TRUE(spool_->append(numbered(9999)).value()) << "there is space again";
    EXPECT_EQ(handed_out(), from_to(9999, 9999));
}

TEST_F(SpoolTest, SequenceNumbersSurviveDropsAndKills) {
    open(2 * kMebibyte);
    ASSERT_TRUE(spool_->begin("a1", 0));
    take(1, 10);
    handed_out();
    take(11, 3000); // the oldest of these are dropped
    const std::uint64_t left = spool_->waiting();
    open(2 * kMebibyte);
    take(3001, 4000); // more are dropped, and the server is still unreachable
    EXPECT_LE(spool_->bytes(), 2 * kMebibyte);
    ASSERT_TRUE(spool_->begin("a1", 7)) << "three of the ten scans did not arrive";
    auto all = handed_out();
    EXPECT_GT(left, 100U);
    ASSERT_GT(all.size(), 100U);
    EXPECT_THAT(std::vector(all.begin(), all.begin() + 3), ElementsAre(8, 9, 10));
    EXPECT_EQ(all.back(), 4000U);
}

TEST_F(SpoolTest, ServerThatLostScansIsAnError) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 100));
    take(1, 50);
    handed_out();
    spool_->acknowledge(120);
    open();
    const auto refused = spool_->begin("a1", 119);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kConflict);
    EXPECT_THAT(refused.error().message, HasSubstr("has 119 scans of this robot but had acknowledged 120"));
    open();
    ASSERT_TRUE(spool_->begin("a1", 150)) << "all scans arrived";
    EXPECT_THAT(handed_out(), IsEmpty());
    EXPECT_THAT(messages_, IsEmpty());
}

TEST_F(SpoolTest, ContinuesAfterTheServersLastScan) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 100));
    take(1, 50);
    handed_out();
    open();
    take(51, 52);
    ASSERT_TRUE(spool_->begin("a1", 157));
    EXPECT_EQ(handed_out(), from_to(51, 52));
    EXPECT_THAT(messages_, ElementsAre(HasSubstr("7 more than were sent from")));
}

TEST_F(SpoolTest, ForeignScansDoNotReplaceUnsentScans) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    take(1, 5);
    handed_out();
    spool_->acknowledge(5);
    spool_->remove_acknowledged();
    open();
    take(6, 9);
    ASSERT_TRUE(spool_->begin("a1", 300)) << "295 scans were sent without a spool";
    EXPECT_EQ(handed_out(), from_to(6, 9));
}

TEST_F(SpoolTest, RecreatedSessionGetsUnacknowledgedScans) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 100));
    take(1, 50);
    handed_out(20);
    spool_->acknowledge(112);
    open();
    EXPECT_EQ(spool_->waiting(), 38U);
    ASSERT_TRUE(spool_->begin("b2", 0));
    EXPECT_THAT(messages_, ElementsAre(HasSubstr("38 unacknowledged scans go to the new one")));
    open();
    ASSERT_TRUE(spool_->begin("b2", 0));
    EXPECT_EQ(handed_out(20), from_to(13, 32));
    open();
    take(51, 52);
    ASSERT_TRUE(spool_->begin("b2", 5));
    EXPECT_EQ(handed_out(), from_to(18, 52)) << "the scans have the numbers of the new session";
}

TEST_F(SpoolTest, LocatedPosesBeginTheMapOfAnotherSession) {
    const auto open_with_located_poses = [&] {
        spool_.reset();
        spool_ = Spool::open({.directory = directory_.path(), .poses_from_server = true}, [&](const std::string& text) {
                     messages_.push_back(text);
                 }).value();
    };
    const auto handed_out_as_beginning = [&](bool begins) {
        std::vector<std::uint64_t> numbers;
        while (const auto next = spool_->next().value()) {
            EXPECT_EQ(next->scan.begins_map, begins);
            numbers.push_back(static_cast<std::uint64_t>(next->scan.pose->x));
        }
        return numbers;
    };
    open_with_located_poses();
    ASSERT_TRUE(spool_->begin("a1", 100));
    take(1, 20);
    EXPECT_EQ(handed_out_as_beginning(false), from_to(1, 20));
    spool_->acknowledge(112);
    for (int refused = 0; refused < 3; ++refused) { // by a session with a map
        open_with_located_poses();
        ASSERT_TRUE(spool_->begin("b2", 0));
        EXPECT_EQ(handed_out_as_beginning(true), from_to(13, 20));
    }
    open_with_located_poses();
    ASSERT_TRUE(spool_->begin("a1", 112));
    EXPECT_EQ(handed_out_as_beginning(true), from_to(13, 20)) << "a session with earlier scans must ignore the flag";
    open_with_located_poses();
    ASSERT_TRUE(spool_->begin("c3", 0));
    EXPECT_EQ(handed_out_as_beginning(true), from_to(13, 20));
    spool_->acknowledge(3);
    take(21, 22);
    EXPECT_EQ(handed_out_as_beginning(false), from_to(21, 22)) << "the map has begun";
    open_with_located_poses();
    ASSERT_TRUE(spool_->begin("c3", 3));
    EXPECT_EQ(handed_out_as_beginning(false), from_to(16, 22));
}

TEST_F(SpoolTest, KeepsWhatThePosesAre) {
    open();
    EXPECT_EQ(spool_->poses(), std::nullopt);
    ASSERT_TRUE(spool_->state_poses(Poses::kMap));
    take(1, 2);
    open();
    EXPECT_EQ(spool_->poses(), Poses::kMap);
    const auto refused = spool_->state_poses(Poses::kOdometry);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kConflict);
    EXPECT_TRUE(refused.error().message.ends_with(": an earlier run took the 2 scans there with 'map' poses, not "
                                                  "'odometry': send them with the --poses of that run, or move the "
                                                  "directory away"))
        << refused.error().message;
    spool_.reset();
    EXPECT_FALSE(Spool::open({.directory = directory_.path(), .poses = Poses::kOdometry}, [](const auto&) {}));
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    EXPECT_EQ(handed_out(), from_to(1, 2)) << "the scans are kept";
    spool_->acknowledge(2);
    spool_->remove_acknowledged();
    open();
    EXPECT_EQ(spool_->poses(), Poses::kMap);
    EXPECT_TRUE(spool_->state_poses(Poses::kOdometry)) << "none waits";
    open();
    EXPECT_EQ(spool_->poses(), Poses::kOdometry);
}

/// As after a damage, and of spools of earlier releases.
TEST_F(SpoolTest, ScansWithOtherPosesThanStatedAreNotHandedOut) {
    open();
    take(1, 2);
    open();
    ASSERT_TRUE(spool_->state_poses(Poses::kOdometry));
    ASSERT_TRUE(spool_->begin("a1", 0));
    const auto refused = spool_->next();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kConflict);
    EXPECT_THAT(refused.error().message, HasSubstr("with other poses, not 'odometry'"));
    open();
    ASSERT_TRUE(spool_->state_poses(Poses::kMap));
    ASSERT_TRUE(spool_->begin("a1", 0));
    EXPECT_EQ(handed_out(), from_to(1, 2)) << "the refused scans are kept";
}

TEST_F(SpoolTest, ReadsTheNumberingOfEarlierReleases) {
    open();
    take(1, 3);
    ASSERT_TRUE(spool_->begin("a1", 0));
    handed_out();
    spool_.reset();
    std::string content = fmt::format("scanloom-spool 2\n{:<64} {:>20}\n", "a1", 1);
    content += fmt::format("{:>10}\n", checksum(content));
    std::ofstream(directory_.path() / "numbering") << content;
    open();
    EXPECT_THAT(messages_, IsEmpty());
    EXPECT_EQ(spool_->waiting(), 2U);
}

TEST_F(SpoolTest, LostNumberingSendsNoScanTwice) {
    for (const bool empty : {false, true}) {
        fs::remove_all(directory_.path());
        fs::create_directories(directory_.path());
        open();
        ASSERT_TRUE(spool_->begin("a1", 3));
        take(1, 3000);
        handed_out(2000);
        spool_.reset();
        fs::remove(directory_.path() / "numbering");
        if (empty) std::ofstream(directory_.path() / "numbering").close();
        open();
        ASSERT_TRUE(spool_->begin("a1", 1503));
        EXPECT_EQ(handed_out(), from_to(1501, 3000));
    }
}

TEST_F(SpoolTest, DirectoryCannotBeSharedByTwoPrograms) {
    open();
    const auto second = Spool::open({directory_.path()}, [](const std::string&) {});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::kConflict);
    EXPECT_THAT(second.error().message, HasSubstr("another program uses the spool"));
}

class RandomSpoolUse : public SpoolTest {
protected:
    void expect_no_scan_lost_or_duplicated(std::uint32_t seeds);
};

/// Compares with a list in memory: appends, sends, acknowledgements that may be lost, and kills.
void RandomSpoolUse::expect_no_scan_lost_or_duplicated(std::uint32_t seeds) {
    for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
        spool_.reset();
        fs::remove_all(directory_.path());
        std::mt19937 random(seed);
        std::vector<std::uint64_t> server; // durable scans, in order
        std::uint64_t taken = 0;
        open();
        bool is_begun = false;
        for (int event = 0; event < 300; ++event) {
            switch (random() % 6) {
            case 0:
            case 1: {
                const std::uint64_t count = random() % 40;
                take(taken + 1, taken + count);
                taken += count;
                break;
            }
            case 2:
                if (!std::exchange(is_begun, true)) {
                    ASSERT_TRUE(spool_->begin("a1", server.size()));
                }
                break;
            case 3:
            case 4:
                if (is_begun) {
                    for (const auto number : handed_out(random() % 60)) server.push_back(number);
                }
                if (is_begun && random() % 2 == 0) spool_->acknowledge(server.size());
                break;
            default:
                if (random() % 8 == 0) {
                    open();
                    is_begun = false;
                }
            }
        }
        if (!is_begun) {
            ASSERT_TRUE(spool_->begin("a1", server.size()));
        }
        for (const auto number : handed_out()) server.push_back(number);
        ASSERT_EQ(server, from_to(1, taken)) << "seed " << seed;
    }
}

TEST_F(RandomSpoolUse, LosesOrDuplicatesNoScan) { expect_no_scan_lost_or_duplicated(8); }

class RandomSpoolUseTrials : public RandomSpoolUse {};

TEST_F(RandomSpoolUseTrials, LosesOrDuplicatesNoScan) { expect_no_scan_lost_or_duplicated(30); }

} // namespace
} // namespace scanloom::robot
