#include "teleop/teleop_end_options.h"

#include <CLI/App.hpp>

#include "shared/option_checks.h"
#include "shared/packet_key_file.h"

namespace haptolith {

namespace {

constexpr double kEndKbit = 1e3;

}  // namespace

void TeleopEndOptions::addTo(CLI::App& command) {
  command
      .add_option(
          "--key-file", key_file,
          "File with the key of the packets, the same at both ends, 64 hexadecimal digits; or HAPTOLITH_TELEOP_KEY")
      ->option_text("FILE");
  command.add_flag("--insecure", insecure, "Communicate beyond this machine without a key; only on a trusted network");
  command.add_option("--rate-kbit-s", rate_kbit_s, "Rate of the link each way; packets use four fifths of it [1000]")
      ->check(numberIn({16, 1e6}))
      ->option_text("KBIT/S");
}

EndOptions TeleopEndOptions::end() const {
  EndOptions end;
  end.key = keyFrom(key_file, "HAPTOLITH_TELEOP_KEY");
  end.insecure = insecure;
  LinkParameters way;
  way.rate_bit_s = rate_kbit_s.value_or(1000) * kEndKbit;
  way.overhead_bytes += end.key.empty() ? 0 : static_cast<int>(PacketSeal::kBytes);
  end.sending = sendingOver(way, way);
  return end;
}

}  // namespace haptolith
