#pragma once

#include "robot_client/client/client.hpp"
#include "tests/integration/robot_client/fake_server.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/asio/executor_work_guard.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <thread>

namespace scanloom::robot {

inline std::shared_ptr<const Sensor> laser() {
    Sensor sensor;
    sensor.name = "laser";
    sensor.angles = UniformAngles{-1.0, 0.01, 200};
    sensor.range_max = 10.0;
    return std::make_shared<const Sensor>(sensor);
}

inline Scan numbered(int number) {
    Scan scan;
    scan.stamp = 0.1 * number;
    scan.pose = {0.01 * number, 0.0, 0.001 * number};
    scan.ranges.assign(200, static_cast<RangeMm>(2000 + number % 50));
    return scan;
}

/// A fake server that accepts connections from the start, and answers them after run(), on its own thread.
class ServerInTheTest {
public:
    ~ServerInTheTest() { io_.stop(); }
    void run() {
        thread_ = std::jthread([this] { io_.run(); });
    }
    [[nodiscard]] std::string address() const { return fmt::format("127.0.0.1:{}", server_.port()); }
    /// Pre: it is not running.
    void go_by(LinkScript script) { server_.continue_with(std::move(script)); }
    /// Pre: the client is closed.
    [[nodiscard]] const FakeServer& fake() const noexcept { return server_; }

private:
    boost::asio::io_context io_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    FakeServer server_{io_, {{}}};
    std::jthread thread_; // its destructor waits for io_'s
};

class ClientFixture : public testing::Test {
protected:
    void serve(std::uint16_t robot_port = 0) {
        server_.reset();
        server_.emplace(directory_.path() / "store", directory_.path() / "log", robot_port);
    }

    ClientOptions options(const std::string& session = "lab") {
        ClientOptions made;
        made.server = server_ ? server_->robot_address() : made.server;
        made.session = session;
        made.robot = "r1";
        made.cell_size = 0.1;
        return made;
    }

    static void send(Client& client, int first, int last) {
        for (int number = first; number <= last; ++number) {
            const auto sent = client.send(laser(), numbered(number));
            ASSERT_TRUE(sent) << sent.error().message;
        }
    }

    std::string digest_of(const std::string& session) {
        return server_->get(fmt::format("/api/v1/sessions/{}/digest", session)).body;
    }

    TemporaryDirectory directory_;
    std::optional<test::RunningServer> server_;
};

} // namespace scanloom::robot
