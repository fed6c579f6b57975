#include "tests/support/running_server.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/json/parse.hpp>

#include <stdexcept>

namespace scanloom::test {
namespace asio = boost::asio;
namespace http = boost::beast::http;

HttpAnswer http_request(std::uint16_t port, const std::string& method, const std::string& target,
                        const std::string& body) {
    asio::io_context io;
    asio::ip::tcp::socket socket(io);
    socket.connect({asio::ip::address_v4::loopback(), port});
    http::request<http::string_body> request(http::string_to_verb(method), target, 11);
    request.set(http::field::host, "127.0.0.1");
    if (!body.empty()) request.set(http::field::content_type, "application/json");
    request.body() = body;
    request.prepare_payload();
    http::write(socket, request);
    boost::beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    parser.body_limit(std::uint64_t{8} << 30); // logs of millions of scans
    http::read(socket, buffer, parser);
    const auto& response = parser.get();
    return {response.result_int(), std::string(response[http::field::content_type]),
            std::string(response[http::field::etag]), response.body()};
}

std::filesystem::path program(const std::string& name) { return std::filesystem::path(SCANLOOM_PROGRAMS) / name; }

RunningServer::RunningServer(const std::filesystem::path& store, const std::filesystem::path& log,
                             std::uint16_t robot_port, std::uint16_t http_port,
                             const std::vector<std::string>& more_options) {
    std::vector<std::string> options{"--store",  store.string(),
                                     "--listen", "127.0.0.1:" + std::to_string(robot_port),
                                     "--http",   "127.0.0.1:" + std::to_string(http_port)};
    options.insert(options.end(), more_options.begin(), more_options.end());
    process_ = std::make_unique<ChildProcess>(program("scanloom-server"), options, log);
    const auto line = process_->read_line();
    if (!line) throw std::runtime_error("scanloom-server ended before it was ready; see " + log.string());
    const auto ready = boost::json::parse(*line);
    robot_port_ = ready.at("robot_port").to_number<std::uint16_t>();
    http_port_ = ready.at("http_port").to_number<std::uint16_t>();
}

boost::json::value RunningServer::get_json(const std::string& target) const {
    const auto answer = get(target);
    if (answer.status != 200)
        throw std::runtime_error(target + " answered " + std::to_string(answer.status) + ": " + answer.body);
    return boost::json::parse(answer.body);
}

} // namespace scanloom::test
