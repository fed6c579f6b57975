#include "tests/support/child_process.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/lab/driven_log.hpp"

#include <boost/json/parse.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>

/// scanloom-lab as a program.
namespace scanloom::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

struct LabOutcome {
    int code = 0;
    std::string line;   ///< first of standard output
    std::string errors; ///< standard error
};

class Lab : public testing::Test {
protected:
    LabOutcome run(const std::vector<std::string>& arguments) {
        const auto errors = place_.path() / "errors";
        fs::remove(errors);
        ChildProcess lab(fs::path(SCANLOOM_PROGRAMS) / "scanloom-lab", arguments, errors);
        const auto line = lab.read_line();
        const int code = lab.wait();
        return {code, line.value_or(""), contents(errors)};
    }

    /// The files below a directory that are equal in each run.
    static std::map<std::string, std::string> lasting_files(const fs::path& directory) {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::recursive_directory_iterator(directory)) {
            if (!entry.is_regular_file() || entry.path().stem() == "times") continue;
            files[entry.path().lexically_relative(directory).string()] = contents(entry.path());
        }
        return files;
    }

    const TemporaryDirectory place_;
};

TEST_F(Lab, WritesTheSameReportTwiceWithAllItsPictures) {
    const auto first = place_.path() / "first";
    const auto second = place_.path() / "deep" / "second";
    const auto outcome = run({"experiment", "--quick", "--scans", "20", "--out", first.string()});
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    const auto summary = boost::json::parse(outcome.line);
    EXPECT_EQ(summary.at("report").as_string(), (first / "report.html").string());
    EXPECT_EQ(summary.at("scans").as_int64(), 20 * summary.at("runs").as_int64());
    EXPECT_TRUE(fs::exists(first / "times.md") && fs::exists(first / "times.html"));

    EXPECT_EQ(run({"experiment", "--quick", "--scans", "20", "--out", second.string()}).code, 0);
    const auto files = lasting_files(first);
    EXPECT_EQ(files, lasting_files(second));
    for (const auto& [file, text] : files) {
        if (!file.ends_with(".png")) continue;
        EXPECT_THAT(files.at("report.md"), HasSubstr("(" + file + ")"));
        EXPECT_THAT(files.at("report.html"), HasSubstr("\"" + file + "\""));
    }
    EXPECT_GT(files.size(), 4U);
}

TEST_F(Lab, WritesTheSameLandmarkReportTwice) {
    const auto first = place_.path() / "first";
    const auto second = place_.path() / "second";
    const auto outcome = run({"landmarks", "--seed", "5", "--out", first.string()});
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_EQ(boost::json::parse(outcome.line).at("report").as_string(), (first / "report.html").string());
    EXPECT_EQ(run({"landmarks", "--seed", "5", "--out", second.string()}).code, 0);
    const auto files = lasting_files(first);
    EXPECT_EQ(files, lasting_files(second));
    EXPECT_EQ(files.size(), 2U + 3U) << "the report's two forms, and a picture for each place";
    EXPECT_TRUE(fs::exists(first / "times.md") && fs::exists(first / "times.html"));
}

TEST_F(Lab, WritesTheSameLocalizationReportTwice) {
    auto driven = lab::driven_log();
    driven.log.scans.resize(100);
    driven.log.relations.resize(80);
    const auto log = (place_.path() / "room.clf").string();
    const auto relations = (place_.path() / "room.relations").string();
    std::ofstream(log) << carmen_text(driven.log);
    std::ofstream(relations) << relations_text(driven.log);
    const auto first = place_.path() / "first";
    const auto second = place_.path() / "second";
    const auto outcome = run({"localization", "--out", first.string(), log, relations});
    EXPECT_EQ(outcome.code, 0) << outcome.errors;
    EXPECT_EQ(boost::json::parse(outcome.line).at("logs").as_int64(), 1);
    EXPECT_EQ(run({"localization", "--out", second.string(), log, relations}).code, 0);
    const auto files = lasting_files(first);
    EXPECT_EQ(files, lasting_files(second));
    EXPECT_EQ(files.size(), 2U + 3U) << "the report's two forms, and three maps";
    EXPECT_THAT(files.at("report.md"), HasSubstr("| room | 100 | 50 | "));
    EXPECT_TRUE(fs::exists(first / "times.md") && fs::exists(first / "times.html"));
}

TEST_F(Lab, LogsAndRelationsThatCannotBeUsedExitWith1AndWriteNoReport) {
    auto driven = lab::driven_log();
    driven.log.scans.resize(30);
    const auto log = (place_.path() / "room.clf").string();
    const auto relations = (place_.path() / "room.relations").string();
    const auto others = (place_.path() / "others.relations").string();
    std::ofstream(log) << carmen_text(driven.log);
    std::ofstream(relations) << relations_text(driven.log);
    std::ofstream(others) << "9000 9001 1 0 0 0 0 0\n";
    const auto missing = (place_.path() / "missing").string();
    const auto out = place_.path() / "out";
    const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes{
        {{missing, relations}, "missing"},
        {{log, missing}, "missing"},
        {{relations, relations}, "room.relations"},
        {{log, others}, "others.relations: room: no relation of 1 can be used: 1 are outside the time"},
    };
    for (const auto& [files, hint] : mistakes) {
        const auto outcome = run({"localization", "--out", out.string(), files[0], files[1]});
        EXPECT_EQ(outcome.code, 1);
        EXPECT_EQ(outcome.line, "");
        EXPECT_THAT(outcome.errors, testing::StartsWith("scanloom-lab: "));
        EXPECT_THAT(outcome.errors, HasSubstr(hint));
        EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
        EXPECT_FALSE(fs::exists(out));
    }
}

TEST_F(Lab, AnInvalidRecordingExitsWith1AndWritesNoReport) {
    std::ofstream(place_.path() / "empty") << "";
    for (const char* file : {"empty", "missing"}) {
        const auto out = place_.path() / "out";
        const auto outcome = run({"landmarks", "--out", out.string(), "--capture", (place_.path() / file).string()});
        EXPECT_EQ(outcome.code, 1);
        EXPECT_EQ(outcome.line, "");
        EXPECT_THAT(outcome.errors, testing::StartsWith("scanloom-lab: "));
        EXPECT_THAT(outcome.errors, HasSubstr(file));
        EXPECT_FALSE(fs::exists(out));
    }
}

TEST_F(Lab, AnUnwritableFolderIsReportedAndExitsWith1) {
    std::ofstream(place_.path() / "file") << "not a directory";
    const auto outcome = run({"experiment", "--quick", "--out", (place_.path() / "file").string()});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.line, "");
    EXPECT_THAT(outcome.errors, testing::StartsWith("scanloom-lab: "));
    EXPECT_THAT(outcome.errors, HasSubstr("/file"));
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1);
}

TEST_F(Lab, WrongArgumentsExitWith2) {
    EXPECT_EQ(run({}).code, 2);
    EXPECT_EQ(run({"experiment"}).code, 2);
    EXPECT_EQ(run({"landmarks"}).code, 2);
    EXPECT_EQ(run({"localization", "--out", "d", "a.clf"}).code, 2);
    EXPECT_EQ(run({"--help"}).code, 0);
}

} // namespace
} // namespace scanloom::test
