#pragma once

#include "common/wire/compression.hpp"
#include "common/wire/messages.hpp"
#include "robot_client/uplink/credit_window.hpp"
#include "robot_client/uplink/open_requests.hpp"
#include "robot_client/uplink/replacements.hpp"
#include "robot_client/uplink/send_buffer.hpp"

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace scanloom::robot {

struct ConversationOptions {
    wire::Hello hello;
    std::size_t buffer_bytes_max = std::size_t{32} << 20; ///< of unacknowledged scans; when full, the source waits
    std::size_t batch_bytes_max = std::size_t{64} << 10;  ///< of one ScanBatch of several scans
    std::chrono::milliseconds batch_delay{0};             ///< how long a scan may wait for others to share its batch
    bool compress = false;                                ///< compress batches if the server supports it
    std::chrono::milliseconds welcome_timeout{10'000};    ///< from hello to welcome
    std::chrono::milliseconds ping_after{5'000};          ///< of silence
    std::chrono::milliseconds silence_max{15'000};        ///< then the link is considered dead
};

/// The state of one connection of a Conversation.
struct ConversationLink {
    using Time = std::chrono::steady_clock::time_point;

    Time opened;
    Time heard; ///< when the newest frame arrived
    std::optional<Time> pinged;
    bool said_hello = false;
    bool welcomed = false;
    bool said_goodbye = false;
    wire::Limits limits;
    bool zstd = false;
    CreditWindow credit;
    std::map<std::uint32_t, std::shared_ptr<const Sensor>> described; ///< by Sensor::id
    std::deque<std::uint64_t> pings_to_answer;
    std::optional<Error> cannot_send; ///< set if the next scan exceeds this server's limits
};

/// The robot's side of the robot link as a state machine without socket and clock. It decides which message to send
/// next, what to send again after a reconnect, and how much may be outstanding. It outlives its links.
///
/// Usage: when a link is up, call open(); receive() for each frame that arrives; next_frame() until it returns nullopt,
/// and send what it returns; close() when the link is down. Call add() for each scan while has_room(), and end() after
/// the last one.
/// Errors: a LinkError ends the link; another link may be tried only if it is retryable.
/// Threads: one at a time.
/// Source: proto/scanloom/v1/frame.proto.
class Conversation {
public:
    using Time = std::chrono::steady_clock::time_point;

    Conversation(ConversationOptions options, Time now);

    // The link
    void open(Time now);
    void close();
    [[nodiscard]] std::optional<wire::LinkError> receive(const wire::Message& message, Time now);
    /// Returns the next frame to send, including its length prefix, or nullopt while there is no message to send or no
    /// credit for it.
    [[nodiscard]] std::optional<std::string> next_frame(Time now);
    /// Returns the failure of the link at this time, if any.
    [[nodiscard]] std::optional<wire::LinkError> check(Time now) const;
    /// Returns the time until which the results of check() and next_frame() stay the same unless an event occurs. Pre:
    /// next_frame() returned nullopt.
    [[nodiscard]] Time deadline(Time now) const;

    // The source
    /// Returns how many scans the server had at the first welcome, or nullopt before it.
    [[nodiscard]] std::optional<std::uint64_t> resumed_after() const noexcept { return resumed_after_; }
    [[nodiscard]] bool has_room() const noexcept { return buffer_.has_room(); }
    /// Adds the source's next scan, also before the server was reached. Pre: has_room(), not ended.
    void add(Observation observation, Time now);
    /// Drops the oldest unsent scan.
    /// @return false if every scan in the buffer may have been sent
    bool drop_oldest_unsent() noexcept { return buffer_.drop_oldest_unsent(); }
    void end() noexcept { ended_ = true; }

    // Questions
    /// Adds a request to the server. A request sent on a link that breaks is sent again on the next one. A request that
    /// is open when the last scan is durable is never answered.
    /// @param answered  called once, from receive(), with the reply, which may be a refusal
    /// @return the request's id, or nullopt if OpenRequests::kMax requests are open; then it is not added
    [[nodiscard]] std::optional<std::uint64_t> ask(Request request, Answered answered) {
        return requests_.add(std::move(request), std::move(answered));
    }
    /// Drops the callback of a request: its reply is no longer needed.
    void abandon(std::uint64_t id) { requests_.abandon(id); }

    // Progress
    /// Returns whether the source has ended and every scan is durable.
    [[nodiscard]] bool is_done() const noexcept { return ended_ && buffer_.empty(); }
    [[nodiscard]] bool said_goodbye() const noexcept { return link_ && link_->said_goodbye; }
    /// Returns Welcome::session_id, which changes when the session is deleted and recreated; empty before the first
    /// welcome.
    [[nodiscard]] const std::string& session_id() const noexcept { return session_id_; }
    [[nodiscard]] bool is_welcome() const noexcept { return link_ && link_->welcomed; }
    /// Returns the time of the last progress while a scan or the first welcome is awaited, else nullopt.
    [[nodiscard]] std::optional<Time> stalled_since() const;
    [[nodiscard]] std::uint64_t acknowledged() const noexcept { return buffer_.acknowledged(); }
    /// Returns the highest seq of this robot known to be in the server's maps.
    [[nodiscard]] std::uint64_t applied() const noexcept { return applied_; }
    [[nodiscard]] std::uint64_t last() const noexcept { return buffer_.last(); }
    [[nodiscard]] std::uint64_t sent_ever() const noexcept { return buffer_.sent_ever(); }
    [[nodiscard]] std::uint64_t bytes_sent() const noexcept { return bytes_sent_; }
    [[nodiscard]] std::uint64_t welcomes() const noexcept { return welcomes_; }

private:
    [[nodiscard]] wire::LinkError on_error(wire::LinkError failure, Time now);
    [[nodiscard]] std::optional<wire::LinkError> on_welcome(const wire::Welcome& welcome, Time now);
    [[nodiscard]] std::optional<wire::LinkError> on_ack(const wire::Ack& ack, Time now);
    [[nodiscard]] std::optional<wire::Message> next_message(Time now);
    [[nodiscard]] std::optional<wire::Message> next_about_scans(Time now);
    [[nodiscard]] std::size_t scans_that_fit();
    [[nodiscard]] bool waits_for_others(std::size_t fitting, Time now) const;
    void write_batch(const wire::ScanBatch& batch, std::string& frame);
    [[nodiscard]] Time ping_due() const;

    ConversationOptions options_;
    SendBuffer buffer_;
    OpenRequests requests_;
    Replacements replacements_;
    std::optional<ConversationLink> link_;
    std::optional<std::uint64_t> resumed_after_;
    std::string session_id_;
    Time progress_;
    std::optional<Time> unsent_since_; ///< arrival of the oldest scan that may wait for others
    std::optional<wire::Compressor> compressor_;
    std::uint64_t applied_ = 0;
    bool ended_ = false;
    std::uint64_t nonce_ = 0;
    std::uint64_t bytes_sent_ = 0;
    std::uint64_t welcomes_ = 0;
};

} // namespace scanloom::robot
