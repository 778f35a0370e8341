// CHECK: bugs of ours, never errors of the user. A failed check throws CheckFailed with the values it compared.
#pragma once

#include <fmt/format.h>

#include <stdexcept>

namespace meristem {

class CheckFailed : public std::logic_error {
  using std::logic_error::logic_error;
};

}  // namespace meristem

#define CHECK(condition, ...)                                                                                    \
  do {                                                                                                           \
    if (!(condition)) [[unlikely]]                                                                               \
      throw ::meristem::CheckFailed(                                                                             \
          fmt::format("{}:{}: CHECK({}) failed: {}", __FILE__, __LINE__, #condition, fmt::format(__VA_ARGS__))); \
  } while (false)
