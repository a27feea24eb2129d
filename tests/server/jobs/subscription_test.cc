// Listeners are notified of every event after it is stored, and never after their handle is destroyed.
#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <optional>

#include "server/jobs/job_manager.h"
#include "server/jobs/notifier.h"
#include "tests/support/box_jobs.h"

namespace fascicle::server {
namespace {

TEST(SubscriptionTest, AListenerSeesEveryFrameAndTheEnd) {
  const std::unique_ptr<Store> store = MakeMemoryStore();
  JobManager manager(*store, BoxCodec(), Workers(1));
  const std::string before = manager.Submit(BoxJob({}), nullptr).record.id;
  const std::string id = manager.Submit(BoxJob({}), nullptr).record.id;
  std::atomic<std::int64_t> seen = 0;
  std::atomic<bool> has_ended = false, has_geometry = false;
  const JobManager::Subscription subscription = manager.Subscribe(id, [&] {
    // The manager may be called from here.
    const JobView view = *manager.Get(id);
    seen = view.frame_count;
    has_geometry = manager.Frames(id)->GeometrySize().has_value();
    if (IsFinal(view.record.state)) has_ended = true;
  });
  // Only the listener watches the job: it must be notified of the last frame and of the end.
  EXPECT_TRUE(Eventually([&] { return has_ended.load(); }));
  EXPECT_EQ(seen, 21);
  EXPECT_TRUE(has_geometry);
}

TEST(SubscriptionTest, AListenerIsToldOfCancellingAndDeleting) {
  const std::unique_ptr<Store> store = MakeMemoryStore();
  JobManager manager(*store, BoxCodec(), Workers(1));
  const std::string running = manager.Submit(BoxJob(Longest()), nullptr).record.id;
  const std::string id = manager.Submit(BoxJob({}), nullptr).record.id;
  std::atomic<bool> is_cancelled = false, is_deleted = false;
  const JobManager::Subscription subscription = manager.Subscribe(id, [&] {
    const std::optional<JobView> view = manager.Get(id);
    if (!view) {
      is_deleted = true;
    } else if (view->record.state == JobState::kCancelled) {
      is_cancelled = true;
    }
  });
  manager.Cancel(id);
  EXPECT_TRUE(Eventually([&] { return is_cancelled.load(); }));
  manager.Delete(id);
  EXPECT_TRUE(Eventually([&] { return is_deleted.load(); }));
}

TEST(NotifierTest, CallsListenersOfTheIdAlone) {
  Notifier notifier;
  std::atomic<int> a = 0, b = 0;
  const Notifier::Handle first = notifier.Subscribe("a", [&] { ++a; });
  const Notifier::Handle second = notifier.Subscribe("a", [&] { ++a; });
  const Notifier::Handle other = notifier.Subscribe("b", [&] { ++b; });
  notifier.Notify("a");
  notifier.Notify("nobody");
  EXPECT_TRUE(Eventually([&] { return a == 2; }));
  EXPECT_EQ(b, 0);
}

TEST(NotifierTest, NeverCallsAListenerWhoseHandleIsGone) {
  Notifier notifier;
  std::atomic<bool> stop = false;
  std::thread changes([&] {
    while (!stop) notifier.Notify("id");
  });
  int calls_after = 0;
  for (int i = 0; i < 300; ++i) {
    auto is_alive = std::make_unique<std::atomic<bool>>(true);
    Notifier::Handle handle = notifier.Subscribe("id", [&, flag = is_alive.get()] {
      if (!flag->load()) ++calls_after;
    });
    if (i % 3 == 0) std::this_thread::yield();
    handle.reset();
    is_alive->store(false);
    is_alive.reset();  // a late call would touch freed memory
  }
  stop = true;
  changes.join();
  EXPECT_EQ(calls_after, 0);
}

TEST(NotifierTest, DestroyingAHandleWaitsForTheCall) {
  Notifier notifier;
  std::latch is_called(1);
  std::atomic<bool> is_over = false;
  Notifier::Handle handle = notifier.Subscribe("id", [&] {
    is_called.count_down();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    is_over = true;
  });
  notifier.Notify("id");
  is_called.wait();
  handle.reset();
  EXPECT_TRUE(is_over);
}

TEST(NotifierTest, AListenerMayDropItsOwnHandle) {
  Notifier notifier;
  std::atomic<int> calls = 0;
  Notifier::Handle handle;
  std::latch is_set(1);
  handle = notifier.Subscribe("id", [&] {
    is_set.wait();
    handle.reset();
    ++calls;
  });
  is_set.count_down();
  notifier.Notify("id");
  EXPECT_TRUE(Eventually([&] { return calls == 1; }));
  notifier.Notify("id");
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(calls, 1);
}

TEST(NotifierTest, HandlesMayOutliveIt) {
  std::atomic<int> calls = 0;
  Notifier::Handle handle;
  {
    Notifier notifier;
    handle = notifier.Subscribe("id", [&] { ++calls; });
    notifier.Notify("id");
  }
  EXPECT_EQ(calls, 1);  // earlier notifications were delivered
  handle.reset();
}

TEST(NotifierTest, TheOneWhoNotifiesMayHoldLocks) {
  Notifier notifier;
  std::mutex mutex;
  std::atomic<int> calls = 0;
  const Notifier::Handle handle = notifier.Subscribe("id", [&] {
    const std::lock_guard lock(mutex);
    ++calls;
  });
  {
    const std::lock_guard lock(mutex);
    notifier.Notify("id");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(calls, 0);
  }
  EXPECT_TRUE(Eventually([&] { return calls == 1; }));
}

}  // namespace
}  // namespace fascicle::server
