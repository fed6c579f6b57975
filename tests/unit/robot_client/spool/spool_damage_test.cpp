#include "tests/unit/robot_client/spool/spool_fixture.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <random>

/// What others have done to a spool's files.
namespace scanloom::robot {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

TEST_F(SpoolTest, WhatAPowerCutLeftOfTheLastScanIsLeftOut) {
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
    EXPECT_EQ(spool_->waiting(), 3U) << "less than a file begins with";
}

TEST_F(SpoolTest, DamageIsToldAndWhatStandsBeforeItAndInOtherFilesIsKept) {
    open();
    take(1, 400); // two files and more
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
        told_.clear();
        open();
        ASSERT_TRUE(spool_->begin("a1", 0));
        const auto kept = handed_out();
        EXPECT_LT(kept.size(), 5000U);
        EXPECT_EQ(kept.back(), 5000U) << "other files are whole";
        for (std::size_t i = 1; i < kept.size(); ++i) EXPECT_GT(kept[i], kept[i - 1]);
        EXPECT_THAT(told_, Contains(HasSubstr("is damaged after")));
        spool_.reset();
        fs::remove(directory_.path() / "numbering");
        std::fstream mended(file, std::ios::in | std::ios::out | std::ios::binary);
        mended.seekp(at);
        mended.put(static_cast<char>(was));
    }
}

TEST_F(SpoolTest, FilesThatAreNotItsOwnAreRefused) {
    std::ofstream(directory_.path() / "00000000000000000001.spool") << "something else, and long enough";
    const auto refused = Spool::open({directory_.path()}, [](const std::string&) {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("is no file of a spool"));
    fs::remove(directory_.path() / "00000000000000000001.spool");
    std::ofstream(directory_.path() / "numbering") << "1 2 3";
    const auto damaged = Spool::open({directory_.path()}, [](const std::string&) {});
    ASSERT_FALSE(damaged);
    EXPECT_THAT(damaged.error().message, HasSubstr("numbering is damaged"));
}

TEST_F(SpoolTest, ADirectoryThatCannotBeMadeIsAClearError) {
    std::ofstream(directory_.path() / "file") << "x";
    const auto refused = Spool::open({directory_.path() / "file" / "spool"}, [](const std::string&) {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("cannot create"));
}

} // namespace
} // namespace scanloom::robot
