#include "haptolith/recording/recording_reader.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/process/child_process.h"
#include "haptolith/recording/recording_types.h"

namespace haptolith {

using namespace hdf5;

namespace {

constexpr std::size_t kLargestChunk = std::size_t{64} << 20;  // bytes; the writer's are below one MiB

/// The bytes of a file, for what has to be known before HDF5 touches it. HDF5's old formats have no checksums, and a
/// damaged file can crash its reader; ours are of the newest format, in which every piece of structure has one.
class RawFile {
 public:
  explicit RawFile(const std::filesystem::path& path) : file_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat status {};
    if (file_.number() < 0 || fstat(file_.number(), &status) != 0) {
      throw Failure(std::strerror(errno));
    }
    if (!S_ISREG(status.st_mode)) {
      throw Failure("it is not a regular file");
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

  /// Whether its writer has closed it.
  [[nodiscard]] bool finished() const noexcept { return finished_; }

  /// The superblock, version 3: signature, version, sizes of addresses, flags, four addresses, checksum.
  void requireOurFormat() {
    constexpr std::size_t kVersionAt = 8, kAddressBytesAt = 9, kFlagsAt = 11, kBaseAt = 12, kExtensionAt = 20,
                          kRootAt = 36;
    std::array<char, 48> block{};
    if (pread(file_.number(), block.data(), block.size(), 0) != static_cast<ssize_t>(block.size()) ||
        std::memcmp(block.data(), "\211HDF\r\n\032\n", 8) != 0) {
      throw Failure("it is not an HDF5 file");
    }
    const auto address = [&](std::size_t at) {
      std::uint64_t value = 0;
      std::memcpy(&value, &block[at], sizeof(value));
      return value;
    };
    if (block[kVersionAt] != 3 || block[kAddressBytesAt] != 8 || address(kBaseAt) != 0 ||
        address(kExtensionAt) != HADDR_UNDEF) {
      throw Failure("it is an HDF5 file, but not in the form in which haptolith writes recordings");
    }
    finished_ = block[kFlagsAt] == 0;  // else it is still open for writing, or was when the writer was killed
    requireObject(address(kRootAt), "/");
  }

  /// @throws Failure when there is no object of the newest format at this address.
  void requireObject(std::uint64_t address, const std::string& name) const {
    constexpr char kVersion = 2;
    std::array<char, 5> begin{};
    if (address >= size_ || pread(file_.number(), begin.data(), begin.size(), static_cast<off_t>(address)) != 5 ||
        std::memcmp(begin.data(), "OHDR", 4) != 0 || begin[4] != kVersion) {
      throw Failure(fmt::format("{} is damaged", name));
    }
  }

 private:
  Descriptor file_;
  std::uint64_t size_ = 0;
  bool finished_ = false;
};

/// A member of a group that lies in this file. @throws Failure when it does not.
void requireMember(const RawFile& raw, const Handle& file, const std::string& path) {
  H5L_info_t link{};
  if (H5Lexists(file.id(), path.c_str(), H5P_DEFAULT) <= 0) {
    throw Failure(fmt::format("it has no {}", path));
  }
  if (H5Lget_info(file.id(), path.c_str(), &link, H5P_DEFAULT) < 0 || link.type != H5L_TYPE_HARD) {
    throw Failure(fmt::format("{} is damaged", path));
  }
  raw.requireObject(link.u.address, path);
}

/// How a row of a dataset has to look in the file, and in memory.
struct RowType {
  Handle in_file, in_memory;
  std::uint64_t columns = 0;  ///< 0: rows are not arrays
};

/// What is different in a compound; empty when nothing is.
std::string difference(hid_t found, hid_t wanted) {
  if (H5Tget_class(wanted) != H5T_COMPOUND) {
    return "its values are of another type";
  }
  if (H5Tget_class(found) != H5T_COMPOUND) {
    return "it is no table";
  }
  for (int column = 0; column < H5Tget_nmembers(wanted); ++column) {
    char* const name_there = H5Tget_member_name(wanted, static_cast<unsigned>(column));
    const std::string name = name_there;
    H5free_memory(name_there);
    const int at = H5Tget_member_index(found, name.c_str());
    if (at < 0) {
      return fmt::format("it has no column {}", name);
    }
    const Handle type = handle(H5Tget_member_type(found, static_cast<unsigned>(at)), "read a type");
    const Handle wanted_type = handle(H5Tget_member_type(wanted, static_cast<unsigned>(column)), "read a type");
    if (H5Tequal(type.id(), wanted_type.id()) <= 0) {
      return fmt::format("its column {} is of another type", name);
    }
  }
  return "its columns are others, or in another order";
}

/// A dataset whose form has been checked.
class Table {
 public:
  Table(const RawFile& raw, const Handle& file, const char* path, RowType row)
      : path_(path), memory_type_(std::move(row.in_memory)), columns_(row.columns), file_size_(raw.size()) {
    requireMember(raw, file, path);
    dataset_ = handle(H5Dopen2(file.id(), path, H5P_DEFAULT), "open it");
    const Handle type = handle(H5Dget_type(dataset_.id()), "read its type");
    if (H5Tequal(type.id(), row.in_file.id()) <= 0) {
      throw Failure(fmt::format("{} is not as version {} has it: {}", path, kSchemaVersion,
                                difference(type.id(), row.in_file.id())));
    }
    readExtent();
    readLayout(H5Tget_size(type.id()));
    requireChunks();
  }

  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }

