#include "load/core/measured_client.hpp"

#include "common/wire/frame_decoder.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace scanloom::load {
namespace {

constexpr std::chrono::seconds kWelcomeMax{60}; // since the hello: the server creates sessions one by one

link::ClientProtocolOptions options_for(const RobotPlan& plan, const Workload& workload, wire::Hello hello) {
    link::ClientProtocolOptions options;
    options.hello = std::move(hello);
    options.hello.session = plan.session;
    options.hello.robot = plan.name;
    options.first_sensor = workload.sensor; // so that each robot adds two entries to its session, also without scans
    options.batch_bytes_max = wire::kFrameBytesMax;
    options.batch_scans_max = workload.batch;
    options.only_full_batches = true;
    options.continues_earlier_run = false;
    options.welcome_timeout = kWelcomeMax;
    return options;
}

} // namespace

std::size_t WorkloadQueue::bytes_max(std::uint64_t seq) const {
    const wire::NumberedScan scan = scan_at(*workload_, first_scan_, seq);
    return wire::batch_frame_size({&scan, 1});
}

void WorkloadQueue::append_batch(std::uint64_t first, std::size_t count, std::string& out) const {
    std::vector<wire::NumberedScan> batch;
    batch.reserve(count);
    for (std::size_t i = 0; i < count; ++i) batch.push_back(scan_at(*workload_, first_scan_, first + i));
    wire::encode_batch(batch, out);
}

MeasuredClient::MeasuredClient(RobotPlan plan, const Workload& workload, wire::Hello hello)
    : plan_(std::move(plan)), workload_(&workload), scans_(workload, plan_.first_scan),
      protocol_(options_for(plan_, workload, std::move(hello)), scans_, at(0)) {}

void MeasuredClient::close(FleetFigures& figures) noexcept {
    if (is_welcome()) --figures.linked;
    protocol_.close();
}

void MeasuredClient::due(std::uint64_t scans, Micros now) {
    const std::uint64_t before = scans_.last();
    scans_.set_last(scans);
    protocol_.on_scans_added(scans - before, at(now));
}

void MeasuredClient::end() noexcept {
    if (scans_.last() == kEndless) scans_.set_last(scans_.sent_ever());
    protocol_.end();
}

std::optional<wire::LinkError> MeasuredClient::on_bytes(std::size_t count, Micros now, FleetFigures& figures) {
    const std::uint64_t acknowledged_before = acknowledged();
    const std::uint64_t welcomes_before = protocol_.welcomes();
    const std::uint64_t lost_before = protocol_.lost_scans();
    auto failure = protocol_.on_bytes(count, at(now));
    if (failure && failure->error.code == Errc::kMalformed)
        failure->retryable = false; // a wrong server must be noticed
    figures.scans_lost += protocol_.lost_scans() - lost_before;
    record_acknowledged(acknowledged_before + 1, now, figures);
    if (protocol_.welcomes() > welcomes_before) {
        if (welcomes_before == 0) ++figures.greeted;
        ++figures.linked;
        ++figures.links;
        sendings_.clear();
    }
    return failure;
}

void MeasuredClient::write(std::string& out, Micros now, FleetFigures& figures) {
    while (out.size() < kWriteMax) {
        const std::uint64_t sent_before = scans_.sent();
        const std::uint64_t sent_ever_before = scans_.sent_ever();
        if (!protocol_.append_next_frame(out, at(now))) return;
        if (scans_.sent() > sent_before) record_sent(sent_before + 1, sent_ever_before, now, figures);
    }
}

/// Records a batch of scans from `first` on.
void MeasuredClient::record_sent(std::uint64_t first, std::uint64_t sent_ever_before, Micros now,
                                 FleetFigures& figures) {
    ++figures.frames_out;
    sendings_.push_back({scans_.sent(), now});
    for (std::uint64_t seq = first; seq <= scans_.sent(); ++seq) {
        if (seq <= sent_ever_before) {
            ++figures.scans_resent;
            continue;
        }
        ++figures.scans_sent;
        if (workload_->schedule) figures.waiting_to_send.record(now - intended(seq));
    }
}

/// Records that the scans from `first` on were acknowledged.
void MeasuredClient::record_acknowledged(std::uint64_t first, Micros now, FleetFigures& figures) {
    if (acknowledged() >= first) figures.last_ack = now;
    for (std::uint64_t seq = first; seq <= acknowledged(); ++seq) {
        ++figures.scans_acknowledged;
        while (!sendings_.empty() && sendings_.front().last_seq < seq) sendings_.pop_front();
        if (sendings_.empty()) continue;
        figures.from_sending.record(now - sendings_.front().at);
        if (workload_->schedule) figures.from_intended.record(now - intended(seq));
    }
}

/// Pre: the workload has a schedule.
Micros MeasuredClient::intended(std::uint64_t seq) const noexcept {
    return start_ + workload_->schedule->due(plan_.index, seq);
}

} // namespace scanloom::load
