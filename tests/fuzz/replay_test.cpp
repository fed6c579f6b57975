#include "tests/fuzz/write_corpus.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

using Fuzzer = int(const std::uint8_t* data, std::size_t size);
Fuzzer carmen_line_fuzzer;
Fuzzer carmen_log_fuzzer;
Fuzzer checkpoint_fuzzer;
Fuzzer config_fuzzer;
Fuzzer foxglove_fuzzer;
Fuzzer foxglove_request_fuzzer;
Fuzzer frame_decoder_fuzzer;
Fuzzer frame_tree_fuzzer;
Fuzzer hokuyo_fuzzer;
Fuzzer http_form_fuzzer;
Fuzzer http_json_fuzzer;
Fuzzer http_target_fuzzer;
Fuzzer ld06_fuzzer;
Fuzzer live_request_fuzzer;
Fuzzer log_codec_fuzzer;
Fuzzer log_file_fuzzer;
Fuzzer mcap_fuzzer;
Fuzzer messages_fuzzer;
Fuzzer ros_map_fuzzer;
Fuzzer ros_message_fuzzer;
Fuzzer rosbag_fuzzer;
Fuzzer rplidar_fuzzer;
Fuzzer store_key_fuzzer;
Fuzzer tokens_fuzzer;
Fuzzer ydlidar_fuzzer;

namespace scanloom::fuzz {
namespace {

struct Named {
    const char* name;
    Fuzzer* fuzzer;
};

const Named kFuzzers[] = {
    {"carmen_line", carmen_line_fuzzer},
    {"carmen_log", carmen_log_fuzzer},
    {"checkpoint", checkpoint_fuzzer},
    {"config", config_fuzzer},
    {"foxglove", foxglove_fuzzer},
    {"foxglove_request", foxglove_request_fuzzer},
    {"frame_decoder", frame_decoder_fuzzer},
    {"frame_tree", frame_tree_fuzzer},
    {"hokuyo", hokuyo_fuzzer},
    {"http_form", http_form_fuzzer},
    {"http_json", http_json_fuzzer},
    {"http_target", http_target_fuzzer},
    {"ld06", ld06_fuzzer},
    {"live_request", live_request_fuzzer},
    {"log_codec", log_codec_fuzzer},
    {"log_file", log_file_fuzzer},
    {"mcap", mcap_fuzzer},
    {"messages", messages_fuzzer},
    {"ros_map", ros_map_fuzzer},
    {"ros_message", ros_message_fuzzer},
    {"rosbag", rosbag_fuzzer},
    {"rplidar", rplidar_fuzzer},
    {"store_key", store_key_fuzzer},
    {"tokens", tokens_fuzzer},
    {"ydlidar", ydlidar_fuzzer},
};

const std::filesystem::path kCorpus = SCANLOOM_SOURCE_DIR "/tests/fuzz/corpus";

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

class FuzzCorpus : public testing::TestWithParam<Named> {};

/// Runs a fuzzer on every file of its corpus once. A fuzzer aborts on an input that violates a property.
TEST_P(FuzzCorpus, EveryFilePasses) {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(kCorpus / GetParam().name)) {
        SCOPED_TRACE(entry.path());
        const auto bytes = bytes_of(entry.path());
        EXPECT_EQ(GetParam().fuzzer(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), 0);
        ++files;
    }
    EXPECT_GT(files, 0U);
}

TEST(FuzzCorpora, EachHasItsFuzzer) {
    std::set<std::string> folders;
    for (const auto& entry : std::filesystem::directory_iterator(kCorpus)) folders.insert(entry.path().filename());
    std::set<std::string> fuzzers;
    for (const auto& named : kFuzzers) fuzzers.insert(named.name);
    EXPECT_EQ(folders, fuzzers);
}

/// A parser rejects a seed of an earlier format at once, so it would test nothing.
TEST(FuzzCorpora, AreOfTodaysFormats) {
    const std::filesystem::path folder = SCANLOOM_BUILD_DIR "/fuzz_corpus";
    std::filesystem::remove_all(folder);
    write_corpus(folder);
    for (const auto& seed : std::filesystem::recursive_directory_iterator(folder)) {
        if (!seed.is_regular_file()) continue;
        const auto kept = kCorpus / std::filesystem::relative(seed, folder);
        EXPECT_TRUE(bytes_of(kept) == bytes_of(seed)) << kept << "; update it: cp -r " << folder << "/. " << kCorpus;
    }
}

INSTANTIATE_TEST_SUITE_P(Each, FuzzCorpus, testing::ValuesIn(kFuzzers),
                         [](const auto& each) { return each.param.name; });

} // namespace
} // namespace scanloom::fuzz
