#include "load/core/robot_talk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace scanloom::load {
namespace {

wire::LinkError retry(Errc code, std::string message) { return {{code, std::move(message)}, true}; }
wire::LinkError give_up(Errc code, std::string message) { return {{code, std::move(message)}, false}; }

} // namespace

RobotTalk::RobotTalk(RobotPlan plan, const Course& course, const wire::Hello& hello)
    : plan_(std::move(plan)), course_(&course), hello_(&hello) {}

void RobotTalk::open(Micros now) {
    link_ = {};
    link_.is_open = true;
    link_.opened = link_.said = link_.waits_since = now;
}

void RobotTalk::close(FleetFigures& figures) noexcept {
    if (link_.welcomed) --figures.linked;
    link_ = {};
}

void RobotTalk::end() noexcept {
    ended_ = true;
    if (due_ == kEndless) due_ = sent_ever_;
}

// Receiving -----------------------------------------------------------------------------------------------------------

std::optional<wire::LinkError> RobotTalk::receive(const wire::Message& message, Micros now, FleetFigures& figures) {
    link_.waits_since = now;
    link_.pinged = false;
    if (const auto* failure = std::get_if<wire::LinkError>(&message)) return *failure;
    if (const auto* goodbye = std::get_if<wire::Goodbye>(&message)) {
        return retry(Errc::kShuttingDown, "the server said goodbye: " + goodbye->reason);
    }
    if (const auto* ping = std::get_if<wire::Ping>(&message)) {
        link_.to_answer = ping->nonce;
        return std::nullopt;
    }
    if (std::holds_alternative<wire::Pong>(message)) return std::nullopt;
    const auto* welcome = std::get_if<wire::Welcome>(&message);
    if (welcome && !link_.welcomed) return on_welcome(*welcome, now, figures);
    const auto* ack = std::get_if<wire::Ack>(&message);
    if (ack && link_.welcomed) return on_ack(*ack, now, figures);
    if (std::holds_alternative<wire::Correction>(message)) return std::nullopt; // poses are sent uncorrected
    return retry(Errc::kMalformed, fmt::format("the server sent an unexpected {}", wire::name_of(message)));
}

std::optional<wire::LinkError> RobotTalk::on_welcome(const wire::Welcome& welcome, Micros now, FleetFigures& figures) {
    const std::uint64_t held = welcome.last_durable_seq;
    if (held > sent_ever_) {
        return give_up(Errc::kConflict,
                       fmt::format("session {} holds {} scans of robot {}, which has sent {}; somebody else streams "
                                   "into it",
                                   plan_.session, held, plan_.name, sent_ever_));
    }
    const bool is_another = was_ever_welcome() && welcome.session_id != session_id_;
    if (held < durable_ || (is_another && durable_ > 0)) {
        figures.scans_lost += durable_ - (is_another ? 0 : held);
        return give_up(Errc::kGone,
                       fmt::format("the server had acknowledged {} scans of robot {} in session {}, and holds {}{}",
                                   durable_, plan_.name, plan_.session, held,
                                   is_another ? " in a session made anew" : " after a reconnect"));
    }
    acknowledge(held, now, figures);
    if (!was_ever_welcome()) ++figures.greeted;
    ++figures.linked;
    ++figures.links;
    session_id_ = welcome.session_id;
    link_.welcomed = true;
    credit_.reset(welcome.credit_bytes);
    sendings_.clear();
    sent_ = held;
    return std::nullopt;
}

std::optional<wire::LinkError> RobotTalk::on_ack(const wire::Ack& ack, Micros now, FleetFigures& figures) {
    if (ack.durable_seq > sent_) {
        return give_up(Errc::kMalformed, fmt::format("the server acknowledged scan {} of robot {} in session {}, which "
                                                     "has sent {} on this link",
                                                     ack.durable_seq, plan_.name, plan_.session, sent_));
    }
    acknowledge(ack.durable_seq, now, figures);
    credit_.durable(ack.durable_seq);
    credit_.set_credit(ack.credit_bytes);
    return std::nullopt;
}

