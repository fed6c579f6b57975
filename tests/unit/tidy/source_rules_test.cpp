#include "tests/unit/tidy/source_rules.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>

namespace scanloom::tidy {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> including(std::string_view path, std::string_view header) {
    return complaints_about(path, fmt::format("int first_line;\n#include {}\n", header));
}

TEST(SourceRules, ServerAndRobotMustNotIncludeEachOther) {
    EXPECT_THAT(including("server/app/main.cpp", "\"sim/world.hpp\""),
                ElementsAre("server/app/main.cpp:2: server/app may not include sim/world.hpp"));
    EXPECT_THAT(including("robot_client/app/main.cpp", "\"core/grid/cell.hpp\""),
                ElementsAre(HasSubstr("may not include core/grid/cell.hpp")));
}

TEST(SourceRules, CommonMustNotIncludeServerOrRobot) {
    EXPECT_THAT(including("common/wire/messages.cpp", "\"core/grid/cell.hpp\""), testing::SizeIs(1));
    EXPECT_THAT(including("common/scan/scan.cpp", "\"sim/world.hpp\""), testing::SizeIs(1));
    EXPECT_THAT(including("common/scan/scan.cpp", "\"common/wire/messages.hpp\""), testing::SizeIs(1));
}

TEST(SourceRules, LabMayIncludeServerAndRobotButMustNotBeIncluded) {
    EXPECT_THAT(including("lab/integrate_recording.cpp", "\"core/mapping/projection.hpp\""), IsEmpty());
    EXPECT_THAT(including("lab/recording.cpp", "\"sim/world.hpp\""), IsEmpty());
    EXPECT_THAT(including("lab/estimated_trajectory.cpp", "\"core/slam/trajectory_estimator.hpp\""), IsEmpty());
    EXPECT_THAT(including("lab/integrate_recording.cpp", "\"server/sessions/session.hpp\""), testing::SizeIs(1));
    EXPECT_THAT(including("lab/integrate_recording.cpp", "\"robot_client/spool/spool.hpp\""), testing::SizeIs(1));
    EXPECT_THAT(including("server/tiles/map_image.cpp", "\"lab/integrate_recording.hpp\""), testing::SizeIs(1));
    EXPECT_THAT(including("robot_client/app/main.cpp", "\"lab/integrate_recording.hpp\""), testing::SizeIs(1));
}

TEST(SourceRules, LoadMustNotIncludeTheServerNorBeIncluded) {
    EXPECT_THAT(including("load/net/robot.cpp", "\"load/core/measured_client.hpp\""), IsEmpty());
    EXPECT_THAT(including("load/core/measured_client.cpp", "\"load/net/robot.hpp\""), testing::SizeIs(1));
    EXPECT_THAT(including("load/app/run.cpp", "\"server/sessions/session.hpp\""), testing::SizeIs(1));
    EXPECT_THAT(including("robot_client/app/main.cpp", "\"load/app/run.hpp\""), testing::SizeIs(1));
}

TEST(SourceRules, ProductionCodeMustNotIncludeTests) {
    EXPECT_THAT(including("server/store/log_file.cpp", "\"tests/support/memory_scan_log.hpp\""), testing::SizeIs(1));
}

TEST(SourceRules, ProtobufIsLimitedToWire) {
    EXPECT_THAT(including("common/wire/messages.cpp", "\"scanloom/v1/frame.pb.h\""), IsEmpty());
    EXPECT_THAT(including("server/ingest/link.cpp", "\"scanloom/v1/frame.pb.h\""),
                ElementsAre(HasSubstr("only common/wire may")));
    EXPECT_THAT(including("server/store/record.cpp", "<google/protobuf/arena.h>"), testing::SizeIs(1));
}

TEST(SourceRules, OpenCvIsLimitedToTiles) {
    EXPECT_THAT(including("server/tiles/png.cpp", "<opencv2/imgcodecs.hpp>"), IsEmpty());
    EXPECT_THAT(including("server/http/tile.cpp", "<opencv2/imgcodecs.hpp>"), testing::SizeIs(1));
}

TEST(SourceRules, PureFoldersMustNotIncludeSystemHeaders) {
    for (const auto* header : {"<chrono>", "<thread>", "<mutex>", "<fstream>", "<iostream>", "<sys/socket.h>",
                               "<unistd.h>", "<spdlog/spdlog.h>", "<boost/asio/ip/tcp.hpp>", "<rocksdb/db.h>"}) {
        EXPECT_THAT(including("core/mapping/cell.cpp", header), testing::SizeIs(1)) << header;
        EXPECT_THAT(including("common/geometry/pose2.hpp", header), Not(IsEmpty())) << header;
    }
    EXPECT_THAT(including("core/mapping/cell.cpp", "<vector>"), IsEmpty());
    EXPECT_THAT(including("server/sessions/session.cpp", "<thread>"), IsEmpty());
    EXPECT_THAT(including("server/live/core/event_encoder.cpp", "<chrono>"), testing::SizeIs(1));
    EXPECT_THAT(including("server/live/viewer.cpp", "<chrono>"), IsEmpty());
    EXPECT_THAT(including("common/link/server_protocol.cpp", "<chrono>"), IsEmpty());
    EXPECT_THAT(including("common/link/server_protocol.cpp", "<mutex>"), testing::SizeIs(1));
    EXPECT_THAT(complaints_about("common/link/link.cpp", "const auto now = std::chrono::steady_clock::now();\n"),
                testing::SizeIs(1));
}

TEST(SourceRules, NewFolderNeedsARow) {
    EXPECT_THAT(including("server/gossip/peer.cpp", "<vector>"), ElementsAre(HasSubstr("has no row")));
}

TEST(SourceRules, HeadersMustStartWithPragmaOnce) {
    EXPECT_THAT(complaints_about("tests/support/a.hpp", "#include <vector>\n"), ElementsAre(HasSubstr("#pragma once")));
    EXPECT_THAT(complaints_about("tests/support/a.hpp", "#pragma once\n"), IsEmpty());
    EXPECT_THAT(complaints_about("tests/support/a.cpp", "#include <vector>\n"), IsEmpty());
}

TEST(SourceRules, SleepingTestsAndPostponedWorkAreRefused) {
    EXPECT_THAT(complaints_about("tests/unit/a_test.cpp", "std::this_thread::sleep_"
                                                          "for(1s);\n"),
                testing::SizeIs(1));
    EXPECT_THAT(complaints_about("tests/e2e/a.test.mjs", "await page.waitFor"
                                                         "Timeout(100);\n"),
                testing::SizeIs(1));
    EXPECT_THAT(complaints_about("tests/unit/a_test.cpp", "TEST(A, DISABLED"
                                                          "_B)\n"),
                testing::SizeIs(1));
    EXPECT_THAT(complaints_about("web/src/main.ts", "a();\n// TO"
                                                    "DO: b\n"),
                ElementsAre(HasSubstr("web/src/main.ts:2")));
    EXPECT_THAT(complaints_about("cmake/a.cmake", "# FIX"
                                                  "ME\n"),
                testing::SizeIs(1));
}

bool is_source(const fs::path& path) {
    const std::vector<std::string> endings = {".cpp",  ".hpp", ".proto", ".ts", ".mjs", ".js",  ".css",
                                              ".html", ".sh",  ".cmake", ".md", ".yml", ".yaml"};
    return std::ranges::find(endings, path.extension().string()) != endings.end() ||
           path.filename() == "CMakeLists.txt" || path.filename() == "scanloom" || path.filename() == "Dockerfile";
}

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns whether a folder contains generated or downloaded files.
bool is_foreign(const fs::path& folder) {
    const std::string name = folder.filename().string();
    return name == "build" || name == "dist" || name == "node_modules" || name.starts_with('.');
}

/// Calls visit(path, text) for each source file of the project.
template <class Visit>
void for_each_source(Visit visit) {
    const fs::path root = SCANLOOM_SOURCE_DIR;
    for (auto entry = fs::recursive_directory_iterator(root); entry != fs::end(entry); ++entry) {
        if (entry->is_directory() && is_foreign(entry->path())) entry.disable_recursion_pending();
        if (!entry->is_regular_file() || !is_source(entry->path())) continue;
        visit(entry->path().lexically_relative(root).generic_string(), contents(entry->path()));
    }
}

TEST(SourceRules, SourceTreeFollowsTheRules) {
    std::size_t files = 0;
    for_each_source([&](const std::string& path, const std::string& text) {
        for (const auto& complaint : complaints_about(path, text)) ADD_FAILURE() << complaint;
        ++files;
    });
    EXPECT_GT(files, 50U) << "too few source files in " << SCANLOOM_SOURCE_DIR;
}

/// Returns how often a word occurs in a lower-case text. A word in quotes, such as the JSON member "woven", or before a
/// colon does not count.
std::size_t uses_of(std::string_view word, std::string_view text) {
    constexpr std::string_view kPartOfName = "abcdefghijklmnopqrstuvwxyz_\"':";
    std::size_t uses = 0;
    for (auto at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
        const bool begins = at == 0 || kPartOfName.find(text[at - 1]) == std::string_view::npos;
        const auto end = at + word.size();
        if (begins && (end == text.size() || kPartOfName.find(text[end]) == std::string_view::npos)) ++uses;
    }
    return uses;
}

TEST(SourceRules, DiscouragedWordsAreRare) {
    EXPECT_EQ(uses_of("told", "told, he told; told_ and retold and \"told\" do not count"), 2U);
    std::map<std::string, std::size_t> uses{{"told", 0},  {"whoever", 0},  {"nobody", 0},  {"anybody", 0},
                                            {"anew", 0},  {"amiss", 0},    {"in vain", 0}, {"woven", 0},
                                            {"hears", 0}, {"of which", 0}, {"beside", 0}};
    for_each_source([&](const std::string& path, const std::string& text) {
        if (path == "CHANGELOG.md" || path.starts_with("tests/unit/tidy/")) return;
        std::string lower = text;
        std::ranges::transform(lower, lower.begin(),
                               [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        for (auto& [word, count] : uses) count += uses_of(word, lower);
    });
    for (const auto& [word, count] : uses) EXPECT_LT(count, 20U) << word << ": tests/hooks/words.txt has better words";
}

} // namespace
} // namespace scanloom::tidy
