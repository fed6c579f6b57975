#include "common/wire/session_convert.hpp"

#include "common/wire/proto_convert.hpp"

namespace scanloom::wire {
namespace {

template <class Value>
Result<Value> value_of(Value value) {
    return value;
}

Result<RayModel> value_of(v1::RayModel model) {
    switch (model) {
    case v1::RAY_MODEL_INVERSE_SENSOR_MODEL: return RayModel::kInverseSensorModel;
    case v1::RAY_MODEL_BRESENHAM: return RayModel::kBresenham;
    case v1::RAY_MODEL_TRAVERSAL: return RayModel::kTraversal;
    default: return invalid_field("ray_model is unknown to this server; see session.proto");
    }
}

Result<ClassSource> value_of(v1::ClassSource source) {
    switch (source) {
    case v1::CLASS_SOURCE_OCCUPANCY: return ClassSource::kOccupancy;
    case v1::CLASS_SOURCE_HIMM: return ClassSource::kHimm;
    default: return invalid_field("class_source is unknown to this server; see session.proto");
    }
}

template <class Value>
Value proto_of(Value value) {
    return value;
}

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
#define SCANLOOM_SETTING(type, name, ...)                                                                              \
    if (proto.has_##name()) {                                                                                          \
        const auto value = value_of(proto.name());                                                                     \
        if (!value) return value.error();                                                                              \
        options.name = *value;                                                                                         \
    }
#include "common/scan/settings.def"
    return options;
}

void to_proto(const SessionOptions& options, v1::SessionConfig& out) {
#define SCANLOOM_SETTING(type, name, ...)                                                                              \
    if (options.name) out.set_##name(proto_of(*options.name));
#include "common/scan/settings.def"
}

} // namespace scanloom::wire
