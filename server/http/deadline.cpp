#include "server/http/deadline.hpp"

#include <utility>

namespace scanloom::http {

void Deadline::watch(std::weak_ptr<void> owner, std::function<void()> passed) {
    owner_ = std::move(owner);
    passed_ = std::move(passed);
}

void Deadline::set(Clock::time_point at) {
    at_ = at;
    if (at_ < armed_) arm();
}

void Deadline::stop() {
    owner_.reset();
    timer_.cancel();
}

void Deadline::arm() {
    armed_ = at_;
    timer_.expires_at(armed_);
    timer_.async_wait([this, owner = owner_](const boost::system::error_code& cancelled) {
        const auto alive = owner.lock();
        if (cancelled || !alive || owner_.expired()) return;
        armed_ = Clock::time_point::max();
        if (at_ <= Clock::now()) return passed_();
        if (at_ < armed_) arm();
    });
}

} // namespace scanloom::http
