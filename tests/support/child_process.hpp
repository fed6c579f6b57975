#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::test {

/// A program of the build under test, started with its standard output piped here and its standard
/// error appended to a file. Killed, if it still runs, when this goes out of scope.
class ChildProcess {
public:
    ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                 const std::filesystem::path& stderr_file);
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Waits for the next line of its standard output; nothing at its end.
    [[nodiscard]] std::optional<std::string> read_line();

    /// Whether something came on its standard output, or it ended, before so much time had passed.
    [[nodiscard]] bool has_output_within(std::chrono::microseconds patience) const;

    [[nodiscard]] pid_t id() const noexcept { return pid_; }

    void signal(int number) const;

    /// Waits for its end. @return the exit code, or minus the signal that ended it.
    int wait();

private:
    pid_t pid_ = -1;
    int stdout_ = -1;
    std::string buffered_;
    std::optional<int> ended_;
};

} // namespace scanloom::test
