#include "lab/integrate_recording.hpp"

namespace scanloom::lab {
Result<std::vector<double>> integrate_recording(const Recording& recording, const SessionOptions& options,
                                                const Now& now, const AfterScan& after_scan) {
    const auto config = mapping::resolve(options);
    if (!config) return config.error();
    mapping::Projection projection(*config);
    for (const LogEntry& entry : {LogEntry(RobotJoined{0, "lab"}), LogEntry(SensorDescribed{0, recording.laser})}) {
        if (auto applied = projection.apply(entry); !applied) return applied.error();
    }
    std::vector<double> seconds;
    for (const Scan& scan : recording.scans) {
        const LogEntry entry = ScanTaken{0, scan};
        const double begun = now();
        const auto applied = projection.apply(entry);
        if ((seconds.size() + 1) % kScansPerSnapshot == 0) static_cast<void>(projection.snapshot());
        seconds.push_back(now() - begun);
        if (!applied) return applied.error();
        after_scan(seconds.size(), projection);
    }
    return seconds;
}

} // namespace scanloom::lab
