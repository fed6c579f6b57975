#pragma once

#include "common/net/link_stream.hpp"
#include "common/net/tls.hpp"
#include "common/wire/messages.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::robot {

/// The behaviour of a server on one link. The first condition that is set and met ends the link.
struct LinkScript {
    std::optional<wire::LinkError> refuse_hello = {};      ///< instead of a welcome
    std::optional<std::string> answer_hello_with = {};     ///< raw bytes instead of a welcome
    std::optional<std::uint64_t> durable_seq = {};         ///< sent in the welcome instead of the real value
    std::optional<std::uint64_t> hang_up_after_scans = {}; ///< counted on this link
    std::optional<wire::LinkError> error_after_scans = {}; ///< sent after hang_up_after_scans scans
    std::optional<std::uint64_t> silent_after_scans = {};  ///< sends nothing after that; 0: no welcome
    std::optional<std::uint64_t> stop_reading_after_scans = {};
    std::optional<std::uint64_t> hang_up_after_requests = {}; ///< instead of answering the last one
    bool knows_locating = true;                               ///< false: treats the request as a frame without a body
    Result<wire::Correction> location = wire::Correction{};   ///< the answer to that,
    std::vector<Result<wire::Correction>> locations = {};     ///< and to the first requests, one each
    std::vector<wire::Correction> corrections = {};           ///< sent after the welcome
    std::string session_id = "f1";
    std::uint64_t credit_bytes = 20'000;
    std::uint64_t ack_every = 1; ///< batches
    bool zstd = false;
};

/// A minimal server for tests of a robot: welcomes, stores, acknowledges, and fails as its scripts say, one script for
/// each link; the last script applies to all further links. It makes the checks of every server: order of scans,
/// sensors described before their scans, credit. Any plan leads straight to its goal. faults() returns the violations.
class FakeServer {
public:
    FakeServer(boost::asio::io_context& io, std::vector<LinkScript> scripts);

    [[nodiscard]] std::uint16_t port() const { return endpoint_.port(); }
    /// Encrypts all following links.
    void encrypt_with(net::TlsContext tls) { tls_ = std::move(tls); }
    /// Sets the scripts of the next links.
    void continue_with(LinkScript script) { scripts_ = {std::move(script)}; }
    /// Accepts no new connection until reopen().
    void close();
    void reopen();

    [[nodiscard]] const std::vector<Scan>& stored() const noexcept { return stored_; }
    [[nodiscard]] const std::vector<std::string>& faults() const noexcept { return faults_; }
    [[nodiscard]] const std::vector<wire::Hello>& hellos() const noexcept { return hellos_; }
    [[nodiscard]] const std::vector<wire::PlanRequest>& plans() const noexcept { return plans_; }
    [[nodiscard]] const std::vector<wire::LocateRequest>& locates() const noexcept { return locates_; }
    /// The number of compressed batches.
    [[nodiscard]] std::uint64_t compressed_batches() const noexcept { return compressed_batches_; }
    [[nodiscard]] std::uint64_t batches() const noexcept { return batches_; }
    [[nodiscard]] int goodbyes() const noexcept { return goodbyes_; }
    [[nodiscard]] std::size_t largest_batch() const noexcept { return largest_batch_; }
    /// Called after every stored scan, with the number of stored scans.
    std::function<void(std::size_t)> on_stored = [](std::size_t) {};
    void forget() { // all stored scans
        stored_.clear();
        durable_ = 0;
    }
    void store_before(std::uint64_t scans); ///< acts as if this many came in earlier runs

private:
    using Socket = boost::asio::ip::tcp::socket;
    struct Link;

    [[nodiscard]] boost::asio::awaitable<void> accept();
    [[nodiscard]] boost::asio::awaitable<void> serve(Socket socket, LinkScript script);
    [[nodiscard]] boost::asio::awaitable<bool> greet(Link& link, const wire::Hello& hello);
    [[nodiscard]] boost::asio::awaitable<bool> answer(Link& link, const wire::Message& message,
                                                      std::size_t frame_bytes);
    [[nodiscard]] boost::asio::awaitable<bool> meet(Link& link, const wire::PlanRequest& request);
    [[nodiscard]] boost::asio::awaitable<bool> meet(Link& link, const wire::LocateRequest& request);
    [[nodiscard]] boost::asio::awaitable<bool> take(Link& link, const wire::ScanBatch& batch, std::size_t frame_bytes);

    boost::asio::io_context& io_;
    boost::asio::ip::tcp::acceptor acceptor_;
    boost::asio::ip::tcp::endpoint endpoint_;
    std::vector<LinkScript> scripts_;
    net::TlsContext tls_;
    std::size_t links_ = 0;
    std::vector<Scan> stored_;
    std::uint64_t durable_ = 0;
    std::vector<std::string> faults_;
    std::vector<wire::Hello> hellos_;
    std::vector<wire::PlanRequest> plans_;
    std::vector<wire::LocateRequest> locates_;
    std::uint64_t compressed_batches_ = 0;
    std::uint64_t batches_ = 0;
    int goodbyes_ = 0;
    std::size_t largest_batch_ = 0;
};

} // namespace scanloom::robot
