#include "renderer/session/interruption.h"

#include <time.h>
#include <unistd.h>

namespace meristem {

namespace {

constexpr double at_once_within_s = 2;

std::atomic<bool> stop_requested{false};
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

}  // namespace

Interruption::Interruption() {
  stop_requested = false;
  first_signal = 0;
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;  // files being written do not see it
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, &old_interrupt_);
  ::sigaction(SIGTERM, &action, &old_terminate_);
}

Interruption::~Interruption() {
  ::sigaction(SIGINT, &old_interrupt_, nullptr);
  ::sigaction(SIGTERM, &old_terminate_, nullptr);
}

const std::atomic<bool>& Interruption::requested() const { return stop_requested; }

int Interruption::signal() const { return first_signal; }

}  // namespace meristem
