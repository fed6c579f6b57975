#include "server/store/log_file.hpp"

#include "common/hash/crc32c.hpp"

#include <boost/endian/conversion.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace scanloom::store {
namespace {

constexpr std::size_t kBlockBytes = 32768;

/// A simple writer of the format. crash_recovery_test.cpp reads files that RocksDB wrote.
void append_write(std::string& file, std::string_view payload) {
    bool first = true;
    do {
        std::size_t left = kBlockBytes - file.size() % kBlockBytes;
        if (left < 7) {
            file.append(left, '\0');
            left = kBlockBytes;
        }
        const auto part = payload.substr(0, left - 7);
        payload.remove_prefix(part.size());
        const char type = static_cast<char>(first ? (payload.empty() ? 1 : 2) : (payload.empty() ? 4 : 3));
        const std::uint32_t crc = crc32c({&type, 1}, part);
        unsigned char header[6];
        boost::endian::store_little_u32(header, ((crc >> 15) | (crc << 17)) + 0xa282ead8U);
        boost::endian::store_little_u16(header + 4, static_cast<std::uint16_t>(part.size()));
        file.append(reinterpret_cast<const char*>(header), 6).append(1, type).append(part);
        first = false;
    } while (!payload.empty());
}

/// A file with writes of these sizes, and the end of each.
struct Written {
    std::string file;
    std::vector<std::size_t> ends = {0};

    explicit Written(const std::vector<std::size_t>& sizes) {
        std::mt19937 random(5);
        for (const std::size_t size : sizes) {
            std::string payload(size, '\0');
            for (char& byte : payload) byte = static_cast<char>(1 + random() % 255);
            append_write(file, payload);
            ends.push_back(file.size());
        }
    }

    [[nodiscard]] std::size_t whole_bytes_of(std::size_t bytes) const {
        return *std::prev(std::upper_bound(ends.begin(), ends.end(), bytes));
    }
};

// Writes within a block, across blocks, and before a block's end that is too short for a header.
const Written kSmall({40, 200, 13, 90});
const Written kLarge({1000, 31000, 70000, 5, kBlockBytes - 7 - 3, 300, 40000});

void expect_torn(const std::string& file, std::size_t whole_bytes, const std::string& what) {
    const auto check = check_log_file(file);
    EXPECT_FALSE(check.damage) << what;
    EXPECT_EQ(check.whole_bytes, whole_bytes) << what;
}

TEST(LogFile, AnIntactFileHasNoDamage) {
    expect_torn("", 0, "empty");
    expect_torn(kSmall.file, kSmall.file.size(), "small");
    expect_torn(kLarge.file, kLarge.file.size(), "large");
}

TEST(LogFile, AFileCutOffAnywhereKeepsItsCompleteWrites) {
    for (std::size_t bytes = 0; bytes < kSmall.file.size(); ++bytes) {
        expect_torn(kSmall.file.substr(0, bytes), kSmall.whole_bytes_of(bytes), "cut at " + std::to_string(bytes));
    }
    std::mt19937 random(6);
    for (int round = 0; round < 200; ++round) {
        const std::size_t bytes = random() % kLarge.file.size();
        expect_torn(kLarge.file.substr(0, bytes), kLarge.whole_bytes_of(bytes), "cut at " + std::to_string(bytes));
    }
}

TEST(LogFile, ALastWriteWithUnwrittenPagesIsTorn) {
    const std::size_t whole = kLarge.ends[kLarge.ends.size() - 2];
    for (std::size_t begin = whole; begin < kLarge.file.size(); begin += 4096 - begin % 4096) {
        std::string file = kLarge.file;
        const std::size_t end = std::min(file.size(), begin + 4096 - begin % 4096);
        std::fill(file.begin() + static_cast<std::ptrdiff_t>(begin), file.begin() + static_cast<std::ptrdiff_t>(end),
                  '\0');
        expect_torn(file, whole, "page at " + std::to_string(begin));
    }
}

TEST(LogFile, AFileThatEndsInZerosKeepsItsCompleteWrites) {
    for (const std::size_t zeros : {1U, 6U, 7U, 5000U, 100000U}) {
        expect_torn(kSmall.file + std::string(zeros, '\0'), kSmall.file.size(), std::to_string(zeros) + " zeros");
    }
}

TEST(LogFile, AnyFlippedBitIsDamage) {
    for (std::size_t bit = 0; bit < kSmall.file.size() * 8; ++bit) {
        std::string file = kSmall.file;
        file[bit / 8] = static_cast<char>(file[bit / 8] ^ (1 << bit % 8));
        EXPECT_TRUE(check_log_file(file).damage) << "byte " << bit / 8 << " bit " << bit % 8;
    }
}

TEST(LogFile, AnyFlippedBitOfALargeFileIsDamageOrFillsABlock) {
    std::mt19937 random(7);
    for (int round = 0; round < 200; ++round) {
        std::string file = kLarge.file;
        const std::size_t at = random() % file.size();
        file[at] = static_cast<char>(file[at] ^ (1 << random() % 8));
        const auto check = check_log_file(file);
        EXPECT_TRUE(check.damage || check.whole_bytes == file.size()) << "byte " << at;
    }
}

TEST(LogFile, AHoleBeforeALaterWriteIsDamage) {
    std::string file = kLarge.file;
    const auto middle = file.begin() + static_cast<std::ptrdiff_t>(kLarge.ends[3] - 9000);
    std::fill(middle, middle + 4096, '\0');
    EXPECT_TRUE(check_log_file(file).damage);
}

TEST(LogFile, AMissingPieceIsDamage) {
    std::string file = kLarge.file;
    file.erase(0, kBlockBytes);
    EXPECT_TRUE(check_log_file(file).damage);
}

/// If it were taken for an unfinished write, the store would open empty.
TEST(LogFile, AnotherFilesContentsAreDamage) {
    const std::string identity = "1b4c2f6e-8d7a-4f0e-9c53-6a2f1d0b7e84\n";
    EXPECT_EQ(check_log_file(identity).damage, 0U);
    const std::string options = "# This is a RocksDB option file.\n#\n[Version]\n  rocksdb_version=7.8.3\n";
    EXPECT_EQ(check_log_file(options).damage, 0U);
    EXPECT_EQ(check_log_file(kSmall.file + options).damage, kSmall.file.size());
}

} // namespace
} // namespace scanloom::store
