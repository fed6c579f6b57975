#include "server/app/node.hpp"

#include "common/app/program.hpp"
#include "common/net/tls.hpp"
#include "server/auth/token.hpp"

#include <unistd.h>

#include <boost/asio/ip/host_name.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <fmt/format.h>
#include <fmt/ostream.h>
#include <spdlog/spdlog.h>

#include <utility>

namespace scanloom::app {
namespace asio = boost::asio;
namespace {

std::string address_of(const asio::ip::tcp::endpoint& endpoint, unsigned port) {
    if (endpoint.address().is_unspecified()) return fmt::format("{}:{}", asio::ip::host_name(), port);
    const asio::ip::tcp::endpoint listening(endpoint.address(), static_cast<asio::ip::port_type>(port));
    return fmt::format("{}", fmt::streamed(listening));
}

} // namespace

std::string node_name(const ServerOptions& options) {
    if (!options.node.empty()) return options.node;
    const auto port = options.listen.port();
    if (port == 0) return fmt::format("{}:process-{}", asio::ip::host_name(), ::getpid()); // its port is not known yet
    return fmt::format("{}:{}", asio::ip::host_name(), port);
}

store::NodeInfo node_info(const ServerOptions& options, unsigned robot_port, unsigned http_port) {
    const auto* const scheme = options.http_tls.is_given() ? "https" : "http";
    return {.robots = address_of(options.listen, robot_port),
            .http = fmt::format("{}://{}", scheme, address_of(options.http, http_port)),
            .build = std::string(kVersion)};
}

void enter(store::ScanLog& log, const store::NodeInfo& info) {
    auto* const shared = log.shared();
    if (shared == nullptr) return;
    const auto entered = shared->announce(info);
    if (!entered) spdlog::warn("the other servers do not know the address of this one: {}", entered.error().message);
}

std::string others_in(const std::vector<store::Node>& nodes) {
    std::string others;
    for (const auto& node : nodes) {
        if (node.is_self || !node.is_alive) continue;
        others += fmt::format("{}{} at {}", others.empty() ? "" : ", ", node.info->name, node.info->http);
    }
    return others;
}

Result<http::NodeLinks> node_links(store::ScanLog& log) {
    auto* const shared = log.shared();
    if (shared == nullptr) return http::NodeLinks();
    auto tls = net::client_tls("");
    if (!tls) return tls.error();
    return http::NodeLinks{auth::hash_of("requests " + shared->secret()), std::move(*tls)};
}

} // namespace scanloom::app
