#pragma once

#include "robot_client/app/options.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace scanloom::robot {

/// Options of the robot's program from words of its command line, the environment and a file.
class Options : public testing::Test {
protected:
    std::variant<RobotOptions, GroundTruthOptions, InfoOptions, LidarsOptions, Leave>
    parse(std::vector<std::string> words) {
        std::vector<const char*> argv{"scanloom-robot"};
        for (const auto& word : words) argv.push_back(word.c_str());
        return parse_options(static_cast<int>(argv.size()), argv.data());
    }

    RobotOptions parsed(const std::vector<std::string>& words) {
        auto result = parse(words);
        if (const auto* leave = std::get_if<Leave>(&result)) {
            ADD_FAILURE() << leave->text;
            return {};
        }
        return std::get<RobotOptions>(result);
    }

    Leave left(const std::vector<std::string>& words) {
        auto result = parse(words);
        if (const auto* leave = std::get_if<Leave>(&result)) return *leave;
        ADD_FAILURE() << "the options were accepted";
        return {};
    }

    void set(const char* name, const char* value) {
        setenv(name, value, 1);
        set_.emplace_back(name);
    }

    std::string file(std::string_view text) {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        file_ = std::filesystem::path(testing::TempDir()) / fmt::format("scanloom_options_{}.toml", test->name());
        std::ofstream(file_) << text;
        return file_.string();
    }

    void TearDown() override {
        for (const auto& name : set_) unsetenv(name.c_str());
        if (!file_.empty()) std::filesystem::remove(file_);
    }

private:
    std::vector<std::string> set_;
    std::filesystem::path file_;
};

} // namespace scanloom::robot
