#pragma once

#include "common/link/credit_window.hpp"
#include "common/link/requests.hpp"
#include "common/link/scan_queue.hpp"
#include "common/scan/limits.hpp"
#include "common/wire/compression.hpp"
#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::link {

/// Settings of a ClientProtocol.
struct ClientProtocolOptions {
    wire::Hello hello;                          ///< the first message of each link: session, robot, token, options
    std::shared_ptr<const Sensor> first_sensor; ///< described right after the welcome; null: before its first scan
    std::size_t batch_bytes_max = std::size_t{64} << 10; ///< of one ScanBatch of several scans
    std::size_t batch_scans_max = kScansPerBatchMax;     ///< of one ScanBatch
    std::chrono::milliseconds batch_delay{0};            ///< how long a scan may wait for others to share its batch
    bool only_full_batches = false;                      ///< until end(), scans wait for batch_scans_max
    bool compress = false;                               ///< compress batches if the server supports it
    bool continues_earlier_run = true;                   ///< whether the server may have scans before the first welcome
    std::chrono::milliseconds welcome_timeout{10'000};   ///< from hello to welcome
    std::chrono::milliseconds ping_after{5'000};         ///< of silence
    std::chrono::milliseconds silence_max{15'000};       ///< then the link is considered dead

    /// Receives the corrections of the robot's poses, from on_bytes(). Empty: they are ignored.
    std::function<void(const wire::Correction&)> on_correction = {};
};

/// The robot's side of the robot link as a state machine without sockets, threads and clocks. It decides which frame to
/// send next, what to send again after a reconnect, and how much may be outstanding. It outlives its links.
/// link::ServerProtocol is the other side.
///
/// Usage: when a link is up, call open(); on_bytes() for the bytes that arrive; append_next_frame() until it returns
/// false, and send what it appends; close() when the link is down. Call on_scans_added() when the queue has new scans,
/// and end() after the last one.
/// Errors: a LinkError ends the link; another link may be tried only if it is retryable.
/// Threads: one at a time.
/// Source: proto/scanloom/v1/frame.proto.
class ClientProtocol {
public:
    /// Points in time, which the caller passes; the class reads no clock.
    using Time = std::chrono::steady_clock::time_point;

    /// @param options  not changed later
    /// @param scans    outlives this object
    /// @param now      the current time
    ClientProtocol(ClientProtocolOptions options, ScanQueue& scans, Time now);

    // The link
    /// Starts a link. The hello is the first frame. Pre: no link is open.
    /// @param server      address of the server, for messages
    /// @param now         the current time
    /// @param has_others  another server may be tried if the program there is not one
    void open(std::string server, Time now, bool has_others = false);
    /// Ends the link, if one is open. Scans that the server does not have are sent again on the next link.
    void close();
    /// Returns space for at least `bytes` bytes, valid until on_bytes(). Pre, also of on_bytes(): the link is open.
    /// @param bytes  more than 0
    [[nodiscard]] std::span<std::byte> prepare(std::size_t bytes) { return link_->decoder.prepare(bytes); }
    /// Takes the first `count` bytes of the prepared space.
    /// @param count  at most the size of the space
    /// @param now    the current time, not before that of earlier calls
    /// @return the failure that ends the link, if any
    [[nodiscard]] std::optional<wire::LinkError> on_bytes(std::size_t count, Time now);
    /// Appends the next frame to send, including its length prefix, to `out`.
    /// @param out  receives the bytes; what it holds is kept
    /// @param now  the current time
    /// @return false while there is no message to send or no credit for it
    [[nodiscard]] bool append_next_frame(std::string& out, Time now);
    /// Returns the failure of the link at this time, if any.
    /// Errors: kTimeout, retryable, if no welcome arrived within welcome_timeout or, after it, no frame within
    ///     silence_max; not retryable, if the next scan exceeds the limits of this server.
    [[nodiscard]] std::optional<wire::LinkError> check(Time now) const;
    /// Returns the time until which the results of check() and append_next_frame() stay the same unless an event
    /// occurs. Pre: append_next_frame() returned false.
    /// @param now  the current time
    [[nodiscard]] Time deadline(Time now) const;

    // Scans
    /// Returns how many scans the server had at the first welcome, or nullopt before it.
    [[nodiscard]] std::optional<std::uint64_t> resumed_after() const noexcept { return resumed_after_; }
    /// The queue has `count` new scans. Pre: end() was not called.
    /// @param count  scans added since the last call
    /// @param now    the current time
    void on_scans_added(std::uint64_t count, Time now);
    /// States that no more scans follow. The protocol says goodbye when all are durable.
    void end() noexcept { ended_ = true; }

    // Requests
    /// Adds a request to the server. A request sent on a link that breaks is sent again on the next one. A request that
    /// is open when the last scan is durable is never answered.
    /// @param request   its id is set here; points within common/scan/limits.hpp
    /// @param answered  called once, from on_bytes(), with the reply, which may be a refusal
    /// @return the request's id, or nullopt if OpenRequests::kMax requests are open; then it is not added
    [[nodiscard]] std::optional<std::uint64_t> ask(Request request, Answered answered) {
        return requests_.add(std::move(request), std::move(answered));
    }
    /// Drops the callback of a request: its reply is no longer needed.
    /// @param id  what ask() returned; unknown ids are ignored
    void abandon(std::uint64_t id) { requests_.abandon(id); }

    // Progress
    /// Returns whether the source has ended and every scan is durable.
    [[nodiscard]] bool is_done() const noexcept { return ended_ && scans_.all_acknowledged(); }
    /// Returns whether the goodbye was sent on this link.
    [[nodiscard]] bool said_goodbye() const noexcept { return link_ && link_->said_goodbye; }
    /// Returns Welcome::session_id, which changes when the session is deleted and recreated; empty before the first
    /// welcome.
    [[nodiscard]] const std::string& session_id() const noexcept { return session_id_; }
    /// Returns whether the server has welcomed the robot on this link.
    [[nodiscard]] bool is_welcome() const noexcept { return link_ && link_->welcomed; }
    /// Returns the time of the last progress while a scan or the first welcome is awaited, else nullopt.
    [[nodiscard]] std::optional<Time> stalled_since() const;
    /// Returns the highest seq of this robot known to be in the server's maps.
    [[nodiscard]] std::uint64_t applied() const noexcept { return applied_; }
    /// Returns the bytes of all frames of all links.
    [[nodiscard]] std::uint64_t bytes_sent() const noexcept { return bytes_sent_; }
    /// Returns how many links the server has welcomed.
    [[nodiscard]] std::uint64_t welcomes() const noexcept { return welcomes_; }
    /// Returns how many acknowledged scans the server no longer had at a later welcome, which ended the link.
    [[nodiscard]] std::uint64_t lost_scans() const noexcept { return lost_scans_; }

private:
    /// The state of one link.
    struct Link {
        Link(std::string to, bool is_one_of_several, Time now)
            : server(std::move(to)), has_others(is_one_of_several), opened(now), heard(now) {}

        std::string server;
        bool has_others;
        Time opened;
        Time heard; ///< when the newest frame arrived
        wire::FrameDecoder decoder{wire::kFrameBytesMax};
        std::optional<Time> pinged;
        bool said_hello = false;
        bool welcomed = false;
        bool said_goodbye = false;
        wire::Limits limits;
        bool zstd = false;
        CreditWindow credit;
        std::map<std::uint32_t, std::shared_ptr<const Sensor>> described; ///< by Sensor::id
        std::vector<std::uint64_t> pings_to_answer;                       ///< nonces, oldest first
        std::optional<Error> cannot_send; ///< set if the next scan exceeds this server's limits
    };

    [[nodiscard]] std::optional<wire::LinkError> take(const wire::Message& message, Time now);
    [[nodiscard]] wire::LinkError unreadable(const Error& error) const;
    [[nodiscard]] wire::LinkError on_error(wire::LinkError failure, Time now);
    [[nodiscard]] bool may_be_replaced(Time now);
    [[nodiscard]] std::optional<wire::LinkError> on_welcome(const wire::Welcome& welcome, Time now);
    [[nodiscard]] std::optional<Error> agree_on_scans(const wire::Welcome& welcome, Time now);
    [[nodiscard]] std::optional<wire::LinkError> on_ack(const wire::Ack& ack, Time now);
    [[nodiscard]] std::optional<wire::Message> next_message(Time now);
    [[nodiscard]] bool append_about_scans(std::string& out, Time now);
    [[nodiscard]] bool is_described(const std::shared_ptr<const Sensor>& sensor) const;
    [[nodiscard]] std::size_t scans_that_fit();
    [[nodiscard]] bool waits_for_others(std::size_t fitting, Time now) const;
    void append_batch(std::size_t count, std::string& out);
    [[nodiscard]] Time ping_due() const;

    ClientProtocolOptions options_;
    ScanQueue& scans_;
    OpenRequests requests_;
    std::vector<Time> replaced_; ///< when links were replaced, within the last minute
    std::optional<Link> link_;
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
    std::uint64_t lost_scans_ = 0;
};

} // namespace scanloom::link
