#include "haptolith/recording/recording_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/recording/recorded_table.h"
#include "haptolith/recording/recording_types.h"

namespace haptolith {

using namespace hdf5;

namespace {

/// Opens an attribute that holds one value.
Handle openEntry(const Handle& file, const char* name) {
  if (H5Aexists(file.id(), name) <= 0) {
    throw Failure(fmt::format("its header has no {}", name));
  }
  Handle attribute = handle(H5Aopen(file.id(), name, H5P_DEFAULT), "read its header");
  const Handle space = handle(H5Aget_space(attribute.id()), "read its header");
  if (H5Sget_simple_extent_type(space.id()) != H5S_SCALAR) {
    throw Failure(fmt::format("{} in its header is not one value", name));
  }
  return attribute;
}

void readNumber(const Handle& file, const char* name, const Handle& type, void* value) {
  const Handle attribute = openEntry(file, name);
  const Handle found = handle(H5Aget_type(attribute.id()), "read its header");
  if (H5Tequal(found.id(), type.id()) <= 0) {
    throw Failure(fmt::format("{} in its header is of another type", name));
  }
  done(H5Aread(attribute.id(), type.id(), value), "read its header");
}

void readEntry(const Handle& file, const char* name, std::uint64_t& value) {
  readNumber(file, name, countType(Place::kFile), &value);
}

void readEntry(const Handle& file, const char* name, double& value) {
  readNumber(file, name, numberType(Place::kFile), &value);
}

void readEntry(const Handle& file, const char* name, std::string& value) {
  const Handle attribute = openEntry(file, name);
  const Handle type = handle(H5Aget_type(attribute.id()), "read its header");
  const std::size_t bytes = H5Tget_size(type.id());
  if (H5Tis_variable_str(type.id()) > 0) {
    throw Failure(
        fmt::format("{0} in its header is text of variable length, as h5py writes a str; text of fixed length "
                    "is read: attrs[\"{0}\"] = numpy.bytes_(TEXT)",
                    name));
  }
  if (H5Tget_class(type.id()) != H5T_STRING || bytes > kLongestHeaderText) {
    throw Failure(fmt::format("{} in its header is not a text of at most {} bytes", name, kLongestHeaderText));
  }
  value.resize(bytes);
  done(H5Aread(attribute.id(), type.id(), value.data()), "read its header");
  value.resize(std::min(value.find('\0'), bytes));
}

RecordingHeader readHeader(const Handle& file) {
  std::string schema;
  if (H5Aexists(file.id(), "schema") > 0) {
    readEntry(file, "schema", schema);
  }
  if (schema != kSchema) {
    throw Failure("it is an HDF5 file, but not a recording of haptolith");
  }
  std::uint64_t version = 0;
  readEntry(file, "schema_version", version);
  if (version != kSchemaVersion) {
    throw Failure(
        fmt::format("it is a recording of version {}; this program reads version {}", version, kSchemaVersion));
  }
  RecordingHeader header;
  for (const HeaderEntry& entry : kHeaderEntries) {
    if (!entry.is_new || H5Aexists(file.id(), entry.name) > 0) {
      std::visit([&](auto member) { readEntry(file, entry.name, header.*member); }, entry.member);
    }
  }
  if (!(header.tick_s > 0) || !std::isfinite(header.tick_s)) {
    throw Failure(fmt::format("tick_s = {} in its header is not > 0", header.tick_s));
  }
  return header;
}

/// A file that was not closed opens only for those who say that they know.
Handle openFile(const std::filesystem::path& path) {
  const Handle access = handle(H5Pcreate(H5P_FILE_ACCESS), "make a property list");
  done(H5Pset_file_locking(access.id(), true, true), "choose locking");  // if the file system has locks
  // Data that does not match its checksum is read again, because the writer may be writing it, but not a hundred times
  // with pauses that double each time, which for a damaged file would never end.
  done(H5Pset_metadata_read_attempts(access.id(), 10), "choose how often to read");
  const hid_t finished = H5Fopen(path.string().c_str(), H5F_ACC_RDONLY, access.id());
  if (finished >= 0) {
    return Handle(finished);
  }
  const std::string why = reason();
  const hid_t unfinished = H5Fopen(path.string().c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access.id());
  if (unfinished < 0) {
    throw Failure(why);
  }
  return Handle(unfinished);
}

template <std::size_t kSize>
std::string textOf(const std::array<char, kSize>& text) {
  return {text.begin(), std::find(text.begin(), text.end(), '\0')};
}

}  // namespace

class RecordingReader::File {
 public:
  explicit File(const std::filesystem::path& path)
      : path_(path.string()), raw_(checked(path)), hdf5_(openFile(path)), header_(readHeader(hdf5_)) {
    if (H5Aexists(hdf5_.id(), kMissingTicks) > 0) {
      readEntry(hdf5_, kMissingTicks, missing_ticks_);
    }
    requireMember(raw_, hdf5_, "/particles");
    ticks_ = table(kTicks, tickType(Place::kFile), tickType(Place::kMemory));
    position_ = table(kPosition, coordinateType(Place::kFile), coordinateType(Place::kMemory), 3);
    frames_ = table(kFrames, frameType(Place::kFile), frameType(Place::kMemory));
    events_ = table(kEvents, eventType(Place::kFile), eventType(Place::kMemory));
    recorded_tools_ = toolsOf(header_);
    if (!header_.tools.empty()) {
      requireMember(raw_, hdf5_, kTools);
    }
    for (std::size_t i = 0; i < recorded_tools_.size(); ++i) {
      Tool& tool = tools_.emplace_back();
      const std::string group = fmt::format("{}/{}", kTools, recorded_tools_[i].name);
      if (i > 0 || recorded_tools_[i].has_joint) {
        requireMember(raw_, hdf5_, group);
      }
      if (i > 0) {
        tool.ticks = table((group + "/ticks").c_str(), tickType(Place::kFile), tickType(Place::kMemory));
      }
      if (recorded_tools_[i].has_joint) {
        tool.joint = table((group + "/joint").c_str(), jointType(Place::kFile), jointType(Place::kMemory));
      }
    }
    if (H5Lexists(hdf5_.id(), kRobot, H5P_DEFAULT) > 0) {
      requireMember(raw_, hdf5_, kRobot);
      reports_ = table(kReports, robotType(Place::kFile), robotType(Place::kMemory));
      site_ = table(kSite, siteType(Place::kFile), siteType(Place::kMemory));
    }
  }

