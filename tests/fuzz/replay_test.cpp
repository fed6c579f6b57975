#include "tests/fuzz/check.hpp"
#include "tests/fuzz/corpus.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace scanloom::fuzz {
namespace {

const std::filesystem::path kCorpora = SCANLOOM_SOURCE_DIR "/tests/fuzz/corpus";

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

class FuzzCorpus : public testing::TestWithParam<Fuzzer> {};

/// Runs a fuzzer on every file of its corpus once. A fuzzer aborts on an input that violates a property.
TEST_P(FuzzCorpus, EveryFilePasses) {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(kCorpora / GetParam().name)) {
        SCOPED_TRACE(entry.path());
        const auto bytes = bytes_of(entry.path());
        EXPECT_EQ(GetParam().run(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
        ++files;
    }
    EXPECT_GT(files, 0U);
}

/// A parser rejects a seed of an earlier format at once, so it would test nothing.
TEST(FuzzCorpora, AreOfTodaysFormats) {
    const std::filesystem::path folder = SCANLOOM_BUILD_DIR "/fuzz_corpus";
    for (const auto& fuzzer : fuzzers()) std::filesystem::remove_all(folder / fuzzer.name);
    write_corpus(folder);
    std::size_t seeds = 0;
    for (const auto& fuzzer : fuzzers()) {
        if (!exists(folder / fuzzer.name)) continue;
        for (const auto& seed : std::filesystem::directory_iterator(folder / fuzzer.name)) {
            const auto kept = kCorpora / fuzzer.name / seed.path().filename();
            EXPECT_TRUE(bytes_of(kept) == bytes_of(seed)) << kept << "; update it: cp " << seed.path() << " " << kept;
            ++seeds;
        }
    }
    EXPECT_GT(seeds, 0U);
}

INSTANTIATE_TEST_SUITE_P(Each, FuzzCorpus, testing::ValuesIn(fuzzers()),
                         [](const auto& each) { return each.param.name; });

} // namespace
} // namespace scanloom::fuzz
