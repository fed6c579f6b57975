#pragma once

#include "robot_client/sources/live_source.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <memory>
#include <utility>

namespace scanloom::robot {

/// A recording replayed as a live source. Its time stands still between calls of next(). It starts at its beginning,
/// whatever the server has from earlier runs.
///
/// Threads: as for LiveSource.
class ReplayedSource final : public LiveSource {
public:
    explicit ReplayedSource(std::unique_ptr<Source> recording) : recording_(std::move(recording)) {}

    /// Errors: those of the recording.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override {
        co_await boost::asio::post(co_await boost::asio::this_coro::executor,
                                   boost::asio::use_awaitable); // lets other handlers of the thread run
        if (is_stopped_) co_return std::optional<Observation>{};
        co_return recording_->next();
    }
    [[nodiscard]] bool can_wait() const override { return true; }
    void stop() override { is_stopped_ = true; }
    [[nodiscard]] std::string remarks() const override { return recording_->remarks(); }

private:
    std::unique_ptr<Source> recording_;
    bool is_stopped_ = false;
};

} // namespace scanloom::robot
