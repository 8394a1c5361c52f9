#pragma once

#include <memory>
#include <vector>

#include "haptolith/device/device_parameters.h"
#include "haptolith/device/haptic_device.h"

namespace haptolith {

/// Haply Inverse3, through the Haply Inverse Service, which reports and renders once for each message that it receives:
/// a separate thread sends one per millisecond, reads all messages, and exchanges the newest state and force with the
/// loop, which waits for nothing. Three degrees of freedom; a wireless VerseGrip that was switched on before adds
/// orientation and buttons. Its frame is the service's: right-handed, z up, origin at the arm's base.
///
/// The state is stale when the service has been silent for 20 ms, or has sent more than can be read (what has waited,
/// or might have, is not fresh), and lost when it ends the connection; the driver does not connect again. Force is zero
/// when the loop has written nothing for 20 ms, and when it is no finite number.
class Inverse3 final : public HapticDevice {
 public:
  /// Opens the device `parameters.id`, or the first, of the service at `parameters.address`: "ws://HOST:PORT" with an
  /// IP address or localhost; empty: ws://localhost:10001.
  /// @throws InvalidParameter for an invalid address; Failure when the service does not answer within 2 s or has
  /// no such device, with what to do.
  explicit Inverse3(const DeviceParameters& parameters);
  ~Inverse3() override;
  Inverse3(const Inverse3&) = delete;
  Inverse3& operator=(const Inverse3&) = delete;

  [[nodiscard]] std::string_view name() const noexcept override { return "Inverse3"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override;
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const DeviceOutput& output) noexcept override;
  /// The next message, at most a millisecond later, is zero. When the service accepts none any more, it releases the
  /// device itself.
  void releaseForce() noexcept override;
  [[nodiscard]] ForceRelease forceRelease() const noexcept override;
  void resumeForce() noexcept override;
  [[nodiscard]] std::string_view problem() const noexcept override;

  /// Answers that were no state of the device; they are left out. May be asked at any time.
  [[nodiscard]] std::uint64_t badAnswers() const noexcept;

 private:
  class Connection;
  DeviceParameters parameters_;
  std::unique_ptr<Connection> connection_;
};

/// Inverse3s that the service reports, or one report of the reason when there is no device. Waits for the service for
/// 0.3 s at most. @throws InvalidParameter for an invalid address.
[[nodiscard]] std::vector<DeviceReport> findInverse3(const DeviceParameters& parameters);

}  // namespace haptolith