void RobotTalk::acknowledge(std::uint64_t seq, Micros now, FleetFigures& figures) {
    if (seq > durable_) figures.last_ack = now;
    for (; durable_ < seq; ++durable_) {
        ++figures.scans_acknowledged;
        const std::uint64_t acknowledged = durable_ + 1;
        while (!sendings_.empty() && sendings_.front().last_seq < acknowledged) sendings_.pop_front();
        if (sendings_.empty()) continue;
        figures.from_sending.record(now - sendings_.front().at);
        if (course_->schedule) figures.from_intended.record(now - intended(acknowledged));
    }
}

// Sending -------------------------------------------------------------------------------------------------------------

void RobotTalk::write(std::string& out, Micros now, FleetFigures& figures) {
    if (!link_.is_open || link_.said_goodbye) return;
    const std::size_t before = out.size();
    const bool waited = is_owed_something();
    write_small_frames(out, now);
    if (link_.welcomed) write_scans(out, now, figures);
    if (link_.welcomed && is_done()) {
        link_.said_goodbye = true;
        wire::encode(wire::Goodbye{"every scan is acknowledged"}, out);
    }
    if (out.size() > before) link_.said = now;
    if (!waited && is_owed_something()) link_.waits_since = now;
}

void RobotTalk::write_small_frames(std::string& out, Micros now) {
    if (!link_.said_hello) {
        link_.said_hello = true;
        wire::Hello hello = *hello_;
        hello.session = plan_.session;
        hello.robot = plan_.name;
        wire::encode(hello, out);
    }
    if (!link_.welcomed) return;
    if (!link_.described) {
        link_.described = true;
        out += course_->sensor_frame;
    }
    if (link_.to_answer) wire::encode(wire::Pong{*std::exchange(link_.to_answer, std::nullopt)}, out);
    if (!link_.pinged && now - link_.said >= kPingAfter) {
        link_.pinged = true;
        wire::encode(wire::Ping{}, out);
    }
}

void RobotTalk::write_scans(std::string& out, Micros now, FleetFigures& figures) {
    while (const std::uint64_t count = next_batch()) {
        batch_.clear();
        for (std::uint64_t i = 1; i <= count; ++i) batch_.push_back(scan_at(*course_, plan_.first_scan, sent_ + i));
        const std::size_t size = wire::batch_frame_size(batch_);
        const bool is_too_much = !out.empty() && out.size() + size > kWriteMax;
        if (size > credit_.available() || is_too_much) return;
        wire::encode_batch(batch_, out);
        ++figures.frames_out;
        sent_ += count;
        credit_.sent(sent_, size);
        sendings_.push_back({sent_, now});
        note_sent(count, now, figures);
    }
}

/// Returns the number of scans in the next frame; 0: wait for more.
std::uint64_t RobotTalk::next_batch() const noexcept {
    const std::uint64_t waiting = due_ > sent_ ? due_ - sent_ : 0;
    if (waiting >= course_->batch) return course_->batch;
    return ended_ ? waiting : 0;
}

void RobotTalk::note_sent(std::uint64_t count, Micros now, FleetFigures& figures) {
    for (std::uint64_t seq = sent_ - count + 1; seq <= sent_; ++seq) {
        if (seq <= sent_ever_) {
            ++figures.scans_resent;
            continue;
        }
        ++figures.scans_sent;
        if (course_->schedule) figures.waiting_to_send.record(now - intended(seq));
    }
    sent_ever_ = std::max(sent_ever_, sent_);
}

std::optional<wire::LinkError> RobotTalk::check(Micros now) const {
    if (!link_.is_open) return std::nullopt;
    if (!link_.welcomed) {
        if (now - link_.opened < kWelcomeMax) return std::nullopt;
        return retry(Errc::kTimeout, fmt::format("no welcome within {:g} s", in_seconds(kWelcomeMax)));
    }
    if (!is_owed_something() || now - link_.waits_since < kSilenceMax) return std::nullopt;
    return retry(Errc::kTimeout, fmt::format("nothing came from the server for {:g} s", in_seconds(kSilenceMax)));
}

bool RobotTalk::is_owed_something() const noexcept { return link_.pinged || link_.said_goodbye || sent_ > durable_; }

/// Pre: the course has a schedule.
Micros RobotTalk::intended(std::uint64_t seq) const noexcept {
    return start_ + course_->schedule->due(plan_.index, seq);
}

} // namespace scanloom::load