  /// As many of `count` rows as there are.
  [[nodiscard]] std::uint64_t available(std::uint64_t first, std::uint64_t count) const noexcept {
    return std::min(count, rows_ - std::min(rows_, first));
  }

  /// `count` of the available rows.
  void read(std::uint64_t first, std::uint64_t count, void* to) const {
    if (count == 0) {
      return;
    }
    requireChunkSizes(first, count);
    const std::array<hsize_t, 2> begin{first, 0}, extent{count, columns_};
    const Handle from = handle(H5Dget_space(dataset_.id()), "read it");
    done(H5Sselect_hyperslab(from.id(), H5S_SELECT_SET, begin.data(), nullptr, extent.data(), nullptr), "read it");
    const Handle memory = handle(H5Screate_simple(rank(), extent.data(), nullptr), "read it");
    if (H5Dread(dataset_.id(), memory_type_.id(), memory.id(), from.id(), H5P_DEFAULT, to) < 0) {
      throw Failure(fmt::format("{} is damaged in rows {} to {}: {}", path_, first, first + count - 1, reason()));
    }
  }

 private:
  [[nodiscard]] int rank() const noexcept { return columns_ == 0 ? 1 : 2; }

  void readExtent() {
    const Handle space = handle(H5Dget_space(dataset_.id()), "read its size");
    std::array<hsize_t, 2> extent{};
    if (H5Sget_simple_extent_type(space.id()) != H5S_SIMPLE || H5Sget_simple_extent_ndims(space.id()) != rank() ||
        H5Sget_simple_extent_dims(space.id(), extent.data(), nullptr) < 0 || (columns_ != 0 && extent[1] != columns_)) {
      throw Failure(fmt::format("{} has another shape than a recording's", path_));
    }
    rows_ = extent[0];
  }

  void readLayout(std::size_t value_bytes) {
    const Handle creation = handle(H5Dget_create_plist(dataset_.id()), "read its layout");
    std::array<hsize_t, 2> chunk{};
    if (H5Pget_layout(creation.id()) != H5D_CHUNKED || H5Pget_chunk(creation.id(), rank(), chunk.data()) != rank() ||
        chunk[0] == 0 || (columns_ != 0 && chunk[1] != columns_) || chunk[0] > kLargestChunk / value_bytes) {
      throw Failure(fmt::format("{} is not stored as a recording's", path_));
    }
    rows_per_chunk_ = chunk[0];
    row_bytes_ = value_bytes * std::max<std::uint64_t>(1, columns_);
    const int filters = H5Pget_nfilters(creation.id());
    for (int filter = 0; filter < filters; ++filter) {
      unsigned flags = 0, configuration = 0;
      std::size_t values = 0;
      const H5Z_filter_t found = H5Pget_filter2(creation.id(), static_cast<unsigned>(filter), &flags, &values, nullptr,
                                                0, nullptr, &configuration);
      if (found != H5Z_FILTER_SHUFFLE && found != H5Z_FILTER_DEFLATE) {
        throw Failure(fmt::format("{} is compressed with filter {}, which recordings do not use", path_, found));
      }
    }
    compressed_ = filters > 0;
  }

  /// A file can claim any number of rows; those that it has lie in chunks.
  void requireChunks() const {
    hsize_t chunks = 0;
    const Handle space = handle(H5Dget_space(dataset_.id()), "read its size");
    if (H5Dget_num_chunks(dataset_.id(), space.id(), &chunks) < 0 || chunks > file_size_ ||
        rows_ > chunks * rows_per_chunk_ || (!compressed_ && rows_ > file_size_ / row_bytes_)) {
      throw Failure(fmt::format("{} is damaged: of its {} rows not all are there", path_, rows_));
    }
  }

  void requireChunkSizes(std::uint64_t first, std::uint64_t count) const {
    for (std::uint64_t row = first - first % rows_per_chunk_; row < first + count; row += rows_per_chunk_) {
      const std::array<hsize_t, 2> at{row, 0};
      unsigned mask = 0;
      haddr_t address = 0;
      hsize_t bytes = 0;
      if (H5Dget_chunk_info_by_coord(dataset_.id(), at.data(), &mask, &address, &bytes) < 0 || address >= file_size_ ||
          bytes > file_size_ - address) {
        throw Failure(fmt::format("{} is damaged near row {}", path_, row));
      }
    }
  }

