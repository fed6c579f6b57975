#include "common/wire/session_convert.hpp"

#include "common/wire/proto_convert.hpp"

namespace scanloom::wire {
namespace {

v1::RayModel proto_of(RayModel model) {
    switch (model) {
    case RayModel::kInverseSensorModel: return v1::RAY_MODEL_INVERSE_SENSOR_MODEL;
    case RayModel::kBresenham: return v1::RAY_MODEL_BRESENHAM;
    case RayModel::kTraversal: return v1::RAY_MODEL_TRAVERSAL;
    }
    return v1::RAY_MODEL_UNSPECIFIED;
}

v1::ClassSource proto_of(ClassSource source) {
    return source == ClassSource::kHimm ? v1::CLASS_SOURCE_HIMM : v1::CLASS_SOURCE_OCCUPANCY;
}

} // namespace

Result<SessionOptions> from_proto(const v1::SessionConfig& proto) {
    SessionOptions options;
    if (proto.has_cell_size()) options.cell_size = proto.cell_size();
    if (proto.has_ray_model()) {
        switch (proto.ray_model()) {
        case v1::RAY_MODEL_INVERSE_SENSOR_MODEL: options.ray_model = RayModel::kInverseSensorModel; break;
        case v1::RAY_MODEL_BRESENHAM: options.ray_model = RayModel::kBresenham; break;
        case v1::RAY_MODEL_TRAVERSAL: options.ray_model = RayModel::kTraversal; break;
        default: return invalid_field("ray_model is none that this server knows; see session.proto");
        }
    }
    if (proto.has_accumulate()) options.accumulate = proto.accumulate();
    if (proto.has_hit_radius()) options.hit_radius = proto.hit_radius();
    if (proto.has_drop_no_return()) options.drop_no_return = proto.drop_no_return();
    if (proto.has_p_occupied()) options.p_occupied = proto.p_occupied();
    if (proto.has_p_free()) options.p_free = proto.p_free();
    if (proto.has_p_prior()) options.p_prior = proto.p_prior();
    if (proto.has_p_min()) options.p_min = proto.p_min();
    if (proto.has_p_max()) options.p_max = proto.p_max();
    if (proto.has_obstacle_thickness()) options.obstacle_thickness = proto.obstacle_thickness();
    if (proto.has_beam_aperture()) options.beam_aperture = proto.beam_aperture();
    if (proto.has_himm_increment()) options.himm_increment = proto.himm_increment();
    if (proto.has_himm_decrement()) options.himm_decrement = proto.himm_decrement();
    if (proto.has_himm_obstacle_thickness()) options.himm_obstacle_thickness = proto.himm_obstacle_thickness();
    if (proto.has_himm_beam_aperture()) options.himm_beam_aperture = proto.himm_beam_aperture();
    if (proto.has_sonar_obstacle_thickness()) options.sonar_obstacle_thickness = proto.sonar_obstacle_thickness();
    if (proto.has_sonar_beam_aperture()) options.sonar_beam_aperture = proto.sonar_beam_aperture();
    if (proto.has_sonar_p_occupied_max()) options.sonar_p_occupied_max = proto.sonar_p_occupied_max();
    if (proto.has_sonar_p_min()) options.sonar_p_min = proto.sonar_p_min();
    if (proto.has_sonar_p_max()) options.sonar_p_max = proto.sonar_p_max();
    if (proto.has_class_source()) {
        switch (proto.class_source()) {
        case v1::CLASS_SOURCE_OCCUPANCY: options.class_source = ClassSource::kOccupancy; break;
        case v1::CLASS_SOURCE_HIMM: options.class_source = ClassSource::kHimm; break;
        default: return invalid_field("class_source is none that this server knows; see session.proto");
        }
    }
    if (proto.has_class_p_occupied()) options.class_p_occupied = proto.class_p_occupied();
    if (proto.has_class_p_free()) options.class_p_free = proto.class_p_free();
    if (proto.has_class_himm_occupied()) options.class_himm_occupied = proto.class_himm_occupied();
    if (proto.has_class_himm_free()) options.class_himm_free = proto.class_himm_free();
    if (proto.has_danger_cells()) options.danger_cells = proto.danger_cells();
    if (proto.has_danger_radius()) options.danger_radius = proto.danger_radius();
    if (proto.has_max_jump()) options.max_jump = proto.max_jump();
    return options;
}

void to_proto(const SessionOptions& options, v1::SessionConfig& out) {
    if (options.cell_size) out.set_cell_size(*options.cell_size);
    if (options.ray_model) out.set_ray_model(proto_of(*options.ray_model));
    if (options.accumulate) out.set_accumulate(*options.accumulate);
    if (options.hit_radius) out.set_hit_radius(*options.hit_radius);
    if (options.drop_no_return) out.set_drop_no_return(*options.drop_no_return);
    if (options.p_occupied) out.set_p_occupied(*options.p_occupied);
    if (options.p_free) out.set_p_free(*options.p_free);
    if (options.p_prior) out.set_p_prior(*options.p_prior);
    if (options.p_min) out.set_p_min(*options.p_min);
    if (options.p_max) out.set_p_max(*options.p_max);
    if (options.obstacle_thickness) out.set_obstacle_thickness(*options.obstacle_thickness);
    if (options.beam_aperture) out.set_beam_aperture(*options.beam_aperture);
    if (options.himm_increment) out.set_himm_increment(*options.himm_increment);
    if (options.himm_decrement) out.set_himm_decrement(*options.himm_decrement);
    if (options.himm_obstacle_thickness) out.set_himm_obstacle_thickness(*options.himm_obstacle_thickness);
    if (options.himm_beam_aperture) out.set_himm_beam_aperture(*options.himm_beam_aperture);
    if (options.sonar_obstacle_thickness) out.set_sonar_obstacle_thickness(*options.sonar_obstacle_thickness);
    if (options.sonar_beam_aperture) out.set_sonar_beam_aperture(*options.sonar_beam_aperture);
    if (options.sonar_p_occupied_max) out.set_sonar_p_occupied_max(*options.sonar_p_occupied_max);
    if (options.sonar_p_min) out.set_sonar_p_min(*options.sonar_p_min);
    if (options.sonar_p_max) out.set_sonar_p_max(*options.sonar_p_max);
    if (options.class_source) out.set_class_source(proto_of(*options.class_source));
    if (options.class_p_occupied) out.set_class_p_occupied(*options.class_p_occupied);
    if (options.class_p_free) out.set_class_p_free(*options.class_p_free);
    if (options.class_himm_occupied) out.set_class_himm_occupied(*options.class_himm_occupied);
    if (options.class_himm_free) out.set_class_himm_free(*options.class_himm_free);
    if (options.danger_cells) out.set_danger_cells(*options.danger_cells);
    if (options.danger_radius) out.set_danger_radius(*options.danger_radius);
    if (options.max_jump) out.set_max_jump(*options.max_jump);
}

} // namespace scanloom::wire
