#include "robot_client/sources/pose_feed.hpp"

#include "common/net/await_tuple.hpp"
#include "robot_client/sources/pose_path.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/this_coro.hpp>
#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

namespace scanloom::robot {

namespace asio = boost::asio;

namespace {

constexpr std::size_t kLineBytesMax = 4096;
constexpr std::size_t kSkippedLinesShown = 5;

} // namespace

asio::awaitable<std::string> feed_poses(int descriptor, std::function<void(const StampedPose&)> on_pose,
                                        std::function<void(const std::string&)> note) {
    co_await asio::this_coro::throw_if_cancelled(false);
    asio::posix::stream_descriptor input(co_await asio::this_coro::executor, descriptor);
    std::string text;
    std::size_t skipped = 0;
    for (std::size_t line_number = 1;; ++line_number) {
        const auto [failed, size] =
            co_await asio::async_read_until(input, asio::dynamic_buffer(text, kLineBytesMax), '\n', kAwaitTuple);
        if (failed == asio::error::operation_aborted) co_return "";
        if (failed == asio::error::eof) co_return "the poses have ended";
        if (failed == asio::error::not_found) {
            co_return fmt::format("line {} of the poses is longer than {} bytes; the rest is not read", line_number,
                                  kLineBytesMax);
        }
        if (failed) co_return fmt::format("the poses cannot be read: {}", failed.message());
        const auto pose = read_pose_line(std::string_view(text).substr(0, size - 1));
        text.erase(0, size);
        if (!pose && ++skipped <= kSkippedLinesShown) {
            note(fmt::format("line {} of the poses is skipped: {}", line_number, pose.error().message));
        }
        if (pose && *pose) on_pose(**pose);
    }
}

int open_standard_input_again() noexcept {
    const int again = ::open("/dev/stdin", O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    return again >= 0 ? again : ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0); // a socket cannot be opened by its name
}

} // namespace scanloom::robot