  std::string path_;
  Handle dataset_, memory_type_;
  std::uint64_t columns_, file_size_, rows_ = 0, rows_per_chunk_ = 1, row_bytes_ = 1;
  bool compressed_ = false;
};

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
    throw Failure(fmt::format("{} in its header is no text of at most {} bytes", name, kLongestHeaderText));
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
        fmt::format("it is a recording of version {}, and this program reads version {}", version, kSchemaVersion));
  }
  RecordingHeader header;
  for (const HeaderEntry& entry : kHeaderEntries) {
    std::visit([&](auto member) { readEntry(file, entry.name, header.*member); }, entry.member);
  }
  if (!(header.tick_s > 0) || !std::isfinite(header.tick_s)) {
    throw Failure(fmt::format("tick_s = {} in its header is not > 0", header.tick_s));
  }
  return header;
}

/// A file that was not closed opens only for those who say that they know.
Handle openFile(const std::filesystem::path& path) {
  const Handle access = handle(H5Pcreate(H5P_FILE_ACCESS), "make a property list");
  done(H5Pset_file_locking(access.id(), true, true), "choose locking");  // where there are locks
  // What does not fit its checksum is read again, for the writer may be at it, but not a hundred times with pauses that
  // double each time, which for a damaged file would never end.
  done(H5Pset_metadata_read_attempts(access.id(), 10), "choose how often to read");
  const hid_t finished = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id());
  if (finished >= 0) {
    return Handle(finished);
  }
  const std::string why = reason();
  const hid_t unfinished = H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access.id());
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
    if (H5Lexists(hdf5_.id(), kRobot, H5P_DEFAULT) > 0) {
      requireMember(raw_, hdf5_, kRobot);
      reports_ = table(kReports, robotType(Place::kFile), robotType(Place::kMemory));
      site_ = table(kSite, siteType(Place::kFile), siteType(Place::kMemory));
    }
  }

  [[nodiscard]] const RecordingHeader& header() const noexcept { return header_; }
  [[nodiscard]] bool finished() const noexcept { return raw_.finished(); }
  [[nodiscard]] std::uint64_t missingTicks() const noexcept { return missing_ticks_; }
  [[nodiscard]] const Table& ticks() const noexcept { return *ticks_; }
  [[nodiscard]] const Table& position() const noexcept { return *position_; }
  [[nodiscard]] const Table& frames() const noexcept { return *frames_; }
  [[nodiscard]] const Table& events() const noexcept { return *events_; }
  [[nodiscard]] const Table* reports() const noexcept { return reports_.get(); }  ///< null: no robot followed
  [[nodiscard]] const Table* site() const noexcept { return site_.get(); }

  template <class Row>
  [[nodiscard]] std::vector<Row> read(const Table& table, std::uint64_t first, std::uint64_t count) const {
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

  [[nodiscard]] std::unique_ptr<Table> table(const char* path, Handle in_file, Handle in_memory,
                                             std::uint64_t columns = 0) const {
    return std::make_unique<Table>(
        raw_, hdf5_, path,
        RowType{.in_file = std::move(in_file), .in_memory = std::move(in_memory), .columns = columns});
  }

  std::string path_;
  RawFile raw_;
  Handle hdf5_;
  RecordingHeader header_;
  std::uint64_t missing_ticks_ = 0;
  std::unique_ptr<Table> ticks_, position_, frames_, events_, reports_, site_;
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

std::vector<TickRecord> RecordingReader::readTicks(std::uint64_t first, std::uint64_t count) const {
  std::vector<TickRecord> ticks = file_->read<TickRecord>(file_->ticks(), first, count);
  for (const TickRecord& tick : ticks) {
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
      file_->refuse(fmt::format("the picture of the particles at {} s is said to be in rows {} to {}, of {}",
                                row.time_s, row.first, row.first + row.count, file_->position().rows()));
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
          fmt::format("a part of the robot's site at {} s is said to be {} by {} cells from column {}, row "
                      "{} of {} by {}",
                      row.heard_s, columns, lines, row.first[0], row.first[1], row.map[0], row.map[1]));
    }
  }
  return rows;
}

ParticleFrame RecordingReader::readFrame(const FrameRow& row) const {
  ParticleFrame frame{.time_s = row.time_s, .tick = row.tick, .position_m = {}};
  frame.position_m = file_->read<std::array<float, 3>>(file_->position(), row.first, row.count);
  if (frame.position_m.size() != row.count) {
    file_->refuse("a picture of the particles is incomplete");
  }
  return frame;
}

}  // namespace haptolith
