#include "robot_client/lidars/ld06_packet.hpp"
#include "robot_client/lidars/ld06_turns.hpp"
#include "tests/fuzz/server_check.hpp"

#include <algorithm>

namespace scanloom::robot {
namespace {

struct Outcome {
    std::vector<Ld06Packet> packets;
    Ld06Counts counts;
    std::vector<LidarTurn> turns;

    friend bool operator==(const Outcome&, const Outcome&) = default;
};

using Bytes = std::span<const std::uint8_t>;

/// Passes the stream in pieces whose sizes are the bytes of `sizes` in turn; 0 means the rest.
Outcome decode_stream(Bytes stream, Bytes sizes) {
    Ld06Decoder decoder;
    Ld06RecordingClock clock;
    Ld06Turns turns;
    Outcome outcome;
    double last_stamp = 0.0;
    for (std::size_t turn = 0; !stream.empty(); ++turn) {
        const std::size_t wanted = sizes.empty() ? 0 : sizes[turn % sizes.size()];
        const auto piece = stream.first(wanted == 0 ? stream.size() : std::min(wanted, stream.size()));
        stream = stream.subspan(piece.size());
        decoder.feed(piece);
        while (const auto packet = decoder.next()) {
            outcome.packets.push_back(*packet);
            const double stamp = clock.stamp(packet->timestamp);
            fuzz::check(stamp >= last_stamp, "stamps never decrease");
            last_stamp = stamp;
            turns.add(*packet, stamp);
        }
        while (auto complete = turns.next()) outcome.turns.push_back(std::move(*complete));
    }
    outcome.counts = decoder.counts();
    return outcome;
}

void check_turn(const LidarTurn& turn, const LidarScanOptions& options) {
    fuzz::check(!turn.beams.empty() && turn.beams.front().step >= 0 && turn.beams.back().step < kLd06StepsPerTurn,
                "a turn has angles from 0 to 360 degrees");
    for (std::size_t i = 1; i < turn.beams.size(); ++i) {
        fuzz::check(turn.beams[i - 1].step < turn.beams[i].step, "angles increase within a turn");
    }
    Scan scan = ld06_scan(turn, options);
    scan.seq = 1;
    fuzz::check(scan.ranges.size() == turn.beams.size(), "each point has a beam");
    fuzz::check_accepted(wire::ScanBatch{{scan}});
}

} // namespace
} // namespace scanloom::robot

/// Input: a count, that many sizes of pieces, then the bytes of a sensor; the first byte also selects the median's
/// window.
SCANLOOM_FUZZER(ld06)(const std::uint8_t* data, std::size_t size) {
    using namespace scanloom;
    using namespace scanloom::robot;
    if (size == 0) return 0;
    const auto input = std::span(data, size).subspan(1);
    const auto count = std::min<std::size_t>(data[0] % 16U, input.size());
    const auto stream = input.subspan(count);

    const auto whole = decode_stream(stream, {});
    fuzz::check(whole == decode_stream(stream, input.first(count)), "any split of the bytes yields the same turns");
    const auto& counts = whole.counts;
    const std::size_t used = kLd06PacketBytes * (counts.packets + counts.implausible) + counts.skipped_bytes;
    fuzz::check(used <= stream.size() && stream.size() - used < kLd06PacketBytes, "every byte is used once");
    LidarScanOptions options{.confidence_min = 0};
    if (data[0] >= 128) options.median_window = 3 + 2 * (data[0] % 25);
    for (const auto& turn : whole.turns) check_turn(turn, options);
    return 0;
}
