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
    std::size_t buffer_bytes_max = std::size_t{32} << 20; ///< of scans not yet acknowledged; then the source waits
    std::size_t batch_bytes_max = std::size_t{64} << 10;  ///< of one ScanBatch of several scans
    std::chrono::milliseconds batch_delay{0};             ///< how long a scan may wait for others to share its batch
    bool compress = false;                                ///< batches, where the server understands it
    std::chrono::milliseconds welcome_timeout{10'000};    ///< from hello to welcome
    std::chrono::milliseconds ping_after{5'000};          ///< of silence
    std::chrono::milliseconds silence_max{15'000};        ///< then the link counts as dead
};

/// The state of one connection of a Conversation.
struct ConversationLink {
    using Time = std::chrono::steady_clock::time_point;

    Time opened;
    Time heard; ///< the newest frame that came
    std::optional<Time> pinged;
    bool said_hello = false;
    bool welcomed = false;
    bool said_goodbye = false;
    wire::Limits limits;
    bool zstd = false;
    CreditWindow credit;
    std::map<std::uint32_t, std::shared_ptr<const Sensor>> described; ///< by Sensor::id
    std::deque<std::uint64_t> pings_to_answer;
    std::optional<Error> cannot_send; ///< the next scan exceeds what this server takes
};

/// The robot's side of the robot link, without a socket and without a clock: what to say next, what to say again after
/// a reconnect, how much may be under way. It outlives its links and is driven by events.
///
/// Usage   link up: open(); for every frame that came: receive(); while next_frame() gives something: send it;
///         link down: close(). Scans come in by add() while has_room(), end() after the last one.
/// Errors  a LinkError ends the link; only if it is retryable, another may be tried.
/// Thread  one at a time.
/// Source  proto/scanloom/v1/frame.proto.
class Conversation {
public:
    using Time = std::chrono::steady_clock::time_point;

    Conversation(ConversationOptions options, Time now);

    // The link
    void open(Time now);
    void close();
    [[nodiscard]] std::optional<wire::LinkError> receive(const wire::Message& message, Time now);
    /// The next frame to send, length prefix included; nothing while there is nothing to say or no credit to say it.
    [[nodiscard]] std::optional<std::string> next_frame(Time now);
    /// What is wrong with the link by now.
    [[nodiscard]] std::optional<wire::LinkError> check(Time now) const;
    /// Until then neither check() nor next_frame(), which had nothing to give, changes its answer, unless something
    /// happens.
    [[nodiscard]] Time deadline(Time now) const;

    // The source
    /// How many scans the server held when it was first reached; nothing before that.
    [[nodiscard]] std::optional<std::uint64_t> resumed_after() const noexcept { return resumed_after_; }
    [[nodiscard]] bool has_room() const noexcept { return buffer_.has_room(); }
    /// Before the server was reached, too. Pre: has_room(), not ended.
    void add(Observation observation, Time now);
    /// @return false where all there are may have been sent.
    bool drop_oldest_unsent() noexcept { return buffer_.drop_oldest_unsent(); }
    void end() noexcept { ended_ = true; }

    // Questions
    /// Asks the server; `answered` is called once, from receive(), with the reply, which may be a refusal. What was
    /// asked on a link that breaks is asked again on the next; what is not answered when all scans are durable and
    /// there will be no more, never is.
    /// @return its id; nothing when OpenRequests::kMax are not answered yet, and nothing is asked then.
    [[nodiscard]] std::optional<std::uint64_t> ask(Request request, Answered answered) {
        return requests_.add(std::move(request), std::move(answered));
    }
    /// Nobody waits for the answer any more.
    void abandon(std::uint64_t id) { requests_.abandon(id); }

    // How far it is
    /// Every scan there will be is durable.
    [[nodiscard]] bool is_done() const noexcept { return ended_ && buffer_.empty(); }
    [[nodiscard]] bool said_goodbye() const noexcept { return link_ && link_->said_goodbye; }
    /// Of Welcome: changes when the session is deleted and made anew; empty before the server was reached.
    [[nodiscard]] const std::string& session_id() const noexcept { return session_id_; }
    [[nodiscard]] bool is_welcome() const noexcept { return link_ && link_->welcomed; }
    /// Since when something is waiting for the server without the server getting anywhere; nothing if nothing waits.
    [[nodiscard]] std::optional<Time> stalled_since() const;
    [[nodiscard]] std::uint64_t acknowledged() const noexcept { return buffer_.acknowledged(); }
    /// Highest seq of this robot that is in the server's maps, as far as is known.
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
    std::optional<Time> unsent_since_; ///< when the oldest scan came that may wait for others
    std::optional<wire::Compressor> compressor_;
    std::uint64_t applied_ = 0;
    bool ended_ = false;
    std::uint64_t nonce_ = 0;
    std::uint64_t bytes_sent_ = 0;
    std::uint64_t welcomes_ = 0;
};

} // namespace scanloom::robot
