#include "lodestone/exports/log_messages.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/timestamp.pb.h>

#include <cmath>
#include <memory>
#include <set>

#include "lodestone/common/error.h"

namespace lodestone::exports {
namespace {

namespace pb = google::protobuf;
using FieldProto = pb::FieldDescriptorProto;

/// A field; `message` names the type of those that are messages or enums.
struct FieldSpec {
  const char* name;
  int number;
  FieldProto::Type type;
  const char* message = nullptr;
  enum Kind { kPlain, kOptional, kRepeated } kind = kPlain;
};

struct MessageSpec {
  const char* package;
  const char* name;
  std::vector<FieldSpec> fields;
};

constexpr auto kDouble = FieldProto::TYPE_DOUBLE;
constexpr auto kString = FieldProto::TYPE_STRING;
constexpr auto kBool = FieldProto::TYPE_BOOL;
constexpr auto kMessageType = FieldProto::TYPE_MESSAGE;
constexpr FieldSpec kTimestamp = {"timestamp", 1, kMessageType, ".google.protobuf.Timestamp"};

/// From what needs nothing to what needs the others.
std::vector<MessageSpec> message_specs() {
  const FieldSpec x = {"x", 1, kDouble};
  const FieldSpec y = {"y", 2, kDouble};
  const FieldSpec z = {"z", 3, kDouble};
  return {
      {"foxglove", "Vector3", {x, y, z}},
      {"foxglove", "Quaternion", {x, y, z, {"w", 4, kDouble}}},
      {"foxglove",
       "Pose",
       {{"position", 1, kMessageType, ".foxglove.Vector3"},
        {"orientation", 2, kMessageType, ".foxglove.Quaternion"}}},
      {"foxglove",
       "PoseInFrame",
       {kTimestamp, {"frame_id", 2, kString}, {"pose", 3, kMessageType, ".foxglove.Pose"}}},
      {"foxglove",
       "FrameTransform",
       {kTimestamp,
        {"parent_frame_id", 2, kString},
        {"child_frame_id", 3, kString},
        {"translation", 4, kMessageType, ".foxglove.Vector3"},
        {"rotation", 5, kMessageType, ".foxglove.Quaternion"}}},
      {"foxglove",
       "CompressedImage",
       {kTimestamp, {"data", 2, FieldProto::TYPE_BYTES}, {"format", 3, kString}, {"frame_id", 4, kString}}},
      {"foxglove",
       "Log",
       {kTimestamp,
        {"level", 2, FieldProto::TYPE_ENUM, ".foxglove.Log.Level"},
        {"message", 3, kString},
        {"name", 4, kString},
        {"file", 5, kString},
        {"line", 6, FieldProto::TYPE_FIXED32}}},
      {"lodestone",
       "PerCoil",
       {{"px", 1, kDouble},
        {"mx", 2, kDouble},
        {"py", 3, kDouble},
        {"my", 4, kDouble},
        {"coil", 5, kDouble, nullptr, FieldSpec::kRepeated}}},
      {"lodestone", "CoilPulse", {kTimestamp, {"current_A", 2, kMessageType, ".lodestone.PerCoil"}}},
      {"lodestone",
       "CoilStatus",
       {kTimestamp,
        {"current_A", 2, kMessageType, ".lodestone.PerCoil"},
        {"temperature_C", 3, kMessageType, ".lodestone.PerCoil"},
        {"supply_V", 4, kDouble, nullptr, FieldSpec::kOptional},
        {"faults", 5, kString, nullptr, FieldSpec::kRepeated}}},
      {"lodestone",
       "Step",
       {kTimestamp,
        {"sensed", 2, kBool},
        {"reason", 3, kString},
        {"error_m", 4, kDouble, nullptr, FieldSpec::kOptional},
        {"position_sigma_m", 5, kDouble, nullptr, FieldSpec::kOptional},
        {"heading_sigma_rad", 6, kDouble, nullptr, FieldSpec::kOptional},
        {"action_x", 7, kDouble, nullptr, FieldSpec::kOptional},
        {"action_y", 8, kDouble, nullptr, FieldSpec::kOptional},
        {"log_drive_gain", 9, kDouble, nullptr, FieldSpec::kOptional},
        {"log_drive_gain_sigma", 10, kDouble, nullptr, FieldSpec::kOptional},
        {"rig_changed", 11, kBool},
        {"action", 12, kDouble, nullptr, FieldSpec::kRepeated}}},
  };
}

std::string file_of(const std::string& package, const std::string& name) {
  return package + "/" + name + ".proto";
}

/// The file that a type such as ".foxglove.Log.Level" is in.
std::string file_of_type(const std::string& type) {
  const std::size_t dot = type.find('.', 1);
  if (type.rfind(".google", 0) == 0) return pb::Timestamp::descriptor()->file()->name();
  return file_of(type.substr(1, dot - 1), type.substr(dot + 1, type.find('.', dot + 1) - dot - 1));
}

void add_field(const FieldSpec& spec, pb::FileDescriptorProto& file) {
  pb::DescriptorProto& message = *file.mutable_message_type(0);
  FieldProto& field = *message.add_field();
  field.set_name(spec.name);
  field.set_number(spec.number);
  field.set_type(spec.type);
  field.set_label(spec.kind == FieldSpec::kRepeated ? FieldProto::LABEL_REPEATED
                                                    : FieldProto::LABEL_OPTIONAL);
  if (spec.kind == FieldSpec::kOptional) {  // proto3 keeps its presence in a oneof of its own
    field.set_proto3_optional(true);
    field.set_oneof_index(message.oneof_decl_size());
    message.add_oneof_decl()->set_name("_" + std::string(spec.name));
  }
  if (spec.message == nullptr) return;
  field.set_type_name(spec.message);
  const std::string from = file_of_type(spec.message);
  for (const std::string& known : file.dependency())
    if (known == from) return;
  if (from != file.name()) file.add_dependency(from);
}

pb::FileDescriptorProto file_proto(const MessageSpec& spec) {
  pb::FileDescriptorProto file;
  file.set_name(file_of(spec.package, spec.name));
  file.set_package(spec.package);
  file.set_syntax("proto3");
  pb::DescriptorProto& message = *file.add_message_type();
  message.set_name(spec.name);
  for (const FieldSpec& field : spec.fields) add_field(field, file);
  if (file.name() == "foxglove/Log.proto") {
    pb::EnumDescriptorProto& level = *message.add_enum_type();
    level.set_name("Level");
    for (const char* name : {"UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"}) {
      pb::EnumValueDescriptorProto& value = *level.add_value();
      value.set_name(name);
      value.set_number(level.value_size() - 1);
    }
  }
  return file;
}

/// All types, made once.
class Types {
 public:
  Types() {
    pb::FileDescriptorProto timestamp;
    pb::Timestamp::descriptor()->file()->CopyTo(&timestamp);
    pool_.BuildFile(timestamp);
    for (const MessageSpec& spec : message_specs())
      LODESTONE_CHECK(pool_.BuildFile(file_proto(spec)) != nullptr,
                      std::string("a valid descriptor of ") + spec.name);
  }
  const pb::Descriptor& find(const std::string& name) const {
    const pb::Descriptor* found = pool_.FindMessageTypeByName(name);
    LODESTONE_CHECK(found != nullptr, "a known type of message, not " + name);
    return *found;
  }
  std::unique_ptr<pb::Message> make(const std::string& name) {
    return std::unique_ptr<pb::Message>(factory_.GetPrototype(&find(name))->New());
  }

