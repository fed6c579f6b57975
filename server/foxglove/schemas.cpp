#include "server/foxglove/schemas.hpp"

#include "foxglove/scene.pb.h"

#include <fmt/format.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <vector>

namespace scanloom::foxglove {
namespace {

/// A type of ROS 2 and its fields, one `type name` a line.
struct Definition {
    std::string_view type;
    std::string_view fields;
};

/// Source: the interfaces of ROS 2 Humble; docs.ros.org.
constexpr auto kDefinitions = std::to_array<Definition>({
    {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    {"diagnostic_msgs/DiagnosticArray", "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n"},
    {"diagnostic_msgs/DiagnosticStatus",
     "byte level\nstring name\nstring message\nstring hardware_id\ndiagnostic_msgs/KeyValue[] values\n"},
    {"diagnostic_msgs/KeyValue", "string key\nstring value\n"},
    {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    {"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
    {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    {"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    {"geometry_msgs/TransformStamped",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
    {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"nav_msgs/MapMetaData", "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n"
                             "geometry_msgs/Pose origin\n"},
    {"nav_msgs/OccupancyGrid", "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n"},
    {"nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"},
    {"sensor_msgs/LaserScan", "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
                              "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
                              "float32[] ranges\nfloat32[] intensities\n"},
    {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
});

const Definition& definition_of(std::string_view type) {
    return *std::ranges::find(kDefinitions, type, &Definition::type); // each type that is used has a row
}

/// Adds the types of a definition's fields, and theirs, each once.
void add_used(const Definition& user, std::vector<const Definition*>& used) {
    for (const Definition& other : kDefinitions) {
        const bool is_used = user.fields.find(fmt::format("{} ", other.type)) != std::string_view::npos ||
                             user.fields.find(fmt::format("{}[]", other.type)) != std::string_view::npos;
        if (!is_used || std::ranges::find(used, &other) != used.end()) continue;
        used.push_back(&other);
        add_used(other, used);
    }
}

/// @param type  PACKAGE/NAME
Schema schema_of(std::string_view type) {
    const Definition& definition = definition_of(type);
    std::vector<const Definition*> used;
    add_used(definition, used);
    std::string text(definition.fields);
    for (const Definition* other : used) text += fmt::format("{:=<80}\nMSG: {}\n{}", "", other->type, other->fields);
    const std::size_t slash = type.find('/');
    return {fmt::format("{}/msg{}", type.substr(0, slash), type.substr(slash)), "ros2msg", "cdr", std::move(text)};
}

Schema scene_schema() {
    const auto& type = *::foxglove::SceneUpdate::descriptor();
    const auto& file = *type.file();
    google::protobuf::FileDescriptorSet files;
    for (int n = 0; n < file.dependency_count(); ++n) file.dependency(n)->CopyTo(files.add_file());
    file.CopyTo(files.add_file());
    return {type.full_name(), "protobuf", "protobuf", files.SerializeAsString()};
}

} // namespace

const Schema& schema_of(Message message) {
    static const Schema transforms = schema_of("tf2_msgs/TFMessage");
    static const Schema pose = schema_of("geometry_msgs/PoseStamped");
    static const Schema scan = schema_of("sensor_msgs/LaserScan");
    static const Schema grid = schema_of("nav_msgs/OccupancyGrid");
    static const Schema path = schema_of("nav_msgs/Path");
    static const Schema status = schema_of("diagnostic_msgs/DiagnosticArray");
    static const Schema scene = scene_schema();
    switch (message) {
    case Message::kTransforms: return transforms;
    case Message::kPose: return pose;
    case Message::kScan: return scan;
    case Message::kGrid: return grid;
    case Message::kPath: return path;
    case Message::kStatus: return status;
    case Message::kScene: return scene;
    }
    std::abort(); // each message has a case
}

} // namespace scanloom::foxglove
