#include "server/ingest/dialogue.hpp"

#include "common/scan/limits.hpp"
#include "common/wire/frame_decoder.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::ingest {
namespace {

/// Bound on the bytes of pongs and refusals that a robot has not read.
constexpr std::size_t kSmallAnswerBytesMax = std::size_t{64} << 10;

/// Bound on the bytes of sensor descriptions that are not durable yet, in addition to the credit for scans: twice the
/// size of the descriptions of 64 sensors with 4096 explicit angles each.
constexpr std::size_t kDescriptionBytesMax = std::size_t{4} << 20;

} // namespace

void Dialogue::welcome(std::shared_ptr<session::Session> session, const session::Joined& joined) {
    session_ = std::move(session);
    robot_ = joined.robot;
    const wire::Limits limits{static_cast<std::uint32_t>(wire::kFrameBytesMax), static_cast<std::uint32_t>(kBeamsMax),
                              static_cast<std::uint32_t>(kScansPerBatchMax)};
    outbox_.send(
        wire::Welcome{session::tag_of(session_->info()), joined.last_durable_seq, limits, credit_bytes_, true});
}

Result<> Dialogue::handle(wire::Message message, std::size_t frame_bytes, Time read,
                          std::shared_ptr<session::RobotListener> self) {
    if (auto* sensor = std::get_if<Sensor>(&message)) {
        if (auto ok = charge_description(frame_bytes); !ok) return ok;
        session_->submit(std::move(self), std::move(*sensor), frame_bytes);
        return {};
    }
    if (auto* batch = std::get_if<wire::ScanBatch>(&message)) {
        if (auto ok = charge_batch(frame_bytes); !ok) return ok;
        counters_.scans_received.Increment(static_cast<double>(batch->scans.size()));
        unacknowledged_.add(batch->scans.back().seq, batch->scans.size(), read);
        session_->submit(std::move(self), std::move(batch->scans), frame_bytes);
        return {};
    }
    if (const auto* ping = std::get_if<wire::Ping>(&message)) {
        if (auto ok = check_small_answers(); !ok) return ok;
        outbox_.send(wire::Pong{ping->nonce});
        return {};
    }
    if (std::holds_alternative<wire::Pong>(message)) return {};
    if (std::holds_alternative<wire::Goodbye>(message)) {
        goodbye_ = true;
        return {};
    }
    return Error{Errc::kMalformed,
                 fmt::format("a {} frame is not for the server; after the hello it takes sensor_description, "
                             "scan_batch, requests, ping and goodbye",
                             wire::name_of(message))};
}

void Dialogue::on_durable(std::uint64_t durable_seq, std::size_t bytes) {
    under_way_ -= std::min(bytes, under_way_);
    described_ = std::min(described_, under_way_);
    outbox_.acknowledge({durable_seq, durable_seq, credit_bytes_});
}

Result<> Dialogue::check_small_answers() const {
    if (outbox_.waiting() <= kSmallAnswerBytesMax) return {};
    return Error{Errc::kCreditExceeded,
                 fmt::format("{} bytes of pongs and refusals wait to be read, at most {} may; read them before the "
                             "next ping or request",
                             outbox_.waiting(), kSmallAnswerBytesMax)};
}

Result<> Dialogue::charge_batch(std::size_t bytes) {
    under_way_ += bytes;
    if (under_way_ <= credit_bytes_ + described_) return {};
    return Error{Errc::kCreditExceeded,
                 fmt::format("{} bytes of scan batches are under way, the credit is {}; wait for acks",
                             under_way_ - described_, credit_bytes_)};
}

/// Sensor descriptions need no credit, but the bytes that wait for the disk must be bounded.
Result<> Dialogue::charge_description(std::size_t bytes) {
    under_way_ += bytes;
    described_ += bytes;
    if (described_ <= credit_bytes_ + kDescriptionBytesMax) return {};
    return Error{Errc::kCreditExceeded,
                 fmt::format("{} bytes of sensor descriptions are under way, at most {} are allowed; describe a "
                             "sensor only when it has changed",
                             described_, credit_bytes_ + kDescriptionBytesMax)};
}

} // namespace scanloom::ingest
