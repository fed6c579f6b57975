#include "core/slam/candidates.hpp"

#include "core/scan_matching/agreement.hpp"
#include "core/scan_matching/line_matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace scanloom::slam {
namespace {

using scan_matching::distance_of;
using scan_matching::LineMatch;
using scan_matching::PosePrior;
using scan_matching::yaw_of;

constexpr double kUsable = 0.3; // inlier ratio of a match that counts

constexpr double kWideGate = 0.6;   // metres, of the first step
constexpr double kNarrowGate = 0.4; // metres, likewise

// A match is doubtful if fewer points are inliers, or if it is farther than this from the prediction.
constexpr double kInliersWithOdometry = 0.75;
constexpr double kInliersWithout = 0.85;
constexpr double kInliersWithoutAfterLargeMotion = 0.9; // the velocity predicts less
constexpr double kDoubtfulDistance = 0.2;               // metres
constexpr double kDoubtfulTurn = 0.2;                   // radians

// A large motion between two scans.
constexpr double kLargeMotion = 0.12;     // metres
constexpr double kLargeMotionTurn = 0.12; // radians

// Odometry and velocity disagree if they differ by more than this.
constexpr double kDisagreement = 0.08;    // metres
constexpr double kDisagreementTurn = 0.1; // radians

// The standard deviation of odometry: a fixed part, and a part of the motion.
constexpr double kOdometrySigma = 0.01; // metres
constexpr double kOdometryPart = 0.05;
constexpr double kOdometryTurnSigma = 0.005; // radians
constexpr double kOdometryTurnPart = 0.1;

// The least standard deviation of a prediction by the velocity.
constexpr double kVelocitySigma = 0.07;     // metres
constexpr double kVelocityTurnSigma = 0.15; // radians

constexpr double kSameCandidateDistance = 0.04; // metres: closer candidates are one
constexpr double kSameCandidateTurn = 0.02;     // radians
// How surprising a pose is, by its distance from a prediction: the scale of this distance, and the weight.
constexpr double kSurpriseSigma = 0.02;            // metres, with odometry
constexpr double kSurpriseTurnSigma = 0.015;       // radians, likewise
constexpr double kSurpriseSigmaWithout = 0.1;      // metres, without odometry
constexpr double kSurpriseTurnSigmaWithout = 0.15; // radians, likewise
constexpr double kSurprisePart = 0.1;              // of the motion, in addition
constexpr double kSurpriseWeight = 0.03;           // in units of Candidate::value

// Starts turned and shifted from the prediction, and the standard deviations of the prior there.
constexpr std::array kStartTurns = {-0.08, 0.08, -0.16, 0.16, -0.3, 0.3};                   // radians
constexpr std::array kStartTurnsWithout = {-0.6, -0.45, -0.3, -0.15, 0.15, 0.3, 0.45, 0.6}; // radians
constexpr std::array kStartShifts = {-0.3, 0.3};                                            // metres
constexpr double kTurnedSigma = 0.1;                                                        // radians, with odometry
constexpr double kShiftedSigma = 0.2;                                                       // metres, with odometry
constexpr double kStartSigmaWithout = 0.3;                                                  // metres, without
constexpr double kStartTurnSigmaWithout = 0.5;                                              // radians, without

// A match that is farther than this from every prediction counts only if this part of the points are inliers.
constexpr double kFarDistance = 0.25; // metres
constexpr double kFarTurn = 0.25;     // radians
constexpr double kInliersFar = 0.9;

constexpr double kUnmatchedValue = 0.25; // of the prediction as a candidate

double turn(const Transform2& T) noexcept { return std::fabs(yaw_of(T)); }

/// Returns an approximation of ln(1 + x), x >= 0: exact where 1 + x is a power of two, linear in between. The C
/// library's logarithm is not equal on every processor.
double log_of_one_plus(double x) noexcept {
    int exponent = 0;
    const double mantissa = std::frexp(1.0 + x, &exponent);
    return std::numbers::ln2 * (exponent - 1 + (2.0 * mantissa - 1.0));
}

/// Collects the candidates of one scan.
class Search {
public:
    Search(const ScanPoints& scan, KeyframeMap& map, const Prediction& prediction)
        : scan_(scan), map_(map), prediction_(prediction), has_odometry_(prediction.odometry.has_value()),
          moved_(distance_of(prediction.motion())), turned_(turn(prediction.motion())),
          expected_(prediction.last * prediction.motion()),
          by_velocity_(prediction.last * prediction.velocity), tight_{expected_,
                                                                      kOdometrySigma + kOdometryPart * moved_,
                                                                      kOdometryTurnSigma + kOdometryTurnPart * turned_},
          loose_(tight_) {
        loose_.position_sigma = std::max(loose_.position_sigma, 2.0 * prediction.position_mismatch);
        loose_.yaw_sigma = std::max(loose_.yaw_sigma, 2.0 * prediction.yaw_mismatch);
        if (has_odometry_) return;
        loose_.position_sigma = std::max(loose_.position_sigma, kVelocitySigma);
        loose_.yaw_sigma = std::max(loose_.yaw_sigma, kVelocityTurnSigma);
    }

