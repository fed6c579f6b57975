#include "tests/unit/tidy/source_rules.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

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
    EXPECT_THAT(including("lab/weaving.cpp", "\"core/mapping/projection.hpp\""), IsEmpty());
    EXPECT_THAT(including("lab/recording.cpp", "\"sim/world.hpp\""), IsEmpty());
    EXPECT_THAT(including("lab/weaving.cpp", "\"server/sessions/session.hpp\""), testing::SizeIs(1));
    EXPECT_THAT(including("lab/weaving.cpp", "\"robot_client/uplink/uplink.hpp\""), testing::SizeIs(1));
    EXPECT_THAT(including("server/tiles/map_image.cpp", "\"lab/weaving.hpp\""), testing::SizeIs(1));
    EXPECT_THAT(including("robot_client/app/main.cpp", "\"lab/weaving.hpp\""), testing::SizeIs(1));
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

TEST(SourceRules, SourceTreeFollowsTheRules) {
    const fs::path root = SOURCE_TREE;
    std::size_t files = 0;
    for (auto entry = fs::recursive_directory_iterator(root); entry != fs::end(entry); ++entry) {
        if (entry->is_directory() && is_foreign(entry->path())) entry.disable_recursion_pending();
        if (!entry->is_regular_file() || !is_source(entry->path())) continue;
        const std::string path = entry->path().lexically_relative(root).generic_string();
        for (const auto& complaint : complaints_about(path, contents(entry->path()))) ADD_FAILURE() << complaint;
        ++files;
    }
    EXPECT_GT(files, 50U) << "too few source files in " << root;
}

} // namespace
} // namespace scanloom::tidy
