#include "common/app/standard_streams.hpp"

#include "tests/support/temporary_directory.hpp"
#include "tests/support/unread_pipe.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/socket.h>

#include <array>
#include <fstream>
#include <iterator>

namespace scanloom {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Both ends of a terminal whose output is not shown; TERM supports overwriting lines.
class Terminal {
public:
    Terminal() {
        setenv("TERM", "xterm", 1);
        screen_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
        if (screen_ < 0 || grantpt(screen_) != 0 || unlockpt(screen_) != 0) throw std::runtime_error("no terminal");
        program_ = open(ptsname(screen_), O_WRONLY | O_NOCTTY | O_CLOEXEC);
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;
    ~Terminal() {
        close(program_);
        close(screen_);
    }
    [[nodiscard]] int program() const noexcept { return program_; }

    [[nodiscard]] std::string read_all() const {
        std::string all;
        char bytes[4096];
        for (ssize_t count = 0; (count = read(screen_, bytes, sizeof bytes)) > 0;) {
            all.append(bytes, static_cast<std::size_t>(count));
        }
        return all;
    }

private:
    int screen_ = -1;
    int program_ = -1;
};

class StandardErrorTest : public testing::Test {
protected:
    ~StandardErrorTest() override { close(descriptor_); }

    TemporaryDirectory place_;
    test::UnreadPipe pipe_{place_.path() / "pipe"};
    const int descriptor_ = open(pipe_.path().c_str(), O_WRONLY | O_CLOEXEC);
    StandardError error_{descriptor_};
};

TEST_F(StandardErrorTest, WritesLinesUnchanged) {
    error_.write("one\n");
    error_.write("two\n");
    EXPECT_EQ(pipe_.empty(), "one\ntwo\n");
    EXPECT_FALSE(error_.is_terminal());
}

TEST_F(StandardErrorTest, DoesNotWaitForAFullPipeAndReportsLostLinesOnce) {
    pipe_.fill();
    for (int i = 0; i < 1000; ++i) error_.write("lost\n");
    EXPECT_THAT(pipe_.empty(), Not(HasSubstr("lost")));
    error_.write("two\n");
    error_.write("three\n");
    EXPECT_EQ(pipe_.empty(), "1000 lines were dropped because they were not read\ntwo\nthree\n");
    pipe_.fill();
    error_.write("lost\n");
    (void)pipe_.empty();
    error_.write("four\n");
    EXPECT_EQ(pipe_.empty(), "1 line was dropped because it was not read\nfour\n");
}

TEST_F(StandardErrorTest, EndsACutLineBeforeTheNext) {
    error_.write(std::string(20'000, 'a') + '\n');
    EXPECT_THAT(pipe_.empty(), AllOf(StartsWith("aaa"), Not(HasSubstr("\n"))));
    error_.write("next\n");
    EXPECT_EQ(pipe_.empty(), "\n1 line was dropped because it was not read\nnext\n");
}

TEST_F(StandardErrorTest, DoesNotChangeTheSharedDescriptor) {
    error_.write("one\n");
    EXPECT_EQ(fcntl(descriptor_, F_GETFL) & O_NONBLOCK, 0);
}

TEST(StandardError, AppendsToASharedFile) {
    const TemporaryDirectory place;
    const int file = open((place.path() / "log").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    {
        StandardError error(file);
        ASSERT_EQ(::write(file, "another's\n", 10), 10);
        error.write(std::string(20'000, 'a') + "\n");
    }
    close(file);
    std::ifstream in(place.path() / "log");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "another's\n" + std::string(20'000, 'a') + "\n");
}

TEST(StandardError, DoesNotWaitForASocketThatIsNotRead) {
    std::array<int, 2> ends{}; // as a service manager gives them
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
    StandardError error(ends[0]);
    for (int i = 0; i < 10'000; ++i) error.write(std::string(99, 'a') + "\n");
    std::array<char, 100> line{};
    EXPECT_EQ(read(ends[1], line.data(), line.size()), 100);
    close(ends[0]);
    close(ends[1]);
}

TEST(StandardError, DoesNotWaitForAStoppedTerminal) {
    const Terminal terminal;
    StandardError error(terminal.program());
    EXPECT_TRUE(error.is_terminal());
    for (int i = 0; i < 10'000; ++i) error.write("a line of some length\n");
    (void)terminal.read_all();
    error.write("next\n");
    EXPECT_THAT(terminal.read_all(),
                AllOf(HasSubstr(" lines were dropped because they were not read\r\n"), EndsWith("next\r\n")));
}

} // namespace
} // namespace scanloom
