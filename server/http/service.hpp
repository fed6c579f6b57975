#pragma once

#include "common/error/error.hpp"
#include "common/net/tls.hpp"
#include "server/http/lane.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/server_config.hpp"
#include "server/live/seats.hpp"
#include "server/metrics/metrics.hpp"
#include "server/sockets/slots.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::http {

/// Computes the answer to a request. Called on several threads at once.
using Answer = std::function<Response(const Request&)>;

/// What is done with requests.
struct Answering {
    Answer answer; ///< on the lane's threads
    std::function<Outlook(const Request&)> look = [](const Request& r) {
        return lane_of(r);
    }; ///< on I/O threads, first
    std::function<std::optional<Response>(const Request&)> refuse = [](const Request&) {
        return std::nullopt;
    }; ///< on I/O threads, before a body is read: the answer to who is not let in
    std::function<void(const Asleep&, std::function<void()>)> wake = {}; ///< on I/O threads; tells when, on any
    std::function<void(const std::string&, net::ClientFault)> turned_away = [](const std::string&, net::ClientFault) {
    }; ///< on I/O threads: at that address, in the handshake
    std::function<void(const std::string&)> foreign_host = [](const std::string&) {
    }; ///< on I/O threads: that address asked for a host that this server is not
};

/// Where answers are computed, by Lane. A lane that waits must not run where it would hold up what it waits for:
/// deleting a session waits for the executor that the sessions work on.
struct Executors {
    boost::asio::any_io_executor telling;
    boost::asio::any_io_executor serving;
    boost::asio::any_io_executor survey;
    boost::asio::any_io_executor paths;
    boost::asio::any_io_executor logs; ///< the pieces of streamed bodies, too
    boost::asio::any_io_executor weaving;
    boost::asio::any_io_executor planning;
    boost::asio::any_io_executor changing;
    boost::asio::any_io_executor showing; ///< not a lane: what viewers are told live is made here
};

/// What all connections of a server share.
struct Service {
    ServerConfig config;
    bool check_host = true;
    Executors executors;
    Answering answering;
    metrics::HttpCounters& counters;
    sockets::Slots changes; ///< requests in Lane::kChanging
    sockets::Slots imports; ///< requests in Lane::kImporting
    sockets::Slots weaves;  ///< requests in Lane::kWeaving
    sockets::Slots paths;   ///< requests in Lane::kPaths
    sockets::Slots plans;   ///< requests in Lane::kPlanning
    live::Seats seats;      ///< connections that are viewers'
};

/// For what must not pile up, kept while it is under way; null where that does not matter. Errors  kOverloaded.
[[nodiscard]] Result<std::shared_ptr<const void>> take_slot(const Service& service, Lane lane);

/// Pre: not Lane::kAtOnce.
[[nodiscard]] const boost::asio::any_io_executor& executor_of(const Executors& executors, Lane lane);

} // namespace scanloom::http