    [[nodiscard]] std::vector<Candidate> run(Care care) {
        const LineMatch first = match(expected_, loose_, kWideGate);
        const bool is_plain = !is_doubtful(first);
        if (is_plain && care == Care::kOneIfPlain) {
            return {{tracked(first)}};
        }
        keep(first);
        if (is_plain) return std::move(found_);
        try_other_priors();
        if (best_inliers() < (has_odometry_ ? kInliersFar : inliers_wanted())) try_other_starts();
        found_.push_back({{expected_, 0.0, false, loose_.position_sigma, loose_.yaw_sigma}, kUnmatchedValue});
        return std::move(found_);
    }

private:
    [[nodiscard]] double inliers_wanted() const {
        if (has_odometry_) return kInliersWithOdometry;
        const bool is_large = moved_ > kLargeMotion || turned_ > kLargeMotionTurn;
        return is_large ? kInliersWithoutAfterLargeMotion : kInliersWithout;
    }

    [[nodiscard]] static TrackedScan tracked(const LineMatch& found) {
        return {found.T_map_robot,    found.inlier_ratio, found.inlier_ratio >= kUsable,
                found.position_sigma, found.yaw_sigma,    found.conditioning};
    }

    [[nodiscard]] LineMatch match(const Transform2& start, const PosePrior& prior, double gate) const {
        return match_to_lines(scan_.points, map_.points(), start, prior, {.first_gate = gate});
    }

    [[nodiscard]] bool is_doubtful(const LineMatch& found) const {
        if (found.inlier_ratio < inliers_wanted()) return true;
        const Transform2 off = inverse(expected_) * found.T_map_robot;
        if (distance_of(off) > kDoubtfulDistance || turn(off) > kDoubtfulTurn) return true;
        if (!has_odometry_) return false;
        const Transform2 disagreement = inverse(*prediction_.odometry) * prediction_.velocity;
        return distance_of(disagreement) > kDisagreement || turn(disagreement) > kDisagreementTurn;
    }

    /// Returns what a pose loses for its distance from the predictions.
    [[nodiscard]] double penalty(const Transform2& pose) const {
        const double position_sigma = (has_odometry_ ? kSurpriseSigma : kSurpriseSigmaWithout) + kSurprisePart * moved_;
        const double yaw_sigma =
            (has_odometry_ ? kSurpriseTurnSigma : kSurpriseTurnSigmaWithout) + kSurprisePart * turned_;
        const auto surprise = [&](const Transform2& prediction) {
            const Transform2 off = inverse(prediction) * pose;
            const double yaw = yaw_of(off) / yaw_sigma;
            return log_of_one_plus((off.x * off.x + off.y * off.y) / (position_sigma * position_sigma) + yaw * yaw);
        };
        if (!has_odometry_) return kSurpriseWeight * surprise(expected_);
        return kSurpriseWeight * std::min(surprise(expected_), surprise(by_velocity_) + 1.0);
    }

