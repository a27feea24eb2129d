#ifndef FASCICLE_TESTS_CORE_SIM_SAME_BITS_H_
#define FASCICLE_TESTS_CORE_SIM_SAME_BITS_H_

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/tet_scenes.h"

namespace fascicle::testing {

// Two threads produce the same frames as one, and a run restored after its third frame produces the same following
// frames.
inline void ExpectAnyThreadsAndRestartsGiveTheSameBits(const Scene& scene, std::size_t frames) {
  const RunResult reference = RunScene(scene, 1);
  ASSERT_EQ(reference.outcome.kind, Outcome::Kind::kSucceeded) << reference.outcome.failure.message;
  ASSERT_EQ(reference.frames.size(), frames);
  const RunResult two = RunScene(scene, 2);
  ASSERT_EQ(two.frames.size(), frames);
  for (std::size_t f = 0; f < frames; ++f) EXPECT_EQ(two.frames[f].digest, reference.frames[f].digest) << f;
  Simulation restarted(std::make_shared<Scene>(scene), 2);
  ASSERT_TRUE(restarted.Restore(reference.checkpoints[2]));
  EXPECT_EQ(restarted.next_frame(), 3);
  CollectingSink sink;
  restarted.Run(sink, {});
  ASSERT_EQ(sink.frames.size(), frames - 3);
  for (std::size_t f = 3; f < frames; ++f) EXPECT_EQ(sink.frames[f - 3].digest, reference.frames[f].digest) << f;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_CORE_SIM_SAME_BITS_H_