  [[nodiscard]] const RecordingHeader& header() const noexcept { return header_; }
  [[nodiscard]] bool finished() const noexcept { return raw_.finished(); }
  [[nodiscard]] std::uint64_t missingTicks() const noexcept { return missing_ticks_; }
  [[nodiscard]] const std::vector<RecordedTool>& tools() const noexcept { return recorded_tools_; }
  [[nodiscard]] const RecordedTable& ticks(std::size_t tool = 0) const {
    return tool == 0 ? *ticks_ : *tools_.at(tool).ticks;
  }
  /// Null: it has none.
  [[nodiscard]] const RecordedTable* joint(std::size_t tool) const { return tools_.at(tool).joint.get(); }
  [[nodiscard]] const RecordedTable& position() const noexcept { return *position_; }
  [[nodiscard]] const RecordedTable& frames() const noexcept { return *frames_; }
  [[nodiscard]] const RecordedTable& events() const noexcept { return *events_; }
  [[nodiscard]] const RecordedTable* reports() const noexcept { return reports_.get(); }  ///< null: no robot followed
  [[nodiscard]] const RecordedTable* site() const noexcept { return site_.get(); }

  template <class Row>
  [[nodiscard]] std::vector<Row> read(const RecordedTable& table, std::uint64_t first, std::uint64_t count) const {
    prepareThread();
    try {
      std::vector<Row> rows(table.available(first, count));
      table.read(first, rows.size(), rows.data());
      return rows;
    } catch (const Failure& failure) {
      refuse(failure.what());
    }
  }

  [[noreturn]] void refuse(std::string_view why) const { throw Failure(fmt::format("cannot read {}: {}", path_, why)); }

 private:
  static RawFile checked(const std::filesystem::path& path) {
    RawFile raw(path);
    raw.requireOurFormat();
    return raw;
  }

  [[nodiscard]] std::unique_ptr<RecordedTable> table(const char* path, Handle in_file, Handle in_memory,
                                                     std::uint64_t columns = 0) const {
    return std::make_unique<RecordedTable>(
        raw_, hdf5_, path,
        RowType{.in_file = std::move(in_file), .in_memory = std::move(in_memory), .columns = columns});
  }

