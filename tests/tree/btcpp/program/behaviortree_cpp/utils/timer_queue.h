// Timers that run by the clock of the played tree.
//
// Stands before the header of the same name in BehaviorTree.CPP, whose timers run in threads by the
// wall clock. With this one, Sleep, Timeout and Delay give the same events at the same tick on every
// run. All other sources of the library are compiled as they are.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

namespace BT
{
namespace played
{
using Handler = std::function<void(bool)>;

struct Timer
{
  std::int64_t due_ms;
  std::uint64_t number;
  const void* owner;
  Handler handler;
};

// The present time [ms] and the timers that are under way, in the order in which they are due.
struct Time
{
  std::int64_t now_ms = 0;
  std::uint64_t last_number = 0;
  std::map<std::pair<std::int64_t, std::uint64_t>, Timer> open;

  static Time& instance()
  {
    static Time time;
    return time;
  }

  void advance(std::int64_t step_ms)
  {
    now_ms += step_ms;
    while(!open.empty() && open.begin()->second.due_ms <= now_ms)
    {
      Handler handler = std::move(open.begin()->second.handler);
      open.erase(open.begin());
      handler(false);
    }
  }
};
}  // namespace played

template <typename Clock = std::chrono::steady_clock,
          typename Duration = std::chrono::steady_clock::duration>
class TimerQueue
{
public:
  ~TimerQueue()
  {
    cancelAll();
  }

  std::uint64_t add(std::chrono::milliseconds delay, std::function<void(bool)> handler)
  {
    auto& time = played::Time::instance();
    const std::uint64_t number = ++time.last_number;
    const std::int64_t due_ms = time.now_ms + delay.count();
    time.open[{ due_ms, number }] = { due_ms, number, this, std::move(handler) };
    return number;
  }

  std::size_t cancel(std::uint64_t number)
  {
    return give_up([&](const played::Timer& timer) { return timer.number == number; });
  }

  std::size_t cancelAll()
  {
    return give_up([](const played::Timer&) { return true; });
  }

private:
  template <typename Choice>
  std::size_t give_up(Choice chosen)
  {
    auto& open = played::Time::instance().open;
    std::size_t count = 0;
    for(auto it = open.begin(); it != open.end();)
    {
      if(it->second.owner != this || !chosen(it->second))
      {
        ++it;
        continue;
      }
      played::Handler handler = std::move(it->second.handler);
      it = open.erase(it);
      handler(true);
      ++count;
    }
    return count;
  }
};
}  // namespace BT
