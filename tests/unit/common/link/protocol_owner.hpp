#pragma once

#include "common/link/server_protocol.hpp"
#include "tests/support/random_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

namespace scanloom::link {

inline std::string frame_of(const wire::Message& message) {
    std::string frame;
    wire::encode(message, frame);
    return frame;
}

inline std::string hello() { return frame_of(wire::Hello{.robot = "r", .session = "lab"}); }

/// Runs a protocol, records its actions as words, and completes each write at once if `completes_writes`.
class Owner {
public:
    explicit Owner(const ServerProtocolConfig& config = {}) : protocol(config, now) {}

    void advance() {
        while (auto action = protocol.next_action(now)) std::visit([this](auto& one) { perform(one); }, *action);
    }

    /// Delivers bytes in pieces of at most `piece` bytes.
    void receive(std::string_view bytes, std::size_t piece = 1 << 20) {
        while (!bytes.empty() && protocol.reading() == ServerProtocol::Reading::kFrames) {
            const auto room = protocol.prepare();
            const std::size_t count = std::min({piece, room.size(), bytes.size()});
            std::ranges::copy(std::as_bytes(std::span(bytes).first(count)), room.begin());
            paused += protocol.on_bytes(count, now);
            bytes.remove_prefix(count);
            advance();
        }
    }

    void open() {
        protocol.on_open();
        advance();
    }

    void join(std::uint64_t durable = 0) {
        open();
        receive(hello());
        protocol.on_joined({"5e55", durable}, now);
        advance();
        done.clear();
    }

    void durable(std::uint64_t seq, std::size_t bytes) {
        protocol.on_durable(seq, bytes);
        advance();
    }

    void locate(std::uint64_t revision) {
        protocol.on_located({.revision = revision});
        advance();
    }

    void pass(ServerProtocol::Duration time) {
        now += time;
        if (now >= protocol.deadline()) protocol.on_timer(now);
        advance();
    }

    [[nodiscard]] std::vector<std::string> take() { return std::exchange(done, {}); }
    /// The last message to the robot. Pre: it is an Error frame.
    [[nodiscard]] const wire::LinkError& error() const { return std::get<wire::LinkError>(sent.back()); }

    ServerProtocol::Time now{std::chrono::hours(5)};
    ServerProtocol protocol;
    std::vector<std::string> done;
    std::vector<wire::Message> sent;
    std::string raw; ///< sent bytes that are no frame
    std::vector<Request> requests;
    std::size_t submitted = 0; ///< bytes of credit
    ServerProtocol::Duration paused{};
    bool completes_writes = true;

private:
    void perform(const ServerProtocol::Join& action) { done.push_back("join " + action.hello.robot); }
    void perform(const ServerProtocol::SubmitSensor& action) {
        submitted += action.bytes;
        done.push_back(fmt::format("sensor {}", action.sensor.id));
    }
    void perform(const ServerProtocol::SubmitScans& action) {
        submitted += action.bytes;
        done.push_back(fmt::format("scans {}..{}", action.scans.front().seq, action.scans.back().seq));
    }
    void perform(const ServerProtocol::AnswerRequest& action) {
        requests.push_back(action.request);
        done.emplace_back("answer");
    }
    void perform(const ServerProtocol::RecordLimit&) { done.emplace_back("record limit"); }
    void perform(const ServerProtocol::Leave&) { done.emplace_back("leave"); }
    void perform(const ServerProtocol::ShutDownSending&) { done.emplace_back("shut down"); }
    void perform(const ServerProtocol::Close&) { done.emplace_back("close"); }
    void perform(const ServerProtocol::Send& action) {
        wire::FrameDecoder decoder(wire::kFrameBytesMax);
        std::ranges::copy(std::as_bytes(std::span(action.bytes)), decoder.prepare(action.bytes.size()).begin());
        decoder.commit(action.bytes.size());
        auto body = decoder.next();
        if (!body) raw += action.bytes;
        for (; body && *body; body = decoder.next()) {
            sent.push_back(wire::decode(**body).value());
            const auto* ack = std::get_if<wire::Ack>(&sent.back());
            const auto* correction = std::get_if<wire::Correction>(&sent.back());
            done.push_back("send " + std::string(wire::name_of(sent.back())) +
                           (ack ? fmt::format(" {}", ack->durable_seq) : "") +
                           (correction ? fmt::format(" {}", correction->revision) : ""));
        }
        if (completes_writes) protocol.on_written();
    }
};

} // namespace scanloom::link
