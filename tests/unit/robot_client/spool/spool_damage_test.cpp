#include "tests/unit/robot_client/spool/spool_fixture.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <random>
#include <set>

/// Damage to a spool's files.
namespace scanloom::robot {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

class SpoolTrials : public SpoolTest {};

TEST_F(SpoolTest, PartOfALastScanAfterAPowerCutIsDropped) {
    open();
    take(1, 10);
    spool_.reset();
    const auto file = files().at(0);
    const auto whole = fs::file_size(file);
    for (const std::uintmax_t cut : {1U, 100U, 1500U}) {
        fs::resize_file(file, whole - cut);
        open();
        EXPECT_EQ(spool_->waiting(), 9U) << cut;
    }
    take(10, 12);
    ASSERT_TRUE(spool_->begin("a1", 0));
    EXPECT_EQ(handed_out(), from_to(1, 12));
    spool_.reset();
    fs::resize_file(file, 3);
    open();
    EXPECT_EQ(spool_->waiting(), 3U) << "the file is shorter than its header";
}

TEST_F(SpoolTest, DamageIsReportedAndIntactScansAreKept) {
    open();
    take(1, 400); // more than two files
    const auto count = files().size();
    ASSERT_GE(count, 1U);
    take(401, 5000);
    spool_.reset();
    const auto file = files().at(0);
    std::mt19937 random(5);
    for (int round = 0; round < 20; ++round) {
        std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
        const auto at = static_cast<std::streamoff>(100 + random() % (fs::file_size(file) - 100));
        bytes.seekg(at);
        const int was = bytes.get();
        bytes.seekp(at);
        bytes.put(static_cast<char>(was ^ 0x20));
        bytes.close();
        messages_.clear();
        open();
        ASSERT_TRUE(spool_->begin("a1", 0));
        const auto kept = handed_out();
        EXPECT_LT(kept.size(), 5000U);
        EXPECT_EQ(kept.back(), 5000U) << "other files are intact";
        for (std::size_t i = 1; i < kept.size(); ++i) EXPECT_GT(kept[i], kept[i - 1]);
        EXPECT_THAT(messages_, Contains(HasSubstr("is damaged after")));
        spool_.reset();
        fs::remove(directory_.path() / "numbering");
        std::fstream repaired(file, std::ios::in | std::ios::out | std::ios::binary);
        repaired.seekp(at);
        repaired.put(static_cast<char>(was));
    }
}

TEST_F(SpoolTest, MisplacedFilesAreSetAside) {
    open();
    take(1, 3500);
    spool_.reset();
    const auto all = files();
    ASSERT_GE(all.size(), 2U);
    fs::rename(all[0], all[0].string() + "x");
    fs::rename(all[1], all[0]);
    fs::rename(all[0].string() + "x", all[1]);
    std::ofstream(directory_.path() / "00000000000000009999.spool") << "something else, and long enough to be one";
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    for (const auto& number : handed_out()) EXPECT_GT(number, 1000U);
    EXPECT_THAT(messages_, Contains(HasSubstr("is not a spool file")));
    EXPECT_THAT(messages_, Contains(HasSubstr("contains the scans of another file")));
    EXPECT_TRUE(fs::exists(all[0].string() + ".unreadable"));
    EXPECT_TRUE(fs::exists(directory_.path() / "00000000000000009999.spool.unreadable"));
}

TEST_F(SpoolTest, SetAsideFilesGetUniqueNames) {
    const auto file = directory_.path() / "00000000000000000001.spool";
    for (const char* text : {"the first thing that is no spool", "the second thing that is no spool"}) {
        std::ofstream(file) << text;
        open();
    }
    EXPECT_TRUE(fs::exists(file.string() + ".unreadable"));
    EXPECT_TRUE(fs::exists(file.string() + ".unreadable.2"));
}

TEST_F(SpoolTest, DamagedFileHeaderIsReportedAndBounded) {
    for (const std::size_t damaged : {0U, 1U, 2U}) {
        fs::remove_all(directory_.path());
        fs::create_directories(directory_.path());
        open();
        ASSERT_TRUE(spool_->begin("a1", 7));
        for (std::uint64_t number = 1; number <= 41; number += 20) { // three files
            take(number, number + 19);
            handed_out();
            open();
            ASSERT_TRUE(spool_->begin("a1", 7));
            handed_out();
        }
        spool_.reset();
        ASSERT_EQ(files().size(), 3U);
        std::fstream(files().at(damaged), std::ios::in | std::ios::out).write("no head", 7);
        messages_.clear();
        open();
        ASSERT_TRUE(spool_->begin("a1", 32));
        EXPECT_EQ(handed_out(), from_to(26, 60)) << damaged;
        EXPECT_THAT(messages_, Contains(HasSubstr("numbered by the adjacent files")));
    }
}

TEST_F(SpoolTest, DamagedNumberingIsReportedAndLosesNoScans) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    take(1, 50);
    handed_out();
    spool_->acknowledge(10);
    spool_.reset();
    std::fstream numbering(directory_.path() / "numbering", std::ios::in | std::ios::out);
    std::string text{std::istreambuf_iterator<char>(numbering), {}};
    numbering.seekp(static_cast<std::streamoff>(text.find("10 ")));
    numbering << "99";
    numbering.close();
    open();
    EXPECT_EQ(spool_->waiting(), 50U);
    EXPECT_THAT(messages_, Contains(HasSubstr("numbering is damaged")));
    ASSERT_TRUE(spool_->begin("a1", 30));
    EXPECT_EQ(handed_out(), from_to(31, 50));
}

