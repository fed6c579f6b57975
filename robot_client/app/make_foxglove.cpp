#include "robot_client/app/make_foxglove.hpp"

#include "common/app/settings.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/signal_set.hpp>
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <exception>
#include <optional>
#include <random>
#include <utility>

namespace scanloom::robot {
namespace {

Result<MapPlace> map_place(const RobotOptions& options, const FoxgloveOptions& foxglove) {
    const auto& token_file = foxglove.http_token_file.empty() ? options.token_file : foxglove.http_token_file;
    auto token = read_token(token_file);
    if (!token) return token.error();
    auto tls = tls_of(options, foxglove.http->is_encrypted);
    if (!tls) return tls.error();
    return MapPlace{
        {foxglove.http->address, std::move(*tls), std::move(*token), "give the server's HTTP port to --http"},
        options.session};
}

} // namespace

Result<std::unique_ptr<FoxgloveSource>> make_foxglove(const RobotOptions& options, const FoxgloveOptions& foxglove,
                                                      Console& console) {
    FoxgloveSourceOptions source;
    source.link.bridge = *foxglove.bridge; // the options were checked
    source.link.reopen_for = std::chrono::milliseconds(static_cast<std::int64_t>(foxglove.reopen_for * 1e3));
    source.link.backoff_seed = std::random_device{}();
    source.link.note = [&console](const std::string& text) { console.note(text); };
    auto certificates = static_cast<const LinkOptions&>(options);
    if (!foxglove.bridge_ca_file.empty()) certificates.tls_ca_file = foxglove.bridge_ca_file;
    auto tls = tls_of(certificates, foxglove.bridge->is_encrypted);
    if (!tls) return tls.error();
    source.link.tls = std::move(*tls);
    source.scans.robot = foxglove.robot;
    source.publish.map_frame = foxglove.map_frame.substr(foxglove.map_frame.starts_with('/') ? 1 : 0); // as in tf2
    source.publish.transform = foxglove.publish_tf;
    if (foxglove.publish_map) {
        auto place = map_place(options, foxglove);
        if (!place) return place.error();
        source.publish.map = std::move(*place);
    }
    return std::make_unique<FoxgloveSource>(std::move(source));
}

Result<Poses> survey_robot(boost::asio::io_context& io, FoxgloveSource& source) {
    std::optional<Result<Poses>> poses;
    boost::asio::signal_set signals(io, SIGINT, SIGTERM);
    signals.async_wait([&](boost::system::error_code failed, int) {
        if (!failed) source.stop();
    });
    boost::asio::co_spawn(io, source.prepare(), [&](const std::exception_ptr& failed, Result<Poses> result) {
        if (failed) std::rethrow_exception(failed);
        poses = std::move(result);
        io.stop();
    });
    io.run();
    io.restart();
    return poses.value_or(Result<Poses>(Error{Errc::kInternal, "the robot was not surveyed"}));
}

} // namespace scanloom::robot
