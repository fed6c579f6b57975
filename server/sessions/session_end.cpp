#include "server/log/context.hpp"
#include "server/sessions/session.hpp"
#include "server/store/shared_sessions.hpp"

#include <boost/asio/post.hpp>

#include <utility>

/// How a session ends or is reset: after failures of its log, and when it is closed.
namespace scanloom::sessions {

/// Stops ingestion after a failed write, after which the contents of the disk are unknown until the store is opened
/// again, or because a durable entry could not be applied. The maps remain readable.
void Session::stop_writing(const Error& error) {
    log::error({.session = info_.name}, "session '{}': {}", info_.name, error.message);
    refusing_ = error;
    broken_ = true;
    {
        const std::lock_guard lock(failure_mutex_);
        failure_ = error;
    }
    has_news_ = true;
    sequencer_.fail_all(error);
    drop_pending();
    finish_closing();
}

/// Resets the session to the durable entries because the log had no room for the last group. All entries after them are
/// dropped; robots that reconnect send them again.
void Session::reset_to_durable(const Error& error) {
    refusing_ = error; // until the durable entries are in the maps
    resetting_ = true;
    sequencer_.fail_all(error);
    waiting_.clear();
    finish_reset();
    finish_closing();
}

void Session::finish_reset() {
    if (!resetting_ || !durable_.empty() || broken_) return;
    resetting_ = false;
    drop_pending();
    appended_ = maps_.projection().revision();
    refusing_ = closing();
    begin_correction();
}

void Session::drop_pending() {
    drop_correction(); // its entry may be among those that are dropped
    waiting_.clear();
    durable_.clear();
    applied_ = 0;
    share_.give_back(std::exchange(chunks_under_way_, 0));
    sequencer_.restore(maps_.projection().state());
}

void Session::close(Error reason, std::function<void()> done) {
    on_strand([reason = std::move(reason), done = std::move(done)](Session& self) mutable {
        {
            const std::lock_guard lock(self.failure_mutex_);
            self.closing_ = reason;
        }
        self.has_news_ = true;
        if (!self.refusing_) self.refusing_ = std::move(reason);
        self.closed_ = [earlier = std::move(self.closed_), done = std::move(done)] {
            if (earlier) earlier(); // it is closed twice
            done();
        };
        self.finish_closing();
    });
}

void Session::finish_early() {
    finish_early_ = true;
    on_strand([](Session& self) { self.finish_closing(); });
}

void Session::close_early(Error reason, std::function<void()> done) {
    stays_owned_ = true;
    finish_early_ = true;
    close(std::move(reason), std::move(done));
}

/// Continues closing as far as possible. Called after each event that closing waits for.
void Session::finish_closing() {
    if (!closed_ || appending_ || checkpoints_.is_writing()) return;
    if (finish_early_) {
        for (const Group& group : std::exchange(durable_, {}))
            sequencer_.release(group); // the next recovery applies them
        waiting_.clear();
    }
    if (!waiting_.empty() || !durable_.empty()) return;
    const bool is_outdated = checkpoints_.is_outdated(maps_.projection().revision());
    if (is_outdated && !broken_ && !finish_early_ && !final_checkpoint_tried_) {
        final_checkpoint_tried_ = true;
        return begin_checkpoint();
    }
    auto closed = [done = std::exchange(closed_, nullptr)](Session& self) {
        self.sequencer_.fail_all(*self.refusing_);
        self.drop_pending();
        self.share_.give_back_all(); // readers may still hold the maps for a while
        done();
    };
    auto* const shared = log_.shared();
    if (shared == nullptr || stays_owned_) return closed(*this);
    boost::asio::post(blocking_executor_, [self = shared_from_this(), shared, closed = std::move(closed)] {
        static_cast<void>(shared->disown(self->info_.id)); // if this fails, it is owned until the log is opened again
        self->on_strand(closed); // links fail last: the server to which robots connect now may take the session
    });
}

} // namespace scanloom::sessions
