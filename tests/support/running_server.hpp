#pragma once

#include "tests/support/child_process.hpp"

#include <boost/json/value.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::test {

struct HttpAnswer {
    unsigned status = 0;
    std::string content_type;
    std::string etag;
    std::string body;
};

/// Sends a request to a server on this machine. Throws if no server answers.
[[nodiscard]] HttpAnswer http_request(std::uint16_t port, const std::string& method, const std::string& target,
                                      const std::string& body = {});

/// A scanloom-server of the build under test, which is ready after construction.
class RunningServer {
public:
    /// Ports 0 select free ports.
    RunningServer(const std::filesystem::path& store, const std::filesystem::path& log, std::uint16_t robot_port = 0,
                  std::uint16_t http_port = 0, const std::vector<std::string>& more_options = {});

    [[nodiscard]] std::uint16_t robot_port() const noexcept { return robot_port_; }
    [[nodiscard]] std::uint16_t http_port() const noexcept { return http_port_; }
    [[nodiscard]] std::string robot_address() const { return "127.0.0.1:" + std::to_string(robot_port_); }

    [[nodiscard]] HttpAnswer get(const std::string& target) const { return http_request(http_port_, "GET", target); }
    [[nodiscard]] boost::json::value get_json(const std::string& target) const;

    [[nodiscard]] ChildProcess& process() noexcept { return *process_; }

private:
    std::unique_ptr<ChildProcess> process_;
    std::uint16_t robot_port_ = 0;
    std::uint16_t http_port_ = 0;
};

/// Returns the path of a program of the build under test.
[[nodiscard]] std::filesystem::path program(const std::string& name);

} // namespace scanloom::test
