#include "robot_client/client/pushed_source.hpp"

#include <utility>

namespace scanloom::robot {

void PushedSource::push(Observation observation) {
    scans_.push_back(std::move(observation));
    added_.notify();
}

boost::asio::awaitable<Result<std::optional<Observation>>> PushedSource::next() {
    while (scans_.empty() && !stopped_) co_await added_.wait();
    if (scans_.empty()) co_return std::optional<Observation>{};
    std::optional<Observation> first(std::move(scans_.front()));
    scans_.pop_front();
    co_return first;
}

void PushedSource::stop() {
    stopped_ = true;
    added_.notify();
}

} // namespace scanloom::robot
