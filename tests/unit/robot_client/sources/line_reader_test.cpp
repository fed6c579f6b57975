#include "robot_client/sources/line_reader.hpp"

#include "tests/support/packed_text.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <sstream>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::bzip2;
using testing_support::gzip;

class LineReaderTest : public testing::Test {
protected:
    /// Returns the number of readable lines and the error after them.
    std::pair<std::size_t, std::string> read(std::string_view bytes) {
        std::ofstream(path_, std::ios::binary) << bytes;
        auto reader = LineReader::open(path_);
        EXPECT_TRUE(reader);
        for (std::size_t lines = 0;; ++lines) {
            const auto line = reader->next();
            if (!line) return {lines, line.error().message};
            if (!*line) return {lines, ""};
        }
    }

    void TearDown() override { std::filesystem::remove(path_); }

    const std::filesystem::path path_ =
        std::filesystem::path(testing::TempDir()) /
        fmt::format("scanloom_{}.log", testing::UnitTest::GetInstance()->current_test_info()->name());
};

/// Returns lines that compress badly, so that half of the compressed bytes contains about half of the lines.
std::string noise(int lines) {
    std::mt19937 random(3);
    std::string text;
    for (int i = 0; i < lines; ++i) text += fmt::format("{} {} {}\n", random(), random(), random());
    return text;
}

TEST_F(LineReaderTest, TruncatedGzipFileReportsReadableLines) {
    const std::string whole = gzip(noise(1000));
    const auto [lines, error] = read(std::string_view(whole).substr(0, whole.size() / 2));
    EXPECT_GT(lines, 300U) << "lines before the cut are read";
    EXPECT_THAT(error, HasSubstr(path_.string() + ": the gzip data is damaged or truncated"));
    EXPECT_THAT(error, HasSubstr(fmt::format("only its first {} lines (", lines)));
    EXPECT_THAT(error, HasSubstr("unpack them with zcat"));
}

TEST_F(LineReaderTest, TruncatedBzip2FileReportsReadableLines) {
    const std::string whole = bzip2(noise(60'000)); // more than one bzip2 block
    const auto [lines, error] = read(std::string_view(whole).substr(0, whole.size() - 10));
    EXPECT_GT(lines, 10'000U);
    EXPECT_THAT(error, HasSubstr(fmt::format("only its first {} lines (", lines)));
    EXPECT_THAT(error, HasSubstr("unpack them with bzcat"));
}

TEST_F(LineReaderTest, UnreadableFileReportsNoLineCount) {
    const std::string whole = bzip2(noise(100));
    const auto [lines, error] = read(std::string_view(whole).substr(0, whole.size() / 2));
    EXPECT_EQ(lines, 0U);
    EXPECT_THAT(error, HasSubstr("the bzip2 data is damaged or truncated: no text could be read"));
    EXPECT_THAT(error, Not(HasSubstr("line")));
}

TEST_F(LineReaderTest, CompleteFilesAreReadCompletely) {
    const std::string text = noise(20'000);
    for (const std::string& bytes : {text, gzip(text), bzip2(text)}) {
        const auto [lines, error] = read(bytes);
        EXPECT_EQ(lines, 20'000U);
        EXPECT_EQ(error, "");
    }
}

TEST_F(LineReaderTest, ReportsProgressInBytes) {
    const std::string text = noise(60'000); // more than one bzip2 block
    for (const std::string& bytes : {text, gzip(text), bzip2(text)}) {
        std::ofstream(path_, std::ios::binary) << bytes;
        std::vector<std::uint64_t> progress_bytes;
        auto reader = LineReader::open(path_, {}, [&](const ReadProgress& progress) {
            progress_bytes.push_back(progress.bytes);
            EXPECT_EQ(progress.bytes_total, bytes.size());
        });
        ASSERT_TRUE(reader);
        while (reader->next().value()) {
        }
        EXPECT_TRUE(std::ranges::is_sorted(progress_bytes));
        ASSERT_GT(progress_bytes.size(), 5U);
        EXPECT_LT(progress_bytes.front(), bytes.size());
        EXPECT_EQ(progress_bytes.back(), bytes.size());
    }
}

TEST_F(LineReaderTest, ConcatenatedCompressedFilesAreOneText) {
    const std::string text = noise(100);
    EXPECT_EQ(read(gzip(text) + gzip(text)).first, 200U);
    EXPECT_EQ(read(bzip2(text) + bzip2(text)).first, 200U);
}

TEST_F(LineReaderTest, ZeroBytesAfterCompressedDataArePadding) {
    const std::string text = noise(100);
    for (const std::string& whole : {gzip(text), bzip2(text)}) {
        for (const std::size_t zeros : {1U, 10U, 512U, 100'000U}) {
            const auto [lines, error] = read(whole + std::string(zeros, '\0'));
            EXPECT_EQ(lines, 100U) << zeros;
            EXPECT_EQ(error, "") << zeros;
        }
    }
}

TEST_F(LineReaderTest, OtherBytesAfterCompressedDataAreDamage) {
    const std::string text = noise(100);
    for (const std::string& whole : {gzip(text), bzip2(text)}) {
        for (const std::string& rest : {std::string("x"), std::string(20'000, '\0') + "x", std::string(1, '\0') + whole,
                                        whole.substr(0, 2), whole.substr(0, 12)}) {
            const auto [lines, error] = read(whole + rest);
            EXPECT_EQ(lines, 100U) << "lines before the damage are read";
            EXPECT_THAT(error, HasSubstr("data is damaged or truncated"));
        }
    }
}

TEST_F(LineReaderTest, ZerosInCompressedDataAreDamage) {
    const std::string text = noise(1000);
    for (const std::string& whole : {gzip(text), bzip2(text)}) {
        for (const std::size_t kept : {3U, 12U, 5000U, static_cast<unsigned>(whole.size() - 10)}) {
            std::string zeroed = whole.substr(0, kept);
            zeroed.resize(whole.size() + 512, '\0'); // as after a power failure
            EXPECT_THAT(read(zeroed).second, HasSubstr("data is damaged or truncated")) << kept;
        }
    }
}

} // namespace
} // namespace scanloom::robot
