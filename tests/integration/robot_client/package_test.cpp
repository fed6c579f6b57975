#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

/// The client as robots' own programs use it: installed, found by find_package(scanloom), linked.
namespace scanloom::robot {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::Not;
using testing::StartsWith;

const fs::path kTree = SCANLOOM_SOURCE_DIR;
const fs::path kExample = kTree / "robot_client/examples/send_scan";

std::string contents(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

class ClientPackage : public testing::Test {
protected:
    /// Returns the lines that the program prints; if it fails, fails the test with its whole output.
    std::vector<std::string> run(const fs::path& program, const std::vector<std::string>& arguments) {
        const fs::path errors = here_ / "errors";
        fs::remove(errors);
        test::ChildProcess process(program, arguments, errors);
        std::vector<std::string> lines;
        while (auto line = process.read_line()) lines.push_back(std::move(*line));
        const int code = process.wait();
        EXPECT_EQ(code, 0) << program << " failed:\n" << testing::PrintToString(lines) << '\n' << contents(errors);
        return lines;
    }

    void install() {
        run(CMAKE, {"--install", SCANLOOM_BUILD_DIR, "--component", "client", "--prefix", prefix_.string()});
    }

    /// Configures and builds a project outside this tree, like a robot's own.
    void build(const fs::path& project, const std::string& compiler) {
        run(CMAKE,
            {"-S", project.string(), "-B", built_.string(), "-G", GENERATOR, "-DCMAKE_PREFIX_PATH=" + prefix_.string(),
             "-DCMAKE_CXX_COMPILER=" + compiler, std::string("-DCMAKE_CXX_COMPILER_LAUNCHER=") + COMPILER_LAUNCHER,
             std::string("-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror ") + SANITIZER_FLAGS});
        if (!HasFailure()) run(CMAKE, {"--build", built_.string()});
    }

    void expect_a_scan_sent_by_the_example_built_with(const std::string& compiler) {
        install();
        build(kExample, compiler);
        if (HasFailure()) return;
        const test::RunningServer server(here_ / "store", here_ / "log");
        EXPECT_THAT(run(built_ / "send_scan", {server.robot_address()}), Contains("1 scans are stored"));
        const auto session = server.get_json("/api/v1/sessions/example");
        EXPECT_EQ(session.at("scans").to_number<int>(), 1);
        const auto& robot = session.at("robots").at(0);
        EXPECT_EQ(robot.at("name").as_string(), "cpp");
        EXPECT_EQ(robot.at("last_seq").to_number<int>(), 1);
    }

    TemporaryDirectory directory_;
    fs::path here_ = directory_.path();
    fs::path prefix_ = here_ / "prefix";
    fs::path built_ = here_ / "built";
};

TEST_F(ClientPackage, AProgramLinkedToItSendsAScan) { expect_a_scan_sent_by_the_example_built_with(COMPILER); }

TEST_F(ClientPackage, AProgramBuiltWithClangSendsAScan) {
    const std::string clang = CLANG;
    if (clang.empty() || *SANITIZER_FLAGS != '\0') {
        GTEST_SKIP() << "needs clang++-14 (apt-get install clang-14; configure again) and a build without sanitizers";
    }
    expect_a_scan_sent_by_the_example_built_with(clang);
}

TEST_F(ClientPackage, APluginCanLinkIt) {
    install();
    const fs::path project = here_ / "project";
    fs::create_directories(project);
    std::ofstream(project / "CMakeLists.txt") << "cmake_minimum_required(VERSION 3.25)\nproject(plugin LANGUAGES CXX)\n"
                                                 "find_package(scanloom REQUIRED)\n"
                                              << "add_library(plugin MODULE " << kExample / "send_scan.cpp"
                                              << ")\n"
                                              << "target_link_libraries(plugin PRIVATE scanloom::client)\n";
    build(project, COMPILER);
    EXPECT_TRUE(fs::exists(built_ / "libplugin.so"));
}

TEST_F(ClientPackage, ExportsOnlyItsOwnNames) {
    install();
    std::size_t names = 0;
    for (const auto& line : run(NM, {"--extern-only", "--defined-only", "--format=just-symbols",
                                     (prefix_ / LIBDIR / "libscanloom_client.a").string()})) {
        if (line.empty() || line.ends_with(':')) continue; // names of the archive and the object
        EXPECT_THAT(line, testing::AnyOf(StartsWith("_ZN8scanloom"), StartsWith("_ZNK8scanloom")));
        ++names;
    }
    EXPECT_GT(names, 0U);
}

TEST_F(ClientPackage, ContainsNoPathOfTheBuildTree) {
    install();
    std::size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(prefix_)) {
        if (!entry.is_regular_file() || entry.path().extension() == ".a") continue;
        ++files;
        const std::string text = contents(entry.path());
        for (const auto& foreign : {kTree.string(), std::string(SCANLOOM_BUILD_DIR), std::string("-Wshadow"),
                                    std::string("scanloom_options"), std::string("#include \"")}) {
            EXPECT_THAT(text, Not(testing::HasSubstr(foreign))) << entry.path();
        }
    }
    EXPECT_GE(files, 10U) << "the package's files are missing";
}

TEST_F(ClientPackage, ARobotBuildNeedsNoServerSources) {
    run(CMAKE, {"-S", kTree.string(), "-B", built_.string(), "-G", GENERATOR, "-DSCANLOOM_SERVER=OFF",
                std::string("-DCMAKE_CXX_COMPILER=") + COMPILER, "-DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON",
                "-DCMAKE_DISABLE_FIND_PACKAGE_RocksDB=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_prometheus-cpp=ON",
                "-DCMAKE_DISABLE_FIND_PACKAGE_spdlog=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON"});
    if (HasFailure()) return;
    const auto targets = run(CMAKE, {"--build", built_.string(), "--target", "help"});
    EXPECT_THAT(targets, Contains(testing::HasSubstr("scanloom-robot")));
    EXPECT_THAT(targets, Contains(testing::HasSubstr("scanloom_client")));
    for (const auto* name : {"scanloom-server", "scanloom-lab", "server_http", "web:", "_test"}) {
        EXPECT_THAT(targets, Not(Contains(testing::HasSubstr(name))));
    }
}

} // namespace
} // namespace scanloom::robot
