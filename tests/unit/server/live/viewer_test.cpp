#include "server/live/viewer.hpp"

#include "tests/support/http_client.hpp"
#include "tests/support/live_client.hpp"
#include "tests/support/live_replay.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/test_certificate.hpp"
#include "tests/unit/server/live/live_server.hpp"

#include <boost/asio/ssl/context.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::live {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing_support::HttpClient;
using testing_support::LiveClient;
using testing_support::LiveReplay;

/// Reads until the viewer knows all that the session shows.
void catch_up(LiveServer& server, LiveClient& client, LiveReplay& viewer) {
    while (viewer.events == 0 || viewer.last.revision() < server.session().snapshot()->revision) {
        const auto message = client.read();
        ASSERT_TRUE(message) << client.reason();
        EXPECT_TRUE(client.is_binary());
        viewer.take(*message);
    }
}

/// Reads until an event says what is asked for.
template <class Condition>
void read_until(LiveClient& client, LiveReplay& viewer, Condition holds) {
    while (!holds()) {
        const auto message = client.read();
        ASSERT_TRUE(message) << client.reason();
        viewer.take(*message);
    }
}

std::string upgrade(std::string_view session, std::string_view more = "") {
    return fmt::format("GET /api/v1/sessions/{}/live HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\n"
                       "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                       "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n{}\r\n",
                       session, more);
}

std::string request(std::initializer_list<v1::Layer> layers, bool points) {
    v1::LiveRequest request;
    for (const auto layer : layers) request.add_layers(layer);
    request.set_points(points);
    return request.SerializeAsString();
}

TEST(LiveViewer, EndsWhenTokensNoLongerAllowIt) {
    LiveServer server;
    LiveClient client(server.port());
    ASSERT_TRUE(client.read());
    server.authenticator().replace(auth::TokenSet()); // viewers without a token are disconnected
    EXPECT_EQ(client.read_to_the_end(), 0U);
    EXPECT_EQ(client.code(), 4401U);
    EXPECT_THAT(client.reason(), HasSubstr("sign in"));
    EXPECT_EQ(server.refusals().of(auth::Port::kHttp, auth::Reason::kRevoked).Value(), 1.0);
}

/// A session watched over TLS, to an end that the viewer or the server makes.
class LiveViewerOverTls : public testing::Test {
protected:
    using Stream = boost::beast::websocket::stream<boost::asio::ssl::stream<boost::asio::ip::tcp::socket>>;

    LiveViewerOverTls() {
        server_.stream("r1", 1, 3);
        stream_.next_layer().next_layer().connect({boost::asio::ip::address_v4::loopback(), server_.port()});
        stream_.next_layer().handshake(boost::asio::ssl::stream_base::client);
        stream_.handshake("127.0.0.1", "/api/v1/sessions/lab/live");
    }

    std::string read(boost::system::error_code& failed) {
        boost::beast::flat_buffer buffer;
        stream_.read(buffer, failed);
        return {static_cast<const char*>(buffer.data().data()), buffer.size()};
    }

    TemporaryDirectory directory_;
    testing_support::CertificateFiles files_ = testing_support::write_certificate(directory_.path(), "127.0.0.1");
    LiveServer server_{{.interval = 0ms}, sockets::PortTls::open({files_.certificate, files_.key}).value()};
    boost::asio::io_context io_;
    boost::asio::ssl::context tls_{boost::asio::ssl::context::tls_client};
    Stream stream_{io_, tls_};
    boost::system::error_code failed_;
};

TEST_F(LiveViewerOverTls, GetsTheSameEventsAndMayLeave) {
    LiveReplay viewer;
    while (viewer.events == 0 || viewer.last.revision() < server_.session().snapshot()->revision) {
        viewer.take(read(failed_));
        ASSERT_FALSE(failed_) << failed_.message();
    }
    viewer.expect_equal_to(*server_.session().snapshot(), server_.session().connected());
    stream_.close(boost::beast::websocket::close_code::normal, failed_);
    EXPECT_FALSE(failed_) << failed_.message();
}

