#include "tests/support/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <system_error>

namespace scanloom::test {

ChildProcess::ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           const std::filesystem::path& stderr_file) {
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    int pipe_ends[2];
    if (pipe2(pipe_ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe2");
    const int errors = open(stderr_file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    pid_ = fork();
    if (pid_ == 0) {
        dup2(pipe_ends[1], STDOUT_FILENO);
        dup2(errors, STDERR_FILENO);
        execv(argv[0], argv.data());
        _exit(127);
    }
    close(pipe_ends[1]);
    close(errors);
    stdout_ = pipe_ends[0];
    if (pid_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
}

ChildProcess::~ChildProcess() {
    if (!ended_) {
        signal(SIGKILL);
        wait();
    }
    close(stdout_);
}

std::optional<std::string> ChildProcess::read_line() {
    for (;;) {
        if (const auto end = buffered_.find('\n'); end != std::string::npos) {
            std::string line = buffered_.substr(0, end);
            buffered_.erase(0, end + 1);
            return line;
        }
        char bytes[4096];
        const ssize_t count = read(stdout_, bytes, sizeof bytes);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return std::nullopt;
        buffered_.append(bytes, static_cast<std::size_t>(count));
    }
}

bool ChildProcess::has_output_within(std::chrono::microseconds timeout) const {
    if (!buffered_.empty()) return true;
    constexpr std::int64_t kMicrosASecond = 1'000'000;
    const timespec time{static_cast<time_t>(timeout.count() / kMicrosASecond), timeout.count() % kMicrosASecond * 1000};
    pollfd output{stdout_, POLLIN, 0};
    return ppoll(&output, 1, &time, nullptr) > 0;
}

void ChildProcess::signal(int number) const { kill(pid_, number); }

int ChildProcess::wait() {
    if (ended_) return *ended_;
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    ended_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    return *ended_;
}

} // namespace scanloom::test
