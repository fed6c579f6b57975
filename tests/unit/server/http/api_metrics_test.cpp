#include "tests/unit/server/http/api_fixture.hpp"

#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace scanloom::http {
namespace {

/// Returns the errors of the text by the rules of Prometheus: every family once, its HELP and TYPE before its samples,
/// and every histogram with a sum, a count, and rising buckets up to all.
class TextCheck {
public:
    std::vector<std::string> faults;

    void read(const std::string& line) {
        static const std::regex help(R"(# HELP ([a-zA-Z_:][a-zA-Z0-9_:]*) \S.*)");
        static const std::regex type(R"(# TYPE ([a-zA-Z_:][a-zA-Z0-9_:]*) (counter|gauge|histogram))");
        static const std::regex sample(
            R"re(([a-zA-Z_:][a-zA-Z0-9_:]*)(?:\{(?:[a-z_]+="[^"\\]*",)*([a-z_]+)="([^"\\]*)"\})? (-?[0-9.]+(?:e[+-]?[0-9]+)?))re");
        std::smatch parts;
        if (std::regex_match(line, parts, help)) {
            finish();
            name_ = parts[1];
            if (!names_.insert(name_).second) faults.push_back("again: " + line);
        } else if (std::regex_match(line, parts, type) && parts[1] == name_ && type_.empty()) {
            type_ = parts[2];
        } else if (std::regex_match(line, parts, sample) && !type_.empty()) {
            take(parts[1], parts[3], std::stod(parts[4]));
        } else {
            faults.push_back("cannot be read: " + line);
        }
    }

    void finish() {
        if (type_ == "histogram" &&
            (buckets_.empty() || buckets_.back() != samples_["_count"] || last_bound_ != "+Inf" ||
             !std::ranges::is_sorted(buckets_) || !samples_.contains("_sum"))) {
            faults.push_back("not a histogram: " + name_);
        }
        if (type_ == "counter" && !name_.ends_with("_total")) faults.push_back("a counter that is no total: " + name_);
        if (!name_.empty() && samples_.empty()) faults.push_back("nothing of " + name_);
        type_.clear();
        samples_.clear();
        buckets_.clear();
    }

    [[nodiscard]] const std::set<std::string>& names() const { return names_; }

private:
    void take(const std::string& sample, const std::string& label, double value) {
        const std::string suffix = sample.starts_with(name_) ? sample.substr(name_.size()) : "of another family";
        const std::set<std::string> known =
            type_ == "histogram" ? std::set<std::string>{"_count", "_sum", "_bucket"} : std::set<std::string>{""};
        if (!known.contains(suffix)) faults.push_back(sample + " among those of " + name_);
        samples_[suffix] = value;
        if (suffix != "_bucket") return;
        buckets_.push_back(value);
        last_bound_ = label;
    }

    std::string name_;
    std::string type_;
    std::set<std::string> names_;
    std::map<std::string, double> samples_;
    std::vector<double> buckets_;
    std::string last_bound_;
};

TEST_F(ApiTest, MetricsAreInThePrometheusTextFormat) {
    create("a");
    stream("a", 3);
    metrics_.ingest().ack_seconds.observe(std::chrono::milliseconds(3), 3);
    std::istringstream text{std::string(get("/metrics").body.bytes())};
    TextCheck check;
    for (std::string line; std::getline(text, line);) check.read(line);
    check.finish();
    EXPECT_THAT(check.faults, testing::IsEmpty());
    EXPECT_THAT(check.names(), testing::IsSupersetOf({"scanloom_ack_seconds", "scanloom_scans_in_flight",
                                                      "scanloom_backlog_entries", "scanloom_scans_received_total",
                                                      "scanloom_scans_applied_total", "scanloom_http_request_seconds",
                                                      "process_cpu_seconds_total", "process_resident_memory_bytes",
                                                      "process_start_time_seconds", "process_open_fds"}));
}

} // namespace
} // namespace scanloom::http
