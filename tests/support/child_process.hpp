#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::test {

/// Runs a program of the build under test with its standard output piped to this process and its standard error
/// appended to a file. The destructor kills the program if it still runs.
class ChildProcess {
public:
    ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                 const std::filesystem::path& stderr_file);
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Waits for the next line of the program's standard output. @return nullopt at the end of the output.
    [[nodiscard]] std::optional<std::string> read_line();

    /// @return whether the program wrote to its standard output or ended within `timeout`
    [[nodiscard]] bool has_output_within(std::chrono::microseconds timeout) const;

    [[nodiscard]] pid_t id() const noexcept { return pid_; }

    void signal(int number) const;

    /// Waits until the program ends. @return the exit code, or minus the signal that ended it.
    int wait();

private:
    pid_t pid_ = -1;
    int stdout_ = -1;
    std::string buffered_;
    std::optional<int> ended_;
};

} // namespace scanloom::test
