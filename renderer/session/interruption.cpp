#include "renderer/session/interruption.h"

#include <time.h>
#include <unistd.h>

namespace meristem {

namespace {

constexpr double at_once_within_s = 2;

std::atomic<bool> stop_requested{false}, snapshot_requested{false};
std::atomic<int> first_signal{0};
std::atomic<double> last_signal_s{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                  std::atomic<double>::is_always_lock_free,
              "a signal handler may touch lock-free atomics only");

double now_s() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);  // safe in a handler (signal-safety(7))
  return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}

void on_signal(int number) {
  if (first_signal != 0 && number == SIGINT && now_s() - last_signal_s < at_once_within_s) ::_exit(128 + SIGINT);
  if (first_signal == 0) first_signal = number;
  last_signal_s = now_s();
  stop_requested = true;
}

void on_snapshot_signal(int) { snapshot_requested = true; }

auto handler_of(int number) {
  if (number == SIGPIPE) return SIG_IGN;
  return number == SIGINT || number == SIGTERM ? on_signal : on_snapshot_signal;
}

}  // namespace

Interruption::Interruption() {
  stop_requested = snapshot_requested = false;
  first_signal = 0;
  for (std::size_t i = 0; i < handled.size(); ++i) {
    struct sigaction action {};
    action.sa_handler = handler_of(handled[i]);
    action.sa_flags = SA_RESTART;  // files being written do not see it
    ::sigemptyset(&action.sa_mask);
    ::sigaction(handled[i], &action, &old_[i]);
  }
}

Interruption::~Interruption() {
  for (std::size_t i = 0; i < handled.size(); ++i) ::sigaction(handled[i], &old_[i], nullptr);
}

const std::atomic<bool>& Interruption::requested() const { return stop_requested; }

int Interruption::signal() const { return first_signal; }

bool Interruption::take_snapshot_request() const { return snapshot_requested.exchange(false); }

}  // namespace meristem
