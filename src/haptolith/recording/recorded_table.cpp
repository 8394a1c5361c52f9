#include "haptolith/recording/recorded_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/platform/files.h"
#include "haptolith/recording/recording_types.h"

namespace haptolith::hdf5 {

namespace {

constexpr std::size_t kLargestChunk = std::size_t{64} << 20;  // bytes; the writer's are below one MiB

/// Differences in a compound; empty without any.
std::string difference(hid_t found, hid_t wanted) {
  if (H5Tget_class(wanted) != H5T_COMPOUND) {
    return "its values are of another type";
  }
  if (H5Tget_class(found) != H5T_COMPOUND) {
    return "it is not a table";
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
  return "its columns differ, or have another order";
}

}  // namespace

RawFile::RawFile(const std::filesystem::path& path) : file_(openForReading(path)) {
  const std::optional<std::uint64_t> size = file_.number() < 0 ? std::nullopt : sizeOf(file_.number());
  if (!size) {
    throw Failure(std::strerror(errno));
  }
  if (!std::filesystem::is_regular_file(path)) {
    throw Failure("it is not a regular file");
  }
  size_ = *size;
}

void RawFile::requireOurFormat() {
  constexpr std::size_t kVersionAt = 8, kAddressBytesAt = 9, kFlagsAt = 11, kBaseAt = 12, kExtensionAt = 20,
                        kRootAt = 36;
  std::array<char, 48> block{};
  if (readAt(file_.number(), 0, std::as_writable_bytes(std::span(block))) != std::ssize(block) ||
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
    throw Failure("it is an HDF5 file, but not a recording of haptolith");
  }
  finished_ = block[kFlagsAt] == 0;  // else it is still open for writing, or was when the writer was killed
  requireObject(address(kRootAt), "/");
}

void RawFile::requireObject(std::uint64_t address, const std::string& name) const {
  constexpr char kVersion = 2;
  std::array<char, 5> begin{};
  if (address >= size_ ||
      readAt(file_.number(), address, std::as_writable_bytes(std::span(begin))) != std::ssize(begin) ||
      std::memcmp(begin.data(), "OHDR", 4) != 0 || begin[4] != kVersion) {
    throw Failure(fmt::format("{} is damaged", name));
  }
}

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

RecordedTable::RecordedTable(const RawFile& raw, const Handle& file, const char* path, RowType row)
    : path_(path), memory_type_(std::move(row.in_memory)), columns_(row.columns), file_size_(raw.size()) {
  requireMember(raw, file, path);
  dataset_ = handle(H5Dopen2(file.id(), path, H5P_DEFAULT), "open it");
  const Handle type = handle(H5Dget_type(dataset_.id()), "read its type");
  if (H5Tequal(type.id(), row.in_file.id()) <= 0) {
    throw Failure(fmt::format("{} does not match format version {}: {}", path, kSchemaVersion,
                              difference(type.id(), row.in_file.id())));
  }
  readExtent();
  readLayout(H5Tget_size(type.id()));
  requireChunks();
}

std::uint64_t RecordedTable::available(std::uint64_t first, std::uint64_t count) const noexcept {
  return std::min(count, rows_ - std::min(rows_, first));
}

void RecordedTable::read(std::uint64_t first, std::uint64_t count, void* to) const {
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

void RecordedTable::readExtent() {
  const Handle space = handle(H5Dget_space(dataset_.id()), "read its size");
  std::array<hsize_t, 2> extent{};
  if (H5Sget_simple_extent_type(space.id()) != H5S_SIMPLE || H5Sget_simple_extent_ndims(space.id()) != rank() ||
      H5Sget_simple_extent_dims(space.id(), extent.data(), nullptr) < 0 || (columns_ != 0 && extent[1] != columns_)) {
    throw Failure(fmt::format("{} has a shape that recordings do not have", path_));
  }
  rows_ = extent[0];
}

void RecordedTable::readLayout(std::size_t value_bytes) {
  const Handle creation = handle(H5Dget_create_plist(dataset_.id()), "read its layout");
  std::array<hsize_t, 2> chunk{};
  if (H5Pget_layout(creation.id()) != H5D_CHUNKED || H5Pget_chunk(creation.id(), rank(), chunk.data()) != rank() ||
      chunk[0] == 0 || (columns_ != 0 && chunk[1] != columns_) || chunk[0] > kLargestChunk / value_bytes) {
    throw Failure(fmt::format("{} has a storage layout that recordings do not have", path_));
  }
  rows_per_chunk_ = chunk[0];
  row_bytes_ = value_bytes * std::max<std::uint64_t>(1, columns_);
  const int filters = H5Pget_nfilters(creation.id());
  for (int filter = 0; filter < filters; ++filter) {
    unsigned flags = 0, configuration = 0;
    std::size_t values = 0;
    const H5Z_filter_t found = H5Pget_filter2(creation.id(), static_cast<unsigned>(filter), &flags, &values, nullptr, 0,
                                              nullptr, &configuration);
    if (found != H5Z_FILTER_SHUFFLE && found != H5Z_FILTER_DEFLATE) {
      throw Failure(fmt::format("{} is compressed with filter {}, which recordings do not use", path_, found));
    }
  }
  compressed_ = filters > 0;
}

void RecordedTable::requireChunks() const {
  hsize_t chunks = 0;
  const Handle space = handle(H5Dget_space(dataset_.id()), "read its size");
  if (H5Dget_num_chunks(dataset_.id(), space.id(), &chunks) < 0 || chunks > file_size_ ||
      rows_ > chunks * rows_per_chunk_ || (!compressed_ && rows_ > file_size_ / row_bytes_)) {
    throw Failure(fmt::format("{} is damaged: some of its {} rows are missing", path_, rows_));
  }
}

void RecordedTable::requireChunkSizes(std::uint64_t first, std::uint64_t count) const {
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

}  // namespace haptolith::hdf5
