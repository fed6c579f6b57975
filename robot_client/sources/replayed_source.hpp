#pragma once

#include "robot_client/sources/live_source.hpp"

#include <memory>

namespace scanloom::robot {

/// A recording replayed as a live source. Its time stands still between calls of next(). It starts at its beginning,
/// whatever the server has from earlier runs.
///
/// Threads: as for LiveSource.
class ReplayedSource final : public LiveSource {
public:
    explicit ReplayedSource(std::unique_ptr<Source> recording) : recording_(std::move(recording)) {}

    /// Errors: those of the recording.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    [[nodiscard]] bool can_wait() const override { return true; }
    void stop() override { is_stopped_ = true; }
    [[nodiscard]] std::string remarks() const override { return recording_->remarks(); }

private:
    std::unique_ptr<Source> recording_;
    bool is_stopped_ = false;
};

} // namespace scanloom::robot
