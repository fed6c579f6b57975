#include "server/ingest/unacknowledged.hpp"

namespace scanloom::ingest {

Unacknowledged::~Unacknowledged() {
    for (const Batch& batch : batches_) take_off(batch);
}

void Unacknowledged::add(std::uint64_t last_seq, std::size_t scans, Time read) {
    batches_.push_back({last_seq, scans, read});
    counters_.scans_in_flight.Increment(static_cast<double>(scans));
}

void Unacknowledged::acknowledge(std::uint64_t durable_seq, Time now) {
    while (!batches_.empty() && batches_.front().last_seq <= durable_seq) {
        counters_.ack_seconds.observe(now - batches_.front().read, batches_.front().scans);
        take_off(batches_.front());
        batches_.pop_front();
    }
}

void Unacknowledged::take_off(const Batch& batch) {
    counters_.scans_in_flight.Decrement(static_cast<double>(batch.scans));
}

} // namespace scanloom::ingest