  std::string path_;
  RawFile raw_;
  Handle hdf5_;
  RecordingHeader header_;
  std::uint64_t missing_ticks_ = 0;
  struct Tool {
    std::unique_ptr<RecordedTable> ticks, joint;  ///< none of the first tool, or without a joint
  };
  std::vector<RecordedTool> recorded_tools_;
  std::vector<Tool> tools_;
  std::unique_ptr<RecordedTable> ticks_, position_, frames_, events_, reports_, site_;
};

RecordingReader::RecordingReader(const std::filesystem::path& path) {
  prepareThread();
  try {
    file_ = std::make_unique<File>(path);
  } catch (const Failure& failure) {
    throw Failure(fmt::format("cannot read {}: {}", path.string(), failure.what()));
  }
}

RecordingReader::~RecordingReader() = default;
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;
RecordingReader& RecordingReader::operator=(RecordingReader&&) noexcept = default;

const RecordingHeader& RecordingReader::header() const noexcept {
  return file_->header();
}

bool RecordingReader::finished() const noexcept {
  return file_->finished();
}

std::uint64_t RecordingReader::missingTicks() const noexcept {
  return file_->missingTicks();
}

std::uint64_t RecordingReader::ticks() const noexcept {
  return file_->ticks().rows();
}

std::uint64_t RecordingReader::frames() const noexcept {
  return file_->frames().rows();
}

std::uint64_t RecordingReader::events() const noexcept {
  return file_->events().rows();
}

std::uint64_t RecordingReader::reports() const noexcept {
  return file_->reports() == nullptr ? 0 : file_->reports()->rows();
}

std::uint64_t RecordingReader::siteRows() const noexcept {
  return file_->site() == nullptr ? 0 : file_->site()->rows();
}

const std::vector<RecordedTool>& RecordingReader::tools() const noexcept {
  return file_->tools();
}

std::vector<TickRecord> RecordingReader::readTicks(std::uint64_t first, std::uint64_t count, std::size_t tool) const {
  std::vector<TickRecord> ticks = file_->read<TickRecord>(file_->ticks(tool), first, count);
  if (const RecordedTable* joint = file_->joint(tool)) {
    const std::vector<JointRow> rows = file_->read<JointRow>(*joint, first, ticks.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      ticks[i].joint = rows[i].joint;
    }
  }
  for (TickRecord& tick : ticks) {
    tick.tool = static_cast<std::uint8_t>(tool);
    if (tick.device.state > DeviceState::kFinished) {
      file_->refuse(fmt::format("device_state = {} at {} s is not 0 to {}", static_cast<int>(tick.device.state),
                                tick.time_s, static_cast<int>(DeviceState::kFinished)));
    }
  }
  return ticks;
}

std::vector<FrameRow> RecordingReader::readFrameRows(std::uint64_t first, std::uint64_t count) const {
  std::vector<FrameRow> rows = file_->read<FrameRow>(file_->frames(), first, count);
  for (const FrameRow& row : rows) {
    if (file_->position().available(row.first, row.count) != row.count) {
      file_->refuse(fmt::format("the frame of the particles at {} s is in rows {} to {}, of {}", row.time_s, row.first,
                                row.first + row.count, file_->position().rows()));
    }
  }
  return rows;
}

std::vector<RecordingEvent> RecordingReader::readEvents(std::uint64_t first, std::uint64_t count) const {
  std::vector<RecordingEvent> events;
  for (const EventRow& row : file_->read<EventRow>(file_->events(), first, count)) {
    events.push_back({.time_s = row.time_s, .tick = row.tick, .kind = textOf(row.kind), .text = textOf(row.text)});
  }
  return events;
}

std::vector<RobotRow> RecordingReader::readReports(std::uint64_t first, std::uint64_t count) const {
  return reports() == 0 ? std::vector<RobotRow>() : file_->read<RobotRow>(*file_->reports(), first, count);
}

std::vector<SiteRow> RecordingReader::readSite(std::uint64_t first, std::uint64_t count) const {
  std::vector<SiteRow> rows;
  if (siteRows() > 0) {
    rows = file_->read<SiteRow>(*file_->site(), first, count);
  }
  for (const SiteRow& row : rows) {
    const auto [columns, lines] = row.count;
    const auto fits = [](std::uint32_t begin, std::uint32_t count_of, std::uint32_t of) {
      return begin <= of && count_of <= of - begin;
    };
    if (std::uint64_t{columns} * lines > SiteRow::kCells || !fits(row.first[0], columns, row.map[0]) ||
        !fits(row.first[1], lines, row.map[1])) {
      file_->refuse(
          fmt::format("a part of the robot's site at {} s has {} by {} cells from column {}, row {} of {} by {}",
                      row.heard_s, columns, lines, row.first[0], row.first[1], row.map[0], row.map[1]));
    }
  }
  return rows;
}

ParticleFrame RecordingReader::readFrame(const FrameRow& row) const {
  ParticleFrame frame{.time_s = row.time_s, .tick = row.tick, .position_m = {}};
  frame.position_m = file_->read<std::array<float, 3>>(file_->position(), row.first, row.count);
  if (frame.position_m.size() != row.count) {
    file_->refuse("a frame of the particles is incomplete");
  }
  return frame;
}

}  // namespace haptolith