 private:
  pb::DescriptorPool pool_;
  pb::DynamicMessageFactory factory_{&pool_};  // of which any thread may ask
};

Types& types() {
  static Types made;
  return made;
}

/// Sets the fields of a message by their names.
class Fields {
 public:
  explicit Fields(pb::Message& message) : message_(message) {}
  void set(const char* name, double value) { reflect().SetDouble(&message_, field(name), value); }
  void set(const char* name, const std::optional<double>& value) {
    if (value) set(name, *value);
  }
  void set_text(const char* name, const std::string& value) {
    reflect().SetString(&message_, field(name), value);
  }
  void set_flag(const char* name, bool value) { reflect().SetBool(&message_, field(name), value); }
  void set_level(LogLevel level) {
    reflect().SetEnumValue(&message_, field("level"), static_cast<int>(level));
  }
  void add(const char* name, double value) { reflect().AddDouble(&message_, field(name), value); }
  void add_text(const char* name, const std::string& value) {
    reflect().AddString(&message_, field(name), value);
  }
  Fields part(const char* name) { return Fields(*reflect().MutableMessage(&message_, field(name))); }

  void set_time(std::uint64_t time_ns) {
    pb::Message& stamp = *reflect().MutableMessage(&message_, field("timestamp"));
    const auto& of = *stamp.GetDescriptor();
    stamp.GetReflection()->SetInt64(&stamp, of.FindFieldByName("seconds"),
                                    static_cast<std::int64_t>(time_ns / 1'000'000'000));
    stamp.GetReflection()->SetInt32(&stamp, of.FindFieldByName("nanos"),
                                    static_cast<std::int32_t>(time_ns % 1'000'000'000));
  }
  /// The paper's four by their names, others in their order.
  void set_coils(const char* name, const std::optional<OfCoils>& value) {
    if (!value) return;
    Fields coils = part(name);
    const char* const names[] = {"px", "mx", "py", "my"};
    for (std::size_t i = 0; i < value->size(); ++i)
      if (value->size() == 4)
        coils.set(names[i], (*value)[i]);
      else
        coils.add("coil", (*value)[i]);
  }
  void set_pose(const char* position, const char* orientation, const geometry::Pose2& pose) {
    Fields at = part(position);
    at.set("x", pose.x_m);
    at.set("y", pose.y_m);
    Fields turned = part(orientation);
    turned.set("z", std::sin(0.5 * pose.heading_rad));
    turned.set("w", std::cos(0.5 * pose.heading_rad));
  }

 private:
  const pb::Reflection& reflect() const { return *message_.GetReflection(); }
  const pb::FieldDescriptor* field(const char* name) const {
    return message_.GetDescriptor()->FindFieldByName(name);
  }
  pb::Message& message_;
};

/// The bytes of a message that `fill` fills.
template <class Fill>
std::string encoded(const char* name, std::uint64_t time_ns, const Fill& fill) {
  const std::unique_ptr<pb::Message> message = types().make(name);
  Fields fields(*message);
  fields.set_time(time_ns);
  fill(fields);
  return message->SerializeAsString();
}

void add_with_dependencies(const pb::FileDescriptor& file, std::set<std::string>& known,
                           pb::FileDescriptorSet& files) {
  if (!known.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) add_with_dependencies(*file.dependency(i), known, files);
  file.CopyTo(files.add_file());
}

}  // namespace

std::string file_descriptor_set(const std::string& name) {
  pb::FileDescriptorSet files;
  std::set<std::string> known;
  add_with_dependencies(*types().find(name).file(), known, files);
  return files.SerializeAsString();
}

std::string compressed_image_message(std::uint64_t time_ns, const std::string& frame_id,
                                     std::string_view jpeg) {
  return encoded("foxglove.CompressedImage", time_ns, [&](Fields& fields) {
    fields.set_text("data", std::string(jpeg));
    fields.set_text("format", "jpeg");
    fields.set_text("frame_id", frame_id);
  });
}

std::string pose_in_frame_message(std::uint64_t time_ns, const std::string& frame_id,
                                  const geometry::Pose2& pose) {
  return encoded("foxglove.PoseInFrame", time_ns, [&](Fields& fields) {
    fields.set_text("frame_id", frame_id);
    fields.part("pose").set_pose("position", "orientation", pose);
  });
}

std::string frame_transform_message(std::uint64_t time_ns, const std::string& parent,
                                    const std::string& child, const geometry::Pose2& pose) {
  return encoded("foxglove.FrameTransform", time_ns, [&](Fields& fields) {
    fields.set_text("parent_frame_id", parent);
    fields.set_text("child_frame_id", child);
    fields.set_pose("translation", "rotation", pose);
  });
}

std::string log_message(std::uint64_t time_ns, LogLevel level, const std::string& text) {
  return encoded("foxglove.Log", time_ns, [&](Fields& fields) {
    fields.set_level(level);
    fields.set_text("message", text);
    fields.set_text("name", "lodestone");
  });
}

std::string coil_pulse_message(std::uint64_t time_ns, const OfCoils& current_A) {
  return encoded("lodestone.CoilPulse", time_ns,
                 [&](Fields& fields) { fields.set_coils("current_A", current_A); });
}

std::string coil_status_message(std::uint64_t time_ns, const CoilReading& reading) {
  return encoded("lodestone.CoilStatus", time_ns, [&](Fields& fields) {
    fields.set_coils("current_A", reading.current_A);
    fields.set_coils("temperature_C", reading.temperature_C);
    fields.set("supply_V", reading.supply_V);
    for (const std::string& fault : reading.faults) fields.add_text("faults", fault);
  });
}

std::string step_message(std::uint64_t time_ns, const StepFacts& facts) {
  return encoded("lodestone.Step", time_ns, [&](Fields& fields) {
    fields.set_flag("sensed", facts.sensed);
    fields.set_text("reason", facts.reason);
    fields.set("error_m", facts.error_m);
    fields.set("position_sigma_m", facts.position_sigma_m);
    fields.set("heading_sigma_rad", facts.heading_sigma_rad);
    if (facts.action.size() == 2) {
      fields.set("action_x", facts.action[0]);
      fields.set("action_y", facts.action[1]);
    } else {
      for (const double number : facts.action) fields.add("action", number);
    }
    fields.set("log_drive_gain", facts.log_drive_gain);
    fields.set("log_drive_gain_sigma", facts.log_drive_gain_sigma);
    fields.set_flag("rig_changed", facts.rig_changed);
  });
}

}  // namespace lodestone::exports
