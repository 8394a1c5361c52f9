#include "run/trace_file.h"

#include <fmt/format.h>

namespace haptolith {

TraceFile::TraceFile(const OutputFile& file) : file_(file) {
  file_.write(
      "t_s,x_m,y_m,z_m,qw,qx,qy,qz,soil_fx_n,soil_fy_n,soil_fz_n,soil_tx_nm,soil_ty_nm,soil_tz_nm,"
      "felt_fx_n,felt_fy_n,felt_fz_n,felt_tx_nm,felt_ty_nm,felt_tz_nm,tick_us\n");
}

void TraceFile::write(const TickRecord& record) {
  const auto& [position, turn] = record.scene_T_tool;
  fmt::memory_buffer line;
  const auto add = [&line](double value) { fmt::format_to(fmt::appender(line), "{:.9g},", value); };
  add(record.time_s);
  for (const double value : {position.x(), position.y(), position.z(), turn.w(), turn.x(), turn.y(), turn.z()}) {
    add(value);
  }
  for (const Wrench* wrench : {&record.soil, &record.sent.wrench}) {
    for (const Vec3* vector : {&wrench->force_n, &wrench->torque_nm}) {
      for (const double value : *vector) {
        add(value);
      }
    }
  }
  fmt::format_to(fmt::appender(line), "{:.3f}\n", record.tick_us);
  file_.write({line.data(), line.size()});
}

}  // namespace haptolith