TEST_F(SpoolTest, ServerMayHaveMoreScansAfterAPowerCut) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    take(1, 28);
    handed_out();
    spool_.reset();
    const auto file = files().at(0);
    fs::resize_file(file, fs::file_size(file) * 3 / 4);
    open();
    take(29, 40); // before a server is reached
    ASSERT_TRUE(spool_->begin("a1", 28));
    EXPECT_EQ(handed_out(), from_to(29, 40));
    EXPECT_THAT(messages_, Contains(HasSubstr("more than were sent from")));
}

TEST_F(SpoolTest, TruncatedFileDoesNotAffectTheNext) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    take(1, 24);
    handed_out();
    open(); // killed before any acknowledgement; new scans go to another file
    take(25, 44);
    spool_.reset();
    ASSERT_EQ(files().size(), 2U);
    fs::resize_file(files().at(0), fs::file_size(files().at(0)) * 7 / 8);
    open();
    ASSERT_TRUE(spool_->begin("a1", 24));
    EXPECT_EQ(handed_out(), from_to(25, 44));
}

TEST_F(SpoolTest, EndOfADamagedFileMayBeStored) {
    open();
    ASSERT_TRUE(spool_->begin("a1", 0));
    take(1, 24);
    handed_out();
    spool_.reset();
    std::fstream bytes(files().at(0), std::ios::in | std::ios::out | std::ios::binary);
    bytes.seekp(static_cast<std::streamoff>(fs::file_size(files().at(0)) / 2));
    bytes.write("damage", 6);
    bytes.close();
    open();
    take(25, 26);
    ASSERT_TRUE(spool_->begin("a1", 24));
    EXPECT_EQ(handed_out(), from_to(25, 26));
}

TEST_F(SpoolTest, MissingScanEndsAFile) {
    open();
    take(1, 9);
    spool_.reset();
    const auto file = files().at(0);
    auto reader = SegmentReader::open(file).value();
    std::vector<std::uint64_t> ends;
    while (reader.next().value()) ends.push_back(reader.position());
    std::ifstream in(file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    bytes.erase(ends[4], ends[5] - ends[4]); // the sensor is the first record
    std::ofstream(file, std::ios::binary) << bytes;
    open();
    EXPECT_EQ(spool_->waiting(), 4U);
    EXPECT_THAT(messages_, Contains(HasSubstr("lacks scan 5")));
}

/// Returns the numbers of the readable scans in a file.
std::vector<std::uint64_t> numbers_in(const fs::path& file) {
    std::vector<std::uint64_t> numbers;
    auto reader = SegmentReader::open(file);
    while (reader) {
        const auto record = reader->next();
        if (!record || !*record) break;
        if (const auto* batch = std::get_if<wire::ScanBatch>(&(*record)->message)) {
            numbers.push_back(static_cast<std::uint64_t>(batch->scans.front().pose->x));
        }
    }
    return numbers;
}

/// Random use compared with a list in memory; files are truncated, damaged or removed between two runs.
TEST_F(SpoolTrials, ReadableScansAreSentExactlyOnce) {
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
        spool_.reset();
        fs::remove_all(directory_.path());
        std::mt19937 random(seed);
        std::vector<std::uint64_t> server;
        std::set<std::uint64_t> gone; // removed from the disk
        std::uint64_t taken = 0;
        for (int run = 0; run < 6; ++run) {
            open(kMebibyte * 1024); // no scan is dropped for lack of space
            const bool is_reached = random() % 4 != 0;
            const int last_arrival = static_cast<int>(random() % 60); // later scans are lost in transit
            if (is_reached) {
                ASSERT_TRUE(spool_->begin("a1", server.size())) << "seed " << seed;
            }
            for (int event = 0; event < 40; ++event) {
                const std::uint64_t count = random() % 200;
                take(taken + 1, taken + count);
                taken += count;
                if (!is_reached) continue;
                const auto sent = handed_out(random() % 300);
                if (event <= last_arrival) std::ranges::copy(sent, std::back_inserter(server));
                if (random() % 8 == 0) spool_->acknowledge(server.size() - random() % (server.size() + 1));
            }
            spool_.reset();
            const auto all = files();
            if (all.empty() || random() % 3 == 0) continue;
            const auto file = all[random() % all.size()];
            const auto before = numbers_in(file);
            switch (random() % 3) {
            case 0: fs::resize_file(file, random() % fs::file_size(file)); break;
            case 1: fs::remove(file); break;
            default: {
                std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
                const auto at = static_cast<std::streamoff>(random() % fs::file_size(file));
                bytes.seekg(at);
                const int was = bytes.get();
                bytes.seekp(at);
                bytes.put(static_cast<char>(was ^ (1 << random() % 8)));
            }
            }
            const auto left = numbers_in(file); // the beginning of the file
            gone.insert(before.begin() + static_cast<std::ptrdiff_t>(left.size()), before.end());
        }
        open(kMebibyte * 1024);
        ASSERT_TRUE(spool_->begin("a1", server.size()));
        std::ranges::copy(handed_out(), std::back_inserter(server));
        auto expected = from_to(1, taken);
        const std::set<std::uint64_t> held(server.begin(), server.end());
        std::erase_if(expected, [&](std::uint64_t number) { return gone.contains(number) && !held.contains(number); });
        ASSERT_EQ(server, expected) << "seed " << seed;
    }
}

TEST_F(SpoolTest, DirectoryThatCannotBeCreatedIsAnError) {
    std::ofstream(directory_.path() / "file") << "x";
    const auto refused = Spool::open({directory_.path() / "file" / "spool"}, [](const std::string&) {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("cannot create"));
}

} // namespace
} // namespace scanloom::robot
