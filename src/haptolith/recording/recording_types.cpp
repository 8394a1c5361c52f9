#include "haptolith/recording/recording_types.h"

#include <cstddef>
#include <initializer_list>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace haptolith::hdf5 {

namespace {

template <class T>
hid_t scalar(Place place) {
  const bool in_file = place == Place::kFile;
  if constexpr (std::is_same_v<T, double>) {
    return in_file ? H5T_IEEE_F64LE : H5T_NATIVE_DOUBLE;
  } else if constexpr (std::is_same_v<T, float>) {
    return in_file ? H5T_IEEE_F32LE : H5T_NATIVE_FLOAT;
  } else if constexpr (std::is_same_v<T, std::uint64_t>) {
    return in_file ? H5T_STD_U64LE : H5T_NATIVE_UINT64;
  } else if constexpr (std::is_same_v<T, std::uint32_t>) {
    return in_file ? H5T_STD_U32LE : H5T_NATIVE_UINT32;
  } else {
    static_assert(std::is_same_v<T, std::uint8_t>);
    return in_file ? H5T_STD_U8LE : H5T_NATIVE_UINT8;
  }
}

/// A member of a compound: its offset in memory. In the file members follow each other without gaps.
struct Member {
  const char* name;
  std::size_t offset;
  Handle type;
};

Handle compound(std::size_t memory_size, const std::vector<Member>& members, Place place) {
  std::size_t packed = 0;
  for (const Member& member : members) {
    packed += H5Tget_size(member.type.id());
  }
  Handle type = handle(H5Tcreate(H5T_COMPOUND, place == Place::kFile ? packed : memory_size), "make a type");
  std::size_t next = 0;
  for (const Member& member : members) {
    const std::size_t offset = place == Place::kFile ? next : member.offset;
    done(H5Tinsert(type.id(), member.name, offset, member.type.id()), "make a type");
    next += H5Tget_size(member.type.id());
  }
  return type;
}

template <class T>
Handle copyOf(Place place) {
  return handle(H5Tcopy(scalar<T>(place)), "make a type");
}

std::vector<Member> membersOf(const std::vector<RecordColumn>& columns, Place place) {
  std::vector<Member> members;
  for (const RecordColumn& column : columns) {
    Handle type = std::visit([&](auto value) { return copyOf<decltype(value)>(place); }, column.type);
    members.push_back({column.name.c_str(), column.offset, std::move(type)});
  }
  return members;
}

/// Numbers that lie in memory one after the other.
template <class T>
void addNumbers(std::vector<Member>& members, std::size_t offset, std::initializer_list<const char*> names,
                Place place) {
  for (const char* name : names) {
    members.push_back({name, offset, copyOf<T>(place)});
    offset += sizeof(T);
  }
}

}  // namespace

Handle tickType(Place place) {
  return compound(sizeof(TickRecord), membersOf(tickColumns(), place), place);
}

Handle jointType(Place place) {
  std::vector<Member> members;
  members.push_back({"t_s", offsetof(JointRow, time_s), numberType(place)});
  addNumbers<double>(members, offsetof(JointRow, joint),
                     {"angle_rad", "speed_rad_s", "soil_torque_nm", "motor_torque_nm"}, place);
  return compound(sizeof(JointRow), members, place);
}

Handle frameType(Place place) {
  std::vector<Member> members;
  members.push_back({"t_s", offsetof(FrameRow, time_s), numberType(place)});
  members.push_back({"tick", offsetof(FrameRow, tick), countType(place)});
  members.push_back({"first", offsetof(FrameRow, first), countType(place)});
  members.push_back({"count", offsetof(FrameRow, count), countType(place)});
  return compound(sizeof(FrameRow), members, place);
}

Handle eventType(Place place) {
  std::vector<Member> members;
  members.push_back({"t_s", offsetof(EventRow, time_s), numberType(place)});
  members.push_back({"tick", offsetof(EventRow, tick), countType(place)});
  members.push_back({"kind", offsetof(EventRow, kind), textType(RecordingEvent::kMostKind)});
  members.push_back({"text", offsetof(EventRow, text), textType(RecordingEvent::kMostText)});
  return compound(sizeof(EventRow), members, place);
}

Handle robotType(Place place) {
  return compound(sizeof(RobotRow), membersOf(robotColumns(), place), place);
}

Handle siteType(Place place) {
  std::vector<Member> members;
  members.push_back({"heard_s", offsetof(SiteRow, heard_s), numberType(place)});
  members.push_back({"command", offsetof(SiteRow, command), countType(place)});
  addNumbers<double>(members, offsetof(SiteRow, corner_m), {"corner_x_m", "corner_y_m"}, place);
  members.push_back({"cell_m", offsetof(SiteRow, cell_m), numberType(place)});
  addNumbers<std::uint32_t>(members, offsetof(SiteRow, map), {"map_columns", "map_rows"}, place);
  addNumbers<std::uint32_t>(members, offsetof(SiteRow, first), {"column", "row"}, place);
  addNumbers<std::uint32_t>(members, offsetof(SiteRow, count), {"columns", "rows"}, place);
  constexpr hsize_t kCells = SiteRow::kCells;
  Handle heights = handle(H5Tarray_create2(scalar<float>(place), 1, &kCells), "make a type");
  members.push_back({"height_m", offsetof(SiteRow, height_m), std::move(heights)});
  return compound(sizeof(SiteRow), members, place);
}

Handle coordinateType(Place place) {
  return copyOf<float>(place);
}

Handle textType(std::size_t bytes) {
  Handle type = handle(H5Tcopy(H5T_C_S1), "make a type");
  done(H5Tset_size(type.id(), bytes), "make a type");
  done(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "make a type");
  done(H5Tset_cset(type.id(), H5T_CSET_UTF8), "make a type");
  return type;
}

Handle countType(Place place) {
  return copyOf<std::uint64_t>(place);
}

Handle numberType(Place place) {
  return copyOf<double>(place);
}

}  // namespace haptolith::hdf5
