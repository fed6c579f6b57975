#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"
#include "tests/support/room_scans.hpp"

#include <benchmark/benchmark.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include <string>
#include <thread>

// The lower bound for any server: frames of one scan of 684 beams over TCP on this machine, read in pieces of 64 KiB by
// one thread from another that sends as fast as it can. Items are frames; CPU is that of the reader alone.

namespace scanloom::wire {
namespace {

using Tcp = boost::asio::ip::tcp;

constexpr std::size_t kReadBytes = 64 << 10;

std::string frames_of_scans() {
    std::string frames;
    for (Scan& scan : testing_support::room_scans(100)) encode(ScanBatch{{std::move(scan)}}, frames);
    return frames;
}

/// A connection whose other end sends frames until it is closed.
class Stream {
public:
    Stream() : socket_(context_) {
        Tcp::acceptor acceptor(context_, {boost::asio::ip::address_v4::loopback(), 0});
        socket_.connect(acceptor.local_endpoint());
        sender_ = std::thread([sender = acceptor.accept()]() mutable {
            const std::string frames = frames_of_scans();
            boost::system::error_code closed;
            while (!closed) boost::asio::write(sender, boost::asio::buffer(frames), closed);
        });
    }
    ~Stream() {
        socket_.close();
        sender_.join();
    }
    Stream(const Stream&) = delete;
    Stream& operator=(const Stream&) = delete;

    /// Returns the body of the next frame.
    std::string_view next() {
        for (;;) {
            if (const auto body = decoder_.next().value()) return *body;
            const auto room = decoder_.prepare(kReadBytes);
            decoder_.commit(socket_.read_some(boost::asio::buffer(room.data(), room.size())));
        }
    }

private:
    boost::asio::io_context context_;
    Tcp::socket socket_;
    FrameDecoder decoder_{kFrameBytesMax};
    std::thread sender_;
};

void ReadFrames(benchmark::State& state) {
    Stream stream;
    for (auto _ : state) benchmark::DoNotOptimize(stream.next());
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(ReadFrames)->Unit(benchmark::kMicrosecond);

void ReadAndParseFrames(benchmark::State& state) {
    Stream stream;
    for (auto _ : state) benchmark::DoNotOptimize(decode(stream.next()));
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(ReadAndParseFrames)->Unit(benchmark::kMicrosecond);

} // namespace
} // namespace scanloom::wire
