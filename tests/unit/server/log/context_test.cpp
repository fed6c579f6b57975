#include "server/log/context.hpp"

#include <boost/json/parse.hpp>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace scanloom::log {
namespace {

class JsonFormatterTest : public testing::Test {
protected:
    void SetUp() override {
        auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(text_);
        sink->set_formatter(std::make_unique<JsonFormatter>());
        spdlog::set_default_logger(std::make_shared<spdlog::logger>("test", std::move(sink)));
    }
    void TearDown() override { spdlog::set_default_logger(earlier_); }

    /// Every line, which must be an object of JSON by itself.
    [[nodiscard]] std::vector<boost::json::object> lines() const {
        std::vector<boost::json::object> parsed;
        std::istringstream in(text_.str());
        for (std::string line; std::getline(in, line);) parsed.push_back(boost::json::parse(line).as_object());
        return parsed;
    }

    std::ostringstream text_;
    std::shared_ptr<spdlog::logger> earlier_ = spdlog::default_logger();
};

TEST_F(JsonFormatterTest, WritesTheContext) {
    info({.session = "lab", .robot = "r1", .peer = "10.0.0.7:5000"}, "robot '{}' came", "r1");
    const auto line = lines().at(0);
    EXPECT_EQ(line.at("level"), "info");
    EXPECT_EQ(line.at("message"), "robot 'r1' came");
    EXPECT_EQ(line.at("session"), "lab");
    EXPECT_EQ(line.at("robot"), "r1");
    EXPECT_EQ(line.at("peer"), "10.0.0.7:5000");
}

TEST_F(JsonFormatterTest, OmitsEmptyFields) {
    warn({.session = "lab"}, "no checkpoint");
    spdlog::error("the store failed");
    EXPECT_EQ(lines().at(0).size(), 4U);
    EXPECT_EQ(lines().at(1).size(), 3U) << "the context of the line before is over";
    EXPECT_EQ(lines().at(1).at("level"), "error");
}

TEST_F(JsonFormatterTest, WritesTheTimeInUtc) {
    JsonFormatter formatter;
    const spdlog::log_clock::time_point time{std::chrono::milliseconds(1'700'000'000'042)};
    spdlog::memory_buf_t text;
    formatter.format(spdlog::details::log_msg(time, {}, "test", spdlog::level::info, "hello"), text);
    const auto line = boost::json::parse({text.data(), text.size()});
    EXPECT_EQ(line.at("time"), "2023-11-14T22:13:20.042Z");
}

TEST_F(JsonFormatterTest, IsOneLineForAnyMessage) {
    info({.session = "\"},{\"a\":\"b"}, "two\nlines, \"quotes\" and \\");
    ASSERT_EQ(lines().size(), 1U);
    EXPECT_EQ(lines()[0].at("message"), "two\nlines, \"quotes\" and \\");
    EXPECT_EQ(lines()[0].at("session"), "\"},{\"a\":\"b");
}

} // namespace
} // namespace scanloom::log
