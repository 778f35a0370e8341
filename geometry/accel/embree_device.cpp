#include "geometry/accel/embree_device.h"

#include "geometry/base/parallel.h"

#include <fmt/format.h>

#include <stdexcept>

namespace meristem {

namespace {

thread_local std::ptrdiff_t monitored_bytes = 0;

bool monitor_memory(void*, ssize_t bytes, bool) {
  monitored_bytes += bytes;
  return true;
}

}  // namespace

RTCDevice embree_device() {
  static const RTCDevice device = [] {
    RTCDevice d = rtcNewDevice(nullptr);
    if (!d) throw std::runtime_error("Embree could not be started");
    rtcSetDeviceMemoryMonitorFunction(d, monitor_memory, nullptr);
    return d;
  }();
  return device;
}

std::ptrdiff_t take_embree_bytes() { return std::exchange(monitored_bytes, 0); }

std::size_t commit_scene(RTCScene scene) {
  take_embree_bytes();
  rtcCommitScene(scene);
  if (const RTCError error = rtcGetDeviceError(embree_device()); error != RTC_ERROR_NONE)
    throw std::runtime_error(fmt::format("Embree could not build a scene (error {})", int(error)));
  const std::ptrdiff_t bytes = take_embree_bytes();
  return std::size_t(bytes > 0 ? bytes : 0) + hidden_scene_bytes;
}

}  // namespace meristem
