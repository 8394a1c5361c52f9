#include "haptolith/recording/recording_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

#include "haptolith/core/error.h"
#include "haptolith/core/files/atomic_file.h"
#include "haptolith/core/platform/files.h"
#include "haptolith/core/pluralise.h"

namespace haptolith::hdf5 {

namespace fs = std::filesystem;

namespace {

// A chunk of ticks is full before the oldest tick in it has to be in the file, so that chunks are written once.
constexpr double kChunk_s = 0.15;
constexpr std::uint64_t kFewestTicks = 16, kMostTicks = 4096;  // per chunk

// These are not compressed, and may be written again in their place.
constexpr std::uint64_t kPositionsPerChunk = 8192, kFramesPerChunk = 64, kEventsPerChunk = 16;
constexpr std::uint64_t kReportsPerChunk = 64, kSiteRowsPerChunk = 16;

// Memory limits of HDF5; the largest chunk is smaller than the first.
constexpr std::size_t kChunkBytes = std::size_t{2} << 20;
constexpr std::size_t kMetadataBytes = std::size_t{32} << 10;

std::uint64_t ticksPerChunk(double tick_s) {
  return std::clamp(static_cast<std::uint64_t>(std::min(kChunk_s / tick_s, 1e6)), kFewestTicks, kMostTicks);
}

void validate(const RecordingHeader& header) {
  requireInRange("tick_s", header.tick_s, {.lowest = 0, .ends = Ends::kOpenBelow});
  for (const HeaderEntry& entry : kHeaderEntries) {
    if (const auto* text = std::get_if<HeaderEntry::Member<std::string>>(&entry.member)) {
      const std::string& value = header.*(*text);
      if (value.size() > kLongestHeaderText || value.find('\0') != std::string::npos) {
        throw InvalidParameter(entry.name, fmt::format("a text of {} bytes", value.size()),
                               fmt::format("at most {} bytes, none of them zero", kLongestHeaderText));
      }
    }
  }
}

void writeAttribute(const Handle& file, const char* name, const Handle& type, const void* value) {
  const Handle space = handle(H5Screate(H5S_SCALAR), "make a space");
  const Handle attribute =
      handle(H5Acreate2(file.id(), name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), "write the header");
  done(H5Awrite(attribute.id(), type.id(), value), "write the header");
}

void writeEntry(const Handle& file, const char* name, const std::string& value) {
  writeAttribute(file, name, textType(std::max<std::size_t>(1, value.size())), value.c_str());
}

void writeEntry(const Handle& file, const char* name, std::uint64_t value) {
  writeAttribute(file, name, countType(Place::kFile), &value);
}

void writeEntry(const Handle& file, const char* name, double value) {
  writeAttribute(file, name, numberType(Place::kFile), &value);
}

void writeHeader(const Handle& file, const RecordingHeader& header) {
  writeEntry(file, "schema", kSchema);
  writeEntry(file, "schema_version", kSchemaVersion);
  for (const HeaderEntry& entry : kHeaderEntries) {
    std::visit([&](auto member) { writeEntry(file, entry.name, header.*member); }, entry.member);
  }
}

/// HDF5 would keep more and more in memory for as long as the file grows: 521 chunks of each dataset, of which only the
/// last is written to, and up to 32 MiB of what it knows about where they are. For the whole file: what is chosen for a
/// dataset is forgotten when SWMR begins.
void boundMemory(const Handle& access) {
  done(H5Pset_cache(access.id(), 0, 1, kChunkBytes, 1), "bound its memory");
  H5AC_cache_config_t metadata{};
  metadata.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  done(H5Pget_mdc_config(access.id(), &metadata), "bound its memory");
  metadata.set_initial_size = true;
  metadata.initial_size = metadata.min_size = metadata.max_size = kMetadataBytes;
  metadata.incr_mode = H5C_incr__off;
  metadata.flash_incr_mode = H5C_flash_incr__off;
  metadata.decr_mode = H5C_decr__off;
  done(H5Pset_mdc_config(access.id(), &metadata), "bound its memory");
}

Handle createFile(const fs::path& path) {
  const Handle access = handle(H5Pcreate(H5P_FILE_ACCESS), "make a property list");
  done(H5Pset_libver_bounds(access.id(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST), "choose the format");  // for SWMR
  done(H5Pset_file_locking(access.id(), true, true), "choose locking");  // if the file system has locks
  boundMemory(access);
  const Handle creation = handle(H5Pcreate(H5P_FILE_CREATE), "make a property list");
  done(H5Pset_attr_phase_change(creation.id(), 64, 0), "choose the format");  // the header stays in one place
  return handle(H5Fcreate(path.string().c_str(), H5F_ACC_EXCL, creation.id(), access.id()), "create it");
}

/// Copies at most as many bytes as there is room for, no part of a letter.
template <std::size_t kSize>
void copyText(std::string_view from, std::array<char, kSize>& to) {
  std::size_t size = std::min(from.size(), kSize);
  if (size < from.size()) {
    while (size > 0 && (static_cast<unsigned char>(from[size]) & 0xC0U) == 0x80U) {
      --size;  // the byte after the cut continues a character
    }
  }
  std::copy_n(from.begin(), size, to.begin());
}

}  // namespace

Growing::Growing(const Handle& file, const char* path, Layout layout)
    : memory_type_(std::move(layout.memory_type)), columns_(layout.columns) {
  const int rank = columns_ == 0 ? 1 : 2;
  const std::array<hsize_t, 2> none{0, columns_}, endless{H5S_UNLIMITED, columns_}, chunk{layout.chunk_rows, columns_};
  const Handle space = handle(H5Screate_simple(rank, none.data(), endless.data()), "make a space");
  const Handle creation = handle(H5Pcreate(H5P_DATASET_CREATE), "make a property list");
  done(H5Pset_chunk(creation.id(), rank, chunk.data()), "choose chunks");
  if (layout.deflated) {
    done(H5Pset_shuffle(creation.id()), "choose compression");
    done(H5Pset_deflate(creation.id(), 1), "choose compression");
  }
  const Handle links = handle(H5Pcreate(H5P_LINK_CREATE), "make a property list");
  done(H5Pset_create_intermediate_group(links.id(), 1), "make a group");
  dataset_ =
      handle(H5Dcreate2(file.id(), path, layout.file_type.id(), space.id(), links.id(), creation.id(), H5P_DEFAULT),
             "create it");
}

void Growing::append(const void* values, std::uint64_t rows) {
  if (rows == 0) {
    return;
  }
  const int rank = columns_ == 0 ? 1 : 2;
  const std::array<hsize_t, 2> begin{rows_, 0}, count{rows, columns_}, end{rows_ + rows, columns_};
  done(H5Dset_extent(dataset_.id(), end.data()), "write");
  const Handle to = handle(H5Dget_space(dataset_.id()), "write");
  done(H5Sselect_hyperslab(to.id(), H5S_SELECT_SET, begin.data(), nullptr, count.data(), nullptr), "write");
  const Handle from = handle(H5Screate_simple(rank, count.data(), nullptr), "write");
  done(H5Dwrite(dataset_.id(), memory_type_.id(), from.id(), to.id(), H5P_DEFAULT, values), "write");
  rows_ += rows;
}

void Growing::flush() {
  done(H5Dflush(dataset_.id()), "write");
  flushed_rows_ = rows_;
}

void requireFree(const fs::path& path, bool overwrite) {
  std::error_code ignored;  // an inaccessible path cannot be created either, and that reports why
  const fs::file_status there = fs::status(path, ignored);
  if (fs::exists(there) && !overwrite) {
    throw Failure(fmt::format("{} already exists: choose another name, or add --overwrite", path.string()));
  }
  if (fs::exists(there) && !fs::is_regular_file(there)) {
    throw Failure(fmt::format("cannot overwrite {}: not a regular file", path.string()));
  }
}

RecordingFile::RecordingFile(fs::path path, const RecordingHeader& header, bool overwrite, bool robot)
    : path_(std::move(path)), ticks_per_chunk_(0), tick_s_(header.tick_s), whole_run_(header.start_tick == 0) {
  validate(header);
  ticks_per_chunk_ = ticksPerChunk(header.tick_s);
  prepareThread();
  requireFree(path_, overwrite);
  // Under its own name the file is there as soon as a killed program would leave one that opens, and not before.
  const fs::path making = kOpenFilesCanBeRenamed ? temporaryBeside(path_, "part") : path_;
  all_ = {&ticks_, &position_, &frames_, &events_};
  if (robot) {
    all_.insert(all_.end(), {&reports_, &site_});
  }
  try {
    if (std::error_code ignored; making == path_ && overwrite) {
      fs::remove(path_, ignored);
    }
    file_ = createFile(making);
    writeHeader(file_, header);
    writeEntry(file_, kMissingTicks, std::uint64_t{0});
    ticks_ = Growing(file_, kTicks,
                     {.file_type = tickType(Place::kFile),
                      .memory_type = tickType(Place::kMemory),
                      .chunk_rows = ticks_per_chunk_,
                      .deflated = true});
    position_ = Growing(file_, kPosition,
                        {.file_type = coordinateType(Place::kFile),
                         .memory_type = coordinateType(Place::kMemory),
                         .chunk_rows = kPositionsPerChunk,
                         .columns = 3});
    frames_ = Growing(file_, kFrames,
                      {.file_type = frameType(Place::kFile),
                       .memory_type = frameType(Place::kMemory),
                       .chunk_rows = kFramesPerChunk});
    events_ = Growing(file_, kEvents,
                      {.file_type = eventType(Place::kFile),
                       .memory_type = eventType(Place::kMemory),
                       .chunk_rows = kEventsPerChunk});
    if (robot) {
      reports_ = Growing(file_, kReports,
                         {.file_type = robotType(Place::kFile),
                          .memory_type = robotType(Place::kMemory),
                          .chunk_rows = kReportsPerChunk});
      site_ = Growing(file_, kSite,
                      {.file_type = siteType(Place::kFile),
                       .memory_type = siteType(Place::kMemory),
                       .chunk_rows = kSiteRowsPerChunk});
    }
    makeTools(header);
    done(H5Fstart_swmr_write(file_.id()), "start writing");
    std::error_code failed;
    if (making != path_) {
      fs::rename(making, path_, failed);
    }
    if (failed) {
      throw Failure(failed.message());
    }
    rememberOutput(path_);
  } catch (const std::exception& error) {
    const bool created = file_.id() >= 0;
    abandon();
    if (std::error_code ignored; created) {  // else the file of that name is not ours
      fs::remove(making, ignored);
    }
    throw Failure(fmt::format("cannot record to {}: {}", path_.string(), error.what()));
  }
}

void RecordingFile::makeTools(const RecordingHeader& header) {
  const std::vector<RecordedTool> tools = toolsOf(header);
  for (std::size_t i = 0; i < tools.size(); ++i) {
    Tool& tool = tools_.emplace_back();
    const std::string group = fmt::format("{}/{}/", kTools, tools[i].name);
    const auto make = [&](std::optional<Growing>& table, const char* name, Handle in_file, Handle in_memory) {
      table.emplace(file_, (group + name).c_str(),
                    Growing::Layout{.file_type = std::move(in_file),
                                    .memory_type = std::move(in_memory),
                                    .chunk_rows = ticks_per_chunk_,
                                    .deflated = true});
      all_.push_back(&*table);
    };
    if (i > 0) {
      make(tool.ticks, "ticks", tickType(Place::kFile), tickType(Place::kMemory));
    }
    if (tools[i].has_joint) {
      make(tool.joint, "joint", jointType(Place::kFile), jointType(Place::kMemory));
    }
  }
}

void RecordingFile::take(const Batch& batch) {
  for (const TickRecord& tick : batch.ticks) {
    if (tick.tool < tools_.size()) {
      Tool& tool = tools_[tick.tool];
      if (tool.ticks) {
        tool.unwritten_ticks.push_back(tick);
      }
      if (tool.joint) {
        tool.unwritten_joint.push_back({tick.time_s, tick.joint});
      }
    }
    if (tick.tool != 0) {
      continue;
    }
    const std::uint64_t number = tickNumber(tick.time_s, tick_s_);
    const bool begins = last_number_ == 0 && !whole_run_;
    if (!begins && number > last_number_ + 1) {
      noteMissing(number - last_number_ - 1, tick.time_s);
    }
    last_number_ = number;
    last_time_s_ = tick.time_s;
    unwritten_ticks_.push_back(tick);
  }
  for (const ParticleFrame& frame : batch.frames) {
    unwritten_frames_.push_back({.time_s = frame.time_s,
                                 .tick = frame.tick,
                                 .first = position_.rows() + unwritten_positions_.size(),
                                 .count = frame.position_m.size()});
    unwritten_positions_.insert(unwritten_positions_.end(), frame.position_m.begin(), frame.position_m.end());
  }
  for (const RecordingEvent& event : batch.events) {
    EventRow& row = unwritten_events_.emplace_back(EventRow{.time_s = event.time_s, .tick = event.tick});
    copyText(event.kind, row.kind);
    copyText(event.text, row.text);
  }
  unwritten_reports_.insert(unwritten_reports_.end(), batch.reports.begin(), batch.reports.end());
  unwritten_site_.insert(unwritten_site_.end(), batch.site.begin(), batch.site.end());
}

void RecordingFile::noteMissing(std::uint64_t ticks, double time_s) {
  missing_ += ticks;
  EventRow& row =
      unwritten_events_.emplace_back(EventRow{.time_s = time_s, .tick = ticks_.rows() + unwritten_ticks_.size()});
  copyText("missing", row.kind);
  copyText(fmt::format("{} before this time could not be recorded", pluralise(ticks, "tick")), row.text);
}

void RecordingFile::countLost(std::uint64_t lost) {
  if (lost > missing_) {
    const std::uint64_t at_the_end = lost - missing_;
    noteMissing(at_the_end, last_time_s_ + static_cast<double>(at_the_end) * tick_s_);
  }
}

bool RecordingFile::hasUnwritten() const noexcept {
  return !unwritten_ticks_.empty() || !unwritten_frames_.empty() || !unwritten_events_.empty() ||
         !unwritten_reports_.empty() || !unwritten_site_.empty();
}

bool RecordingFile::writeWholeChunks() {
  const std::uint64_t begun = ticks_.rows() % ticks_per_chunk_ + unwritten_ticks_.size();
  if (begun < ticks_per_chunk_) {
    return false;
  }
  write(unwritten_ticks_.size() - begun % ticks_per_chunk_);
  return true;
}

void RecordingFile::write(std::size_t ticks) {
  if (!hasUnwritten()) {
    return;
  }
  if (wasRemoved(descriptor())) {
    throw Failure("the file was removed");
  }
  ticks_.append(unwritten_ticks_.data(), ticks);
  const auto append_some = [ticks](std::optional<Growing>& table, auto& rows) {
    if (table) {
      const std::size_t count = std::min(ticks, rows.size());
      table->append(rows.data(), count);
      rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(count));
    }
  };
  for (Tool& tool : tools_) {
    append_some(tool.ticks, tool.unwritten_ticks);
    append_some(tool.joint, tool.unwritten_joint);
  }
  position_.append(unwritten_positions_.data(), unwritten_positions_.size());
  frames_.append(unwritten_frames_.data(), unwritten_frames_.size());
  events_.append(unwritten_events_.data(), unwritten_events_.size());
  reports_.append(unwritten_reports_.data(), unwritten_reports_.size());
  site_.append(unwritten_site_.data(), unwritten_site_.size());
  for (Growing* each : all_) {
    each->flush();
  }
  unwritten_ticks_.erase(unwritten_ticks_.begin(), unwritten_ticks_.begin() + static_cast<std::ptrdiff_t>(ticks));
  unwritten_positions_.clear();
  unwritten_frames_.clear();
  unwritten_events_.clear();
  unwritten_reports_.clear();
  unwritten_site_.clear();
}

void RecordingFile::close() {
  if (missing_ > 0) {
    const Handle entry = handle(H5Aopen(file_.id(), kMissingTicks, H5P_DEFAULT), "write the header");
    done(H5Awrite(entry.id(), countType(Place::kMemory).id(), &missing_), "write the header");
  }
  for (Growing* each : all_) {
    each->close();
  }
  if (!file_.close()) {
    throw Failure(fmt::format("cannot close it: {}", reason()));
  }
}

void RecordingFile::abandon() noexcept {
  // HDF5 would try again to write what it could not, and part of that might succeed: from now on it writes to nowhere.
  if (file_.id() >= 0) {
    discardWrites(descriptor());
  }
  for (Growing* each : all_) {
    each->close();
  }
  file_.close();
}

std::uint64_t RecordingFile::bytes() const {
  return sizeOf(descriptor()).value_or(0);
}

int RecordingFile::descriptor() const {
  void* number = nullptr;
  return H5Fget_vfd_handle(file_.id(), H5P_DEFAULT, &number) >= 0 ? *static_cast<int*>(number) : -1;
}

}  // namespace haptolith::hdf5
