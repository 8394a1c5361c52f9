#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "haptolith/core/platform/descriptor.h"
#include "haptolith/recording/hdf5_handle.h"

namespace haptolith::hdf5 {

/// The bytes of a file, for what has to be known before HDF5 touches it. HDF5's old formats have no checksums, and a
/// damaged file can crash its reader; ours are of the newest format, in which every piece of structure has one.
class RawFile {
 public:
  explicit RawFile(const std::filesystem::path& path);

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

  /// Whether its writer has closed it.
  [[nodiscard]] bool finished() const noexcept { return finished_; }

  /// The superblock, version 3: signature, version, sizes of addresses, flags, four addresses, checksum.
  void requireOurFormat();

  /// @throws Failure when there is no object of the newest format at this address.
  void requireObject(std::uint64_t address, const std::string& name) const;

 private:
  Descriptor file_;
  std::uint64_t size_ = 0;
  bool finished_ = false;
};

/// Checks that a member of a group is in this file. @throws Failure otherwise.
void requireMember(const RawFile& raw, const Handle& file, const std::string& path);

/// Required type of a dataset's row in the file, and in memory.
struct RowType {
  Handle in_file, in_memory;
  std::uint64_t columns = 0;  ///< 0: rows are not arrays
};

/// A dataset whose form has been checked.
class RecordedTable {
 public:
  RecordedTable(const RawFile& raw, const Handle& file, const char* path, RowType row);

  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }

  /// As many of `count` rows as there are.
  [[nodiscard]] std::uint64_t available(std::uint64_t first, std::uint64_t count) const noexcept;

  /// `count` of the available rows.
  void read(std::uint64_t first, std::uint64_t count, void* to) const;

 private:
  [[nodiscard]] int rank() const noexcept { return columns_ == 0 ? 1 : 2; }
  void readExtent();
  void readLayout(std::size_t value_bytes);
  /// A file can claim any number of rows; those that it has lie in chunks.
  void requireChunks() const;
  void requireChunkSizes(std::uint64_t first, std::uint64_t count) const;

  std::string path_;
  Handle dataset_, memory_type_;
  std::uint64_t columns_, file_size_, rows_ = 0, rows_per_chunk_ = 1, row_bytes_ = 1;
  bool compressed_ = false;
};

}  // namespace haptolith::hdf5
