#pragma once

#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/json/value.hpp>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace scanloom::test {

inline const std::filesystem::path kRealData = std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data";

/// A server and robots that stream to it.
class ProgramsTest : public testing::Test {
protected:
    /// Streams a whole source into a session, with these settings if it is new.
    void stream(const std::string& session, const std::string& cell_size, const std::vector<std::string>& source) {
        std::vector<std::string> arguments{"--server", server_.robot_address(), "--session", session, "--robot",
                                           "r",        "--cell-size",           cell_size};
        arguments.insert(arguments.end(), source.begin(), source.end());
        ChildProcess robot(program("scanloom-robot"), arguments, place_.path() / "robot");
        static_cast<void>(robot.read_line());
        ASSERT_EQ(robot.wait(), 0);
    }

    /// Streams 300 scans, 10 per second.
    /// @param speed  times as fast as that; "0": as fast as possible, so that the server may store many in one write
    void simulate(const std::string& session, const std::string& cell_size, const std::string& speed = "0") {
        stream(session, cell_size,
               {"simulate", "--world", "office", "--seed", "5", "--speed", speed, "--scans", "300", "--noise",
                "gaussian"});
    }

    /// Returns the digest of each layer.
    [[nodiscard]] boost::json::value layers(const std::string& session, const std::string& query = "") const {
        return server_.get_json("/api/v1/sessions/" + session + "/digest" + query).at("layers");
    }

    [[nodiscard]] std::filesystem::path save(const std::string& target, const std::string& name) const {
        const auto answer = server_.get(target);
        EXPECT_EQ(answer.status, 200U) << answer.body;
        const auto path = place_.path() / name;
        std::ofstream(path, std::ios::binary) << answer.body;
        return path;
    }

    TemporaryDirectory place_;
    RunningServer server_{place_.path() / "store", place_.path() / "log"};
};

} // namespace scanloom::test
