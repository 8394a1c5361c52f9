#include "haptolith/c_api/errors.h"

#include <mutex>
#include <new>
#include <string>

#include "haptolith/bed/kernel/simd_target.h"
#include "haptolith/bed/start/tile_cache.h"

namespace haptolith::library {

std::int32_t wrongArgument(std::int32_t status, const char* name) noexcept {
  return status == HAPTO_OK ? status : failed(status, hapto_status_text(status), name);
}

std::int32_t failedByException() noexcept {
  try {
    throw;
  } catch (const InvalidParameter& error) {
    return failed(HAPTO_INVALID_PARAMETER, error.what(), error.key(), error.value(), error.valid());
  } catch (const Told& told) {
    return told.status;
  } catch (const std::bad_alloc&) {
    return failed(HAPTO_NO_MEMORY, hapto_status_text(HAPTO_NO_MEMORY));
  } catch (const std::exception& error) {
    return failed(HAPTO_FAILURE, error.what());
  } catch (...) {
    return failed(HAPTO_FAILURE, "an unknown exception was thrown");
  }
}

bool Progress::tell(std::string_view what, double share) {
  if (told_ == nullptr) {
    return true;
  }
  const std::string text(what);
  gave_up_ = gave_up_ || told_(user_, text.c_str(), share) == 0;
  return !gave_up_;
}

std::int32_t Progress::status(const std::function<std::int32_t()>& body) noexcept {
  const std::int32_t status = guarded(body);
  return status != HAPTO_OK && gave_up_ ? failed(HAPTO_STOPPED, hapto_status_text(HAPTO_STOPPED)) : status;
}

void readEnvironment() {
  static std::once_flag once;
  std::call_once(once, [] {
    useSimdTargetOfEnvironment();
    useTileCache(tileFolder());
  });
}

}  // namespace haptolith::library
