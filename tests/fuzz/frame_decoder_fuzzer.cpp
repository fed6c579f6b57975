#include "common/wire/frame_decoder.hpp"
#include "tests/fuzz/check.hpp"
#include "tests/support/plain_frame.hpp"

#include <algorithm>
#include <cstring>

namespace scanloom::wire {
namespace {

constexpr std::size_t kFrameBytesMaxHere = 4096;

struct Outcome {
    std::vector<std::string> bodies;
    bool failed = false;
};

/// Passes the stream in pieces whose sizes are the bytes of `sizes` in turn; 0 means the rest.
Outcome decode_stream(std::string_view stream, std::string_view sizes) {
    FrameDecoder decoder(kFrameBytesMaxHere);
    Outcome outcome;
    std::size_t turn = 0;
    while (!outcome.failed && !stream.empty()) {
        const std::size_t wanted = sizes.empty() ? 0 : static_cast<unsigned char>(sizes[turn++ % sizes.size()]);
        const std::size_t size = wanted == 0 ? stream.size() : std::min(wanted, stream.size());
        std::memcpy(decoder.prepare(size).data(), stream.data(), size);
        decoder.commit(size);
        stream.remove_prefix(size);
        auto body = decoder.next();
        for (; body && *body; body = decoder.next()) outcome.bodies.emplace_back(**body);
        outcome.failed = !body;
    }
    return outcome;
}

} // namespace
} // namespace scanloom::wire

/// Input: a count, that many sizes of pieces, then the stream.
SCANLOOM_FUZZER(frame_decoder)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    std::string_view input(reinterpret_cast<const char*>(data), size);
    if (input.empty()) return 0;
    const auto count = std::min<std::size_t>(static_cast<unsigned char>(input[0]) % 16U, input.size() - 1);
    const auto sizes = input.substr(1, count);
    const auto stream = input.substr(1 + count);

    const auto whole = wire::decode_stream(stream, {});
    const auto pieces = wire::decode_stream(stream, sizes);
    fuzz::check(whole.failed == pieces.failed, "whether a stream fails does not depend on how it is split");
    fuzz::check(whole.bodies == pieces.bodies, "any split of the bytes yields the same bodies");
    if (!whole.failed) {
        std::string again;
        for (const auto& body : whole.bodies) testing_support::append_plain_frame(again, body);
        fuzz::check(stream.substr(0, again.size()) == again, "framing the bodies reproduces the stream");
    }
    return 0;
}
