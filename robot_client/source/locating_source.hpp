#pragma once

#include "robot_client/source/halts.hpp"
#include "robot_client/source/live_source.hpp"
#include "robot_client/source/locate.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::robot {

/// A laser without odometry that is carried from place to place. Where it stands it asks the server for its place, and
/// gives what it sees from there (see Halts); what it sees on its way is dropped.
///
/// While an answer is awaited nothing is read of the laser: one that cannot wait keeps the newest turns itself, and
/// drops older ones (Ld06Live). A server that has no time is asked again. The turns that were asked about are kept here
/// and are given however late the answer is. Once a place is known nothing of it needs the server any more.
///
/// Thread  as of LiveSource
class LocatingSource final : public LiveSource {
public:
    using Tell = std::function<void(const std::string&)>;

    /// @param turns        of one laser, their poses in its odometry frame; of a bare lidar the origin
    /// @param first_place  T_map_robot where it stands first, in case nothing is mapped yet
    /// @param tell         hears sentences for people
    /// @param ask_again_after  where the server says that it cannot tell at this moment
    LocatingSource(std::unique_ptr<LiveSource> turns, const Pose2& first_place, Tell tell,
                   std::chrono::milliseconds ask_again_after = std::chrono::seconds(1));

    /// Who tells where it is. To be called before the first next().
    void ask_with(Locate locate) { locate_ = std::move(locate); }

    [[nodiscard]] bool can_wait() const override { return turns_->can_wait(); }
    void resume_after(std::uint64_t scans) override { turns_->resume_after(scans); }

    /// Errors  those of the turns; once there are no more, where not one could be given: the newest refusal, or kNotFound:
    ///         the laser never stood still, or it was stopped before there was an answer.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    void stop() override;
    [[nodiscard]] std::string remarks() const override;

private:
    [[nodiscard]] boost::asio::awaitable<void> ask(SeenPoints seen);
    [[nodiscard]] boost::asio::awaitable<void> wait(std::chrono::steady_clock::time_point until);
    void tell_news();
    [[nodiscard]] Result<std::optional<Observation>> outcome() const;

    std::unique_ptr<LiveSource> turns_;
    Halts halts_;
    Tell tell_;
    std::chrono::milliseconds ask_again_after_;
    Locate locate_;
    bool has_ended_ = false;
    bool is_stopped_ = false;
    /// Of wait(), on its frame.
    std::shared_ptr<boost::asio::steady_timer*> awaiting_ = std::make_shared<boost::asio::steady_timer*>(nullptr);
};

} // namespace scanloom::robot