    [[nodiscard]] bool is_far(const Transform2& pose) const {
        const auto is_far_from = [&](const Transform2& prediction) {
            const Transform2 off = inverse(prediction) * pose;
            return distance_of(off) > kFarDistance || turn(off) > kFarTurn;
        };
        return is_far_from(expected_) && is_far_from(by_velocity_);
    }

    /// Adds a match, unless it is too weak for its distance, or one at the same place is at least as good. Removes
    /// those that are worse.
    void keep(const LineMatch& found) {
        if (found.inlier_ratio < kInliersFar && is_far(found.T_map_robot)) return;
        const double score =
            agreement_of(scan_, map_.points(), map_.space(), found.T_map_robot).score - penalty(found.T_map_robot);
        const auto is_same = [&](const Candidate& other) {
            const Transform2 off = inverse(other.scan.T_keyframe_robot) * found.T_map_robot;
            return distance_of(off) < kSameCandidateDistance && turn(off) < kSameCandidateTurn;
        };
        const auto is_better = [&](const Candidate& other) { return is_same(other) && other.value >= score; };
        if (std::ranges::any_of(found_, is_better)) return;
        std::erase_if(found_, is_same);
        found_.push_back({tracked(found), score});
    }

    void try_from(const Transform2& start, const PosePrior& prior, double gate) { keep(match(start, prior, gate)); }

    /// Starts at the predictions, with priors of different strength.
    void try_other_priors() {
        if (!has_odometry_) return;
        PosePrior velocity = tight_;
        velocity.T_map_robot = by_velocity_;
        try_from(expected_, tight_, kNarrowGate);
        try_from(by_velocity_, velocity, kNarrowGate);
        velocity.position_sigma = loose_.position_sigma;
        velocity.yaw_sigma = loose_.yaw_sigma;
        try_from(by_velocity_, velocity, kNarrowGate);
    }

    /// Starts turned and shifted from the prediction.
    void try_other_starts() {
        PosePrior prior = loose_;
        if (!has_odometry_) {
            prior.position_sigma = kStartSigmaWithout;
            prior.yaw_sigma = kStartTurnSigmaWithout;
            for (const double angle : kStartTurnsWithout) try_from(turned(angle), prior, kWideGate);
            try_from(prediction_.last, prior, kWideGate);
            return;
        }
        prior.yaw_sigma = std::max(prior.yaw_sigma, kTurnedSigma);
        for (const double angle : kStartTurns) try_from(turned(angle), prior, kWideGate);
        prior = loose_;
        prior.position_sigma = std::max(prior.position_sigma, kShiftedSigma);
        for (const double shift : kStartShifts) {
            try_from(expected_ * Transform2{shift, 0.0}, prior, kNarrowGate);
            try_from(expected_ * Transform2{0.0, shift}, prior, kNarrowGate);
        }
    }

    [[nodiscard]] Transform2 turned(double angle) const {
        return {expected_.x, expected_.y, expected_.rotation * scan_matching::sin_cos(angle)};
    }

    [[nodiscard]] double best_inliers() const {
        double best = 0.0;
        for (const Candidate& found : found_) best = std::max(best, found.scan.inlier_ratio);
        return best;
    }

    const ScanPoints& scan_;
    KeyframeMap& map_;
    const Prediction& prediction_;
    bool has_odometry_;
    double moved_;           // metres, by the prediction
    double turned_;          // radians, likewise
    Transform2 expected_;    // T_keyframe_robot by the odometry, else by the velocity
    Transform2 by_velocity_; // T_keyframe_robot
    PosePrior tight_;        // as exact as odometry claims to be
    PosePrior loose_;        // as exact as recent predictions were
    std::vector<Candidate> found_;
};

} // namespace

std::vector<Candidate> candidates_of(const ScanPoints& scan, KeyframeMap& map, const Prediction& prediction,
                                     Care care) {
    return Search(scan, map, prediction).run(care);
}

} // namespace scanloom::slam