TEST_F(LiveViewerOverTls, ReceivesTheReasonOfAShutdown) {
    server_.sessions().drain();
    std::jthread stopping([this] { server_.stop(); }); // returns when the connection is closed
    while (!failed_) read(failed_);
    EXPECT_EQ(stream_.reason().code, 1001) << failed_.message();
}

TEST(LiveViewer, FirstEventHasEverythingAndTheNextChanges) {
    LiveServer server;
    server.stream("r1", 1, 20);
    LiveClient client(server.port());
    LiveReplay viewer;
    catch_up(server, client, viewer);
    viewer.expect_equal_to(*server.session().snapshot(), server.session().connected());
    EXPECT_EQ(viewer.events, 1);

    server.stream("r1", 21, 60);
    server.stream("r2", 1, 10);
    catch_up(server, client, viewer);
    viewer.expect_equal_to(*server.session().snapshot(), server.session().connected());
    EXPECT_EQ(server.counters().viewers.Value(), 1.0);
    EXPECT_GE(server.counters().events.Value(), 2.0);
    EXPECT_GT(server.counters().bytes.Value(), 1'000.0);
}

TEST(LiveViewer, ReceivesConnectedRobots) {
    LiveServer server;
    server.stream("r1", 1, 1);
    LiveClient client(server.port());
    LiveReplay viewer;
    read_until(client, viewer, [&] { return viewer.robots.contains(0) && viewer.robots.at(0).connected; });
    server.leave("r1");
    read_until(client, viewer, [&] { return !viewer.robots.at(0).connected; });
}

TEST(LiveViewer, ReceivesAGoalWithoutANewScan) {
    LiveServer server;
    server.stream("r1", 1, 20);
    LiveClient client(server.port());
    LiveReplay viewer;
    catch_up(server, client, viewer);
    EXPECT_EQ(viewer.last.goals_revision(), 0U);
    const auto revision = viewer.last.revision();
    HttpClient person(server.port());
    const std::string wanted = R"({"robot":"r1","size_min":1,"body_radius":0})";
    person.send(fmt::format("POST /api/v1/sessions/lab/goal HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: "
                            "application/json\r\nContent-Length: {}\r\n\r\n{}",
                            wanted.size(), wanted));
    EXPECT_THAT(person.read().body, HasSubstr(R"("outcome":"goal")"));
    read_until(client, viewer, [&] { return viewer.last.goals_revision() == 1; });
    EXPECT_EQ(viewer.last.revision(), revision);
    EXPECT_EQ(viewer.last.tiles_size(), 0);
    EXPECT_EQ(viewer.last.robots_size(), 0);
    server.leave("r1");
    read_until(client, viewer, [&] { return viewer.last.goals_revision() == 2; });
}

TEST(LiveViewer, ReceivesTheExpiryOfAGoal) {
    LiveServer server;
    LiveClient client(server.port());
    LiveReplay viewer;
    catch_up(server, client, viewer);
    const auto almost_over = guidance::RobotPaths::Clock::now() - guidance::RobotPaths::kKeptForAbsent + 200ms;
    server.paths().give_goal(server.sessions().find("lab"), 0, {}, {}, almost_over);
    read_until(client, viewer, [&] { return viewer.last.goals_revision() == 2; });
}

TEST(LiveViewer, GetsWhatItSubscribesTo) {
    LiveServer server;
    server.stream("r1", 1, 5);
    LiveClient client(server.port());
    LiveReplay viewer;
    catch_up(server, client, viewer);
    const auto stamp = viewer.robots.at(0).scan.stamp();
    const auto known = viewer.tiles;
    client.send(request({}, false));
    client.send(request({}, true)); // answered by the scan, sent again; the earlier message was read before
    read_until(client, viewer, [&] { return viewer.events == 2; });
    EXPECT_EQ(viewer.last.tiles_size(), 0);
    server.stream("r1", 6, 10);
    catch_up(server, client, viewer);
    EXPECT_EQ(viewer.tiles, known);
    EXPECT_NE(viewer.robots.at(0).scan.stamp(), stamp);
    client.send(request({v1::LAYER_OCCUPANCY, v1::LAYER_HIMM, v1::LAYER_SONAR, v1::LAYER_CLASSIFICATION}, true));
    read_until(client, viewer, [&] { return viewer.tiles != known; });
    viewer.expect_equal_to(*server.session().snapshot(), server.session().connected());
}

TEST(LiveViewer, RefusalHasAReason) {
    LiveServer server;
    const std::vector<std::pair<std::string, int>> refused = {
        {"GET /api/v1/sessions/lab/live HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", 426},
        {upgrade("lab", "Origin: http://evil.example\r\n"), 403},
        {upgrade("lab", "Origin: null\r\n"), 403},
        {upgrade("hall"), 404},
        {upgrade("lab") + "\x82\x80maskmore", 400},
    };
    for (const auto& [bytes, status] : refused) {
        HttpClient client(server.port());
        client.send(bytes);
        const auto answer = client.read();
        EXPECT_EQ(answer.status, status) << bytes;
        EXPECT_EQ(answer.fields.at("content-type"), "application/problem+json");
    }
    HttpClient stranger(server.port());
    stranger.send("GET /api/v1/sessions/lab/live HTTP/1.1\r\nHost: evil.example\r\n\r\n");
    EXPECT_EQ(stranger.read().status, 421);
    HttpClient own(server.port());
    own.send(upgrade("lab", "Origin: http://127.0.0.1\r\n"));
    const auto answer = own.read();
    EXPECT_EQ(answer.status, 101);
    EXPECT_EQ(answer.fields.at("sec-websocket-accept"), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo="); // RFC 6455, section 1.3
    EXPECT_EQ(answer.fields.at("server"), "Scanloom");
}

TEST(LiveViewer, OneViewerTooManyGets503WithRetryAfter) {
    LiveServer server({.viewers_max = 3, .viewers_per_session_max = 2, .interval = 0ms});
    server.create("hall");
    const auto status_of = [&](const char* session) {
        HttpClient client(server.port());
        client.send(upgrade(session));
        return client.read().status;
    };
    {
        LiveClient first(server.port());
        LiveClient second(server.port());
        EXPECT_EQ(status_of("lab"), 503);
        LiveClient third(server.port(), "hall");
        EXPECT_EQ(status_of("hall"), 503);
        EXPECT_EQ(server.counters().refused.Value(), 2.0);
    }
    while (status_of("lab") != 101) { // until their ends have been noticed
    }
}

TEST(LiveViewer, InvalidMessagesCloseTheConnectionWithAReason) {
    LiveServer server;
    const auto ends_with = [&](const std::string& message, bool binary) {
        LiveClient client(server.port());
        client.send(message, binary);
        client.read_to_the_end();
        return fmt::format("{} {}", client.code(), client.reason());
    };
    EXPECT_THAT(ends_with("{}", false), HasSubstr("1003 a text message was received"));
    EXPECT_THAT(ends_with("\xff\xff\xff", true), HasSubstr("1007 this is no LiveRequest"));
    EXPECT_THAT(ends_with(request({static_cast<v1::Layer>(77)}, true), true),
                HasSubstr("1007 live_request.layers[0] is 77"));
    EXPECT_THAT(ends_with("\x78\x01", true), HasSubstr("1007 live_request has a field 15"));
    EXPECT_THAT(ends_with(std::string(64 * 1024, '\0'), true), HasSubstr("1007"));
    EXPECT_THAT(ends_with(std::string(256 * 1024 + 1, '\0'), true), HasSubstr("1009"));
    for (const auto* bytes : {"\x82\x01x", "\xf2\x81mask\x01", "\x83\x81mask\x01", "\x89\xfe\x01\x01mask"}) {
        LiveClient client(server.port()); // unmasked, with unknown bits, of an unknown kind, a ping that is too long
        client.send_raw(bytes);
        client.read_to_the_end();
        EXPECT_EQ(client.code(), 1002U);
    }
    LiveClient client(server.port());
    EXPECT_TRUE(client.read());
}

TEST(LiveViewer, SlowViewerGetsTheNewestStateAndDelaysNoOther) {
    LiveServer server;
    LiveClient client(server.port(), "lab", 4096);
    constexpr std::uint64_t kSkipped = 200;
    std::uint64_t seq = 0;
    const auto is_behind = [&] { return static_cast<double>(seq) > server.counters().events.Value() + kSkipped; };
    do { // until the buffers between are full: each ack comes while the viewer does not read
        server.stream("r1", seq + 1, seq + 50);
        seq += 50;
    } while (!is_behind() && seq < 100'000);
    ASSERT_TRUE(is_behind());
    EXPECT_LT(server.counters().bytes.Value(), 1 << 20) << "unread events do not queue in the system either";

    LiveReplay viewer;
    catch_up(server, client, viewer);
    EXPECT_LT(static_cast<std::uint64_t>(viewer.events) + kSkipped / 2, seq);
    EXPECT_EQ(viewer.last.revision(), server.session().snapshot()->revision);
    EXPECT_EQ(viewer.robots.at(0).last_seq, seq);
}

TEST(LiveViewer, SendsAtMostOneEventPerInterval) {
    LiveServer server({.interval = 1h});
    LiveClient client(server.port());
    ASSERT_TRUE(client.read());
    server.stream("r1", 1, 20);
    std::thread stopping([&] { server.stop(); });
    EXPECT_EQ(client.read_to_the_end(), 0U);
    stopping.join();
    EXPECT_EQ(client.code(), 1001U);
}

TEST(LiveViewer, DeletingASessionClosesItsConnections) {
    LiveServer server;
    LiveClient silent(server.port(), "lab", 4096);
    LiveClient client(server.port());
    ASSERT_TRUE(client.read());
    const std::weak_ptr<sessions::Session> session = server.sessions().find("lab");
    server.sessions().remove("lab").value();
    client.read_to_the_end();
    EXPECT_EQ(client.code(), 4404U);
    EXPECT_EQ(client.reason(), "session 'lab' was deleted");

    HttpClient again(server.port());
    again.send(upgrade("lab"));
    EXPECT_EQ(again.read().status, 404);
}

TEST(LiveViewer, ExcludingScansMakesViewersReconnect) {
    LiveServer server({.interval = 0ms});
    server.stream("r1", 1, 3);
    LiveClient client(server.port());
    ASSERT_TRUE(client.read());
    server.sessions().exclude("lab", 0, SeqRange{1, 2}).value();
    client.read_to_the_end();
    EXPECT_EQ(client.code(), 1001U);
    EXPECT_THAT(client.reason(), HasSubstr("connect again"));

    LiveClient again(server.port());
    LiveReplay viewer;
    catch_up(server, again, viewer);
    EXPECT_EQ(viewer.robots.at(0).scan_count, 1U);
}

TEST(LiveViewer, ReportsDrainingAndClosesAtShutdown) {
    LiveServer server({.interval = 0ms, .farewell = 50ms});
    server.stream("r1", 1, 3);
    LiveClient silent(server.port(), "lab", 4096); // does not answer the farewell
    LiveClient client(server.port());
    LiveReplay viewer;
    catch_up(server, client, viewer);
    server.sessions().drain();
    read_until(client, viewer, [&] { return viewer.last.state() == v1::SESSION_STATE_DRAINING; });
    EXPECT_THAT(viewer.last.reason(), HasSubstr("shutting down"));
    std::thread reading([&] { client.read_to_the_end(); });
    server.stop(); // returns
    reading.join();
    EXPECT_EQ(client.code(), 1001U);
    EXPECT_THAT(client.reason(), HasSubstr("shutting down"));
}

TEST(LiveViewer, ClosesSilentConnections) {
    LiveServer server({.interval = 0ms, .idle = 250ms}); // long enough for the upgrade on a busy machine
    HttpClient client(server.port());
    client.send(upgrade("lab"));
    ASSERT_EQ(client.read().status, 101);
    EXPECT_TRUE(client.ends_in_order() || client.is_closed()); // after an event and a ping without a pong
}

TEST(LiveViewer, ClosesConnectionsThatDoNotTakeAnEventInTime) {
    LiveServer server({.interval = 0ms, .write = 50ms});
    LiveClient client(server.port(), "lab", 4096);
    ASSERT_TRUE(client.read()); // it is a viewer by now
    for (std::uint64_t seq = 0; server.counters().viewers.Value() > 0.0; seq += 50)
        server.stream("r1", seq + 1, seq + 50);
    client.read_to_the_end();
    EXPECT_EQ(client.code(), 0U);
}

} // namespace
} // namespace scanloom::live
