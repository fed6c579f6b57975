/** Messages of ROS 1 and ROS 2, by the packages of Foxglove. */
import rosmsg from '@foxglove/rosmsg';
import ros1 from '@foxglove/rosmsg-serialization';
import ros2 from '@foxglove/rosmsg2-serialization';

const kSeparator = `\n${'='.repeat(80)}\n`;

const kParts = {
  'geometry_msgs/Vector3': 'float64 x\nfloat64 y\nfloat64 z',
  'geometry_msgs/Point': 'float64 x\nfloat64 y\nfloat64 z',
  'geometry_msgs/Quaternion': 'float64 x\nfloat64 y\nfloat64 z\nfloat64 w',
  'geometry_msgs/Transform': 'geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation',
  'geometry_msgs/Pose': 'geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation',
  'geometry_msgs/TransformStamped': 'std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform',
  'nav_msgs/MapMetaData':
    'time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\ngeometry_msgs/Pose origin',
};

const kMessages = {
  'sensor_msgs/LaserScan': `std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities`,
  'tf2_msgs/TFMessage': 'geometry_msgs/TransformStamped[] transforms',
  'nav_msgs/OccupancyGrid': 'std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data',
};

/** The encodings of messages, as bridges name them. */
export const kEncodings = ['ros1', 'cdr'];

/** @returns the name of a type in an encoding */
export function typeName(type, encoding) {
  return encoding === 'cdr' ? type.replace('/', '/msg/') : type;
}

/** @returns the text of a type with all its parts */
export function definition(type, encoding) {
  const isRos2 = encoding === 'cdr';
  const header = isRos2 ? 'time stamp\nstring frame_id' : 'uint32 seq\ntime stamp\nstring frame_id';
  const parts = { 'std_msgs/Header': header, ...kParts };
  const text = Object.entries(parts).map(([name, fields]) => `MSG: ${name}\n${fields}`);
  const all = [kMessages[type], ...text].join(kSeparator);
  if (!isRos2) return all;
  const time = `MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec`;
  return [all.replaceAll(/^time /gm, 'builtin_interfaces/Time '), time].join(kSeparator);
}

const parsed = (type, encoding) => rosmsg.parse(definition(type, encoding), { ros2: encoding === 'cdr' });

/** @returns a function that encodes messages of a type */
export function writer(type, encoding) {
  const { MessageWriter } = encoding === 'cdr' ? ros2 : ros1;
  const writing = new MessageWriter(parsed(type, encoding));
  return (message) => writing.writeMessage(message);
}

/** @returns a function that decodes messages of a type */
export function reader(type, encoding) {
  const { MessageReader } = encoding === 'cdr' ? ros2 : ros1;
  const reading = new MessageReader(parsed(type, encoding));
  return (bytes) => reading.readMessage(bytes);
}

/** @returns a time in ns as the fields of an encoding */
export function time(nanoseconds, encoding) {
  const sec = Math.floor(nanoseconds / 1e9);
  const rest = nanoseconds - sec * 1e9;
  return encoding === 'cdr' ? { sec, nanosec: rest } : { sec, nsec: rest };
}

/** @returns the fields of a time in ns */
export function nanoseconds(stamp) {
  return BigInt(stamp.sec) * 1_000_000_000n + BigInt(stamp.nanosec ?? stamp.nsec);
}
