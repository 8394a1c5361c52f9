#include "haptolith/recording/recording_reader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <hdf5.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "haptolith/core/error.h"
#include "haptolith/recording/recording_writer.h"

#include "made_up.h"

// HDF5 1.10 itself loses some memory over damaged files.
extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}

namespace haptolith {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

class RecordingReaderTest : public testing::Test {
 protected:
  RecordingReaderTest() : folder_(fs::path(testing::TempDir()) / fmt::format("haptolith_reader_{}", getpid())) {
    fs::create_directories(folder_);
    RecordingWriter writer(path(), madeUpHeader(), {.robot = true});
    writer.add(RobotRow());
    SiteRow site;
    site.map = {20, 20};
    site.first = {16, 0};
    site.count = {4, 16};
    writer.add(site);
    std::vector<TickRecord> ticks;
    for (std::uint64_t n = 0; n < 400; ++n) {
      ticks.push_back(madeUpTick(n));
    }
    writer.add(ticks);
    writer.add(madeUpFrame(0, 100));
    writer.add(madeUpFrame(1, 200));
    writer.add(RecordingEvent{.time_s = 0.1, .tick = 100, .kind = "scene", .text = "changed"});
  }
  ~RecordingReaderTest() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path path() const { return folder_ / "a.h5"; }

