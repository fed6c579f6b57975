#pragma once

#include "common/error/error.hpp"
#include "common/net/tls.hpp"
#include "server/http/lane.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/http/server_config.hpp"
#include "server/live/viewer_limits.hpp"
#include "server/metrics/metrics.hpp"
#include "server/sockets/slots.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::http {

/// Computes the response to a request. May be called on several threads at once.
using Answer = std::function<Response(const Request&)>;

/// How requests are answered.
struct Answering {
    Answer answer; ///< called on the lane's threads
    std::function<Outlook(const Request&)> look = [](const Request& r) {
        return lane_of(r);
    }; ///< called first, on I/O threads
    std::function<std::optional<Response>(const Request&)> refuse = [](const Request&) {
        return std::nullopt;
    }; ///< called on I/O threads before a body is read; returns the response to a request without permission
    std::function<void(const Asleep&, std::function<void()>)> wake = {}; ///< on I/O threads; calls back on any
    std::function<void(const std::string&, net::ClientFault)> turned_away = [](const std::string&, net::ClientFault) {
    }; ///< called on I/O threads with the client's address when its handshake failed
    std::function<void(const std::string&)> foreign_host = [](const std::string&) {
    }; ///< called on I/O threads with the address of a client that asked for a foreign host
};

/// The executors of the lanes. A lane that waits must not share an executor with the work that it waits for: deleting a
/// session waits for the executor of the sessions.
struct Executors {
    boost::asio::any_io_executor telling;
    boost::asio::any_io_executor serving;
    boost::asio::any_io_executor survey;
    boost::asio::any_io_executor paths;
    boost::asio::any_io_executor logs; ///< also produces the pieces of streamed bodies
    boost::asio::any_io_executor weaving;
    boost::asio::any_io_executor planning;
    boost::asio::any_io_executor changing;
    boost::asio::any_io_executor showing; ///< not a lane; encodes the events of live viewers
};

/// State that all connections of a server share.
struct Service {
    ServerConfig config;
    bool check_host = true;
    Executors executors;
    Answering answering;
    metrics::HttpCounters& counters;
    sockets::Slots changes;        ///< requests in Lane::kChanging
    sockets::Slots imports;        ///< requests in Lane::kImporting
    sockets::Slots weaves;         ///< requests in Lane::kWeaving
    sockets::Slots paths;          ///< requests in Lane::kPaths
    sockets::Slots plans;          ///< requests in Lane::kPlanning
    live::ViewerSemaphore viewers; ///< connections of live viewers
};

/// Takes a slot of a lane whose number of concurrent requests is limited. Keep it until the request is answered.
/// @return the slot; null for a lane without a limit
/// Errors: kOverloaded if all slots are taken.
[[nodiscard]] Result<std::shared_ptr<const void>> take_slot(const Service& service, Lane lane);

/// @param lane  not Lane::kAtOnce
[[nodiscard]] const boost::asio::any_io_executor& executor_of(const Executors& executors, Lane lane);

} // namespace scanloom::http
