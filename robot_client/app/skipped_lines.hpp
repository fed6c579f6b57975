#pragma once

#include "robot_client/app/progress.hpp"
#include "robot_client/sources/line_reader.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <utility>

namespace scanloom::robot {

/// Prints the first lines of a file that were skipped, and at the end the number of the others.
class SkippedLines {
public:
    SkippedLines(std::string file, Console& console) : file_(std::move(file)), console_(console) {}
    SkippedLines(const SkippedLines&) = delete;
    SkippedLines& operator=(const SkippedLines&) = delete;
    ~SkippedLines() {
        if (count_ > kShown) console_.note(fmt::format("{}: {} more lines skipped", file_, count_ - kShown));
    }

    void add(const SkippedLine& line) {
        if (++count_ > kShown) return;
        console_.note(fmt::format("{}:{}: skipped: {}", file_, line.line_number, line.reason));
    }

private:
    static constexpr std::size_t kShown = 5;

    const std::string file_;
    Console& console_;
    std::size_t count_ = 0;
};

} // namespace scanloom::robot