  [[nodiscard]] std::string bytes() const {
    std::ifstream in(path(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  void write(const std::string& bytes) const { std::ofstream(path(), std::ios::binary) << bytes; }

  /// Changes the file with HDF5.
  template <class Change>
  void changed(Change change) const {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    const hid_t file = H5Fopen(path().c_str(), H5F_ACC_RDWR, access);
    ASSERT_GE(file, 0);
    change(file);
    H5Fclose(file);
    H5Pclose(access);
  }

  void expectRefused(const std::string& why) const {
    EXPECT_THAT([this] { readAll(); }, ThrowsMessage<Failure>(AllOf(HasSubstr(path().string()), HasSubstr(why))));
  }

  void readAll() const {
    const RecordingReader reader(path());
    for (std::uint64_t first = 0; first < reader.ticks(); first += 150) {
      (void)reader.readTicks(first, 150);
    }
    for (const FrameRow& row : reader.readFrameRows(0, reader.frames())) {
      (void)reader.readFrame(row);
    }
    (void)reader.readEvents(0, reader.events());
    (void)reader.readReports(0, reader.reports());
    (void)reader.readSite(0, reader.siteRows());
  }

  fs::path folder_;
};

void setNumber(hid_t file, const char* name, std::uint64_t value) {
  const hid_t attribute = H5Aopen(file, name, H5P_DEFAULT);
  EXPECT_GE(H5Awrite(attribute, H5T_NATIVE_UINT64, &value), 0);
  H5Aclose(attribute);
}

/// In place of what has this name, a dataset of `rows` numbers in chunks of `chunk` rows.
void replaceByNumbers(hid_t file, const char* name, hsize_t rows, hsize_t chunk,
                      H5Z_filter_t filter = H5Z_FILTER_NONE) {
  EXPECT_GE(H5Ldelete(file, name, H5P_DEFAULT), 0);
  const hsize_t endless = H5S_UNLIMITED;
  const hid_t space = H5Screate_simple(1, &rows, &endless), creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(creation, 1, &chunk);
  if (filter != H5Z_FILTER_NONE) {
    H5Pset_filter(creation, filter, 0, 0, nullptr);
  }
  const hid_t dataset = H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  EXPECT_GE(dataset, 0);
  H5Dclose(dataset);
  H5Pclose(creation);
  H5Sclose(space);
}

/// Writes one value into a column of the first row.
template <class T>
void setFirst(hid_t file, const char* table, const char* column, hid_t type, T value) {
  const hid_t dataset = H5Dopen2(file, table, H5P_DEFAULT), row = H5Tcreate(H5T_COMPOUND, sizeof(T));
  H5Tinsert(row, column, 0, type);
  const hid_t space = H5Dget_space(dataset);
  const hsize_t first = 0, one = 1;
  H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, nullptr, &one, nullptr);
  const hid_t memory = H5Screate_simple(1, &one, nullptr);
  EXPECT_GE(H5Dwrite(dataset, row, memory, space, H5P_DEFAULT, &value), 0);
  for (const hid_t each : {dataset}) {
    H5Dclose(each);
  }
  H5Tclose(row);
  H5Sclose(space);
  H5Sclose(memory);
}

TEST_F(RecordingReaderTest, AWholeFileIsRead) {
  EXPECT_NO_THROW(readAll());
}

TEST_F(RecordingReaderTest, WhatIsNoRecordingIsRefused) {
  write("");
  expectRefused("not an HDF5 file");
  write("t_s,x_m\n");
  expectRefused("not an HDF5 file");
  fs::remove(path());
  expectRefused("No such file or directory");
  fs::create_directory(path());
  expectRefused("not a regular file");
  fs::remove(path());
  H5Fclose(H5Fcreate(path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  expectRefused("not a recording of haptolith");
}

TEST_F(RecordingReaderTest, AnotherHdf5FileIsRefused) {
  changed([](hid_t file) { H5Adelete(file, "schema"); });
  expectRefused("not a recording of haptolith");
}

TEST_F(RecordingReaderTest, AnotherVersionIsRefused) {
  changed([](hid_t file) { setNumber(file, "schema_version", 2); });
  expectRefused("it is a recording of version 2; this program reads version 1");
}

TEST_F(RecordingReaderTest, AnIncompleteHeaderIsRefused) {
  changed([](hid_t file) { H5Adelete(file, "hashed_parts"); });
  expectRefused("its header has no hashed_parts");
}

TEST_F(RecordingReaderTest, AHeaderOfAnotherTypeIsRefused) {
  changed([](hid_t file) {
    H5Adelete(file, "seed");
    H5Adelete(file, "title");
    const hid_t space = H5Screate(H5S_SCALAR), text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, H5T_VARIABLE);
    H5Aclose(H5Acreate2(file, "title", text, space, H5P_DEFAULT, H5P_DEFAULT));
    H5Aclose(H5Acreate2(file, "seed", H5T_NATIVE_FLOAT, space, H5P_DEFAULT, H5P_DEFAULT));
    H5Tclose(text);
    H5Sclose(space);
  });
  expectRefused("title in its header is text of variable length");
  changed([](hid_t file) {
    H5Adelete(file, "title");
    const hid_t space = H5Screate(H5S_SCALAR);
    H5Aclose(H5Acreate2(file, "title", H5T_C_S1, space, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
  });
  expectRefused("seed in its header is of another type");
}

TEST_F(RecordingReaderTest, AMissingTableIsRefused) {
  changed([](hid_t file) { H5Ldelete(file, "/events", H5P_DEFAULT); });
  expectRefused("it has no /events");
  changed([](hid_t file) { H5Ldelete(file, "/particles", H5P_DEFAULT); });
  expectRefused("it has no /particles");
}

TEST_F(RecordingReaderTest, ALinkOutOfTheFileIsNotFollowed) {
  changed([](hid_t file) {
    H5Ldelete(file, "/events", H5P_DEFAULT);
    H5Lcreate_external("/etc/passwd", "/events", file, "/events", H5P_DEFAULT, H5P_DEFAULT);
  });
  expectRefused("/events is damaged");
}

TEST_F(RecordingReaderTest, ATableOfAnotherTypeIsRefused) {
  changed([](hid_t file) { replaceByNumbers(file, "/ticks", 10, 10); });
  expectRefused("/ticks does not match format version 1: it is not a table");
  changed([](hid_t file) {
    H5Ldelete(file, "/ticks", H5P_DEFAULT);
    H5Lmove(file, "/events", file, "/ticks", H5P_DEFAULT, H5P_DEFAULT);
  });
  expectRefused("/ticks does not match format version 1: it has no column device_x_m");
}

TEST_F(RecordingReaderTest, AnotherShapeIsRefused) {
  changed([](hid_t file) {
    H5Ldelete(file, "/particles/position", H5P_DEFAULT);
    const std::array<hsize_t, 2> shape{4, 2}, endless{H5S_UNLIMITED, 2};
    const hid_t space = H5Screate_simple(2, shape.data(), endless.data()), creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(creation, 2, shape.data());
    H5Dclose(H5Dcreate2(file, "/particles/position", H5T_IEEE_F32LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
    H5Pclose(creation);
    H5Sclose(space);
  });
  expectRefused("/particles/position has a shape that");
}

TEST_F(RecordingReaderTest, RowsThatAreOnlyClaimedAreRefusedBeforeMemoryIsTaken) {
  changed([](hid_t file) {
    const hid_t dataset = H5Dopen2(file, "/ticks", H5P_DEFAULT);
    const hsize_t rows = hsize_t{1} << 50;
    EXPECT_GE(H5Dset_extent(dataset, &rows), 0);
    H5Dclose(dataset);
  });
  expectRefused("some of its 1125899906842624 rows are missing");
}

TEST_F(RecordingReaderTest, ParticlesOutsideTheirTableAreRefused) {
  changed([](hid_t file) { setFirst<std::uint64_t>(file, "/particles/frames", "count", H5T_NATIVE_UINT64, 301); });
  expectRefused("is in rows 0 to 301, of 300");
  changed([](hid_t file) { setFirst<std::uint64_t>(file, "/particles/frames", "count", H5T_NATIVE_UINT64, 100); });
  readAll();
  changed([](hid_t file) { setFirst<std::uint64_t>(file, "/particles/frames", "first", H5T_NATIVE_UINT64, ~0ULL); });
  expectRefused("is in rows");
}

TEST_F(RecordingReaderTest, AnImpossibleStateIsRefused) {
  changed([](hid_t file) { setFirst<std::uint8_t>(file, "/ticks", "device_state", H5T_NATIVE_UINT8, 4); });
  expectRefused("device_state = 4 at 0 s is not 0 to 3");
}

TEST_F(RecordingReaderTest, ATruncatedFileIsRefused) {
  const std::string whole = bytes();
  std::mt19937 random(1);
  for (int n = 0; n < 60; ++n) {
    const std::size_t size = random() % whole.size();
    write(whole.substr(0, size));
    EXPECT_THROW(readAll(), Failure) << size << " of " << whole.size() << " bytes";
  }
}

TEST_F(RecordingReaderTest, DamagedBytesAreNoticedOrHarmless) {
  const std::string whole = bytes();
  std::mt19937 random(1);
  int refused = 0;
  for (int n = 0; n < 300; ++n) {
    std::string damaged = whole;
    for (std::size_t bytes = 1 + random() % 4; bytes > 0; --bytes) {
      // Half of them in what HDF5 keeps at the beginning: structure, not values.
      const std::size_t at = random() % (n % 2 == 0 ? whole.size() : 8192);
      damaged[at] = static_cast<char>(random());
    }
    write(damaged);
    try {
      readAll();
    } catch (const Failure&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace haptolith
