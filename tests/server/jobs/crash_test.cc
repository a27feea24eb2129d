// Jobs that end the process again and again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "server/jobs/crash_marks.h"
#include "server/jobs/job_manager.h"
#include "tests/support/box_jobs.h"
#include "tests/support/files.h"

namespace fascicle::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(CrashMarksTest, TellTheJobOfTheThreadThatCrashed) {
  testing::TemporaryFolder folder;
  const std::string path = folder / "crashes";
  EXPECT_THAT(TakeCrashes(path), IsEmpty());
  for (const int signal : {SIGSEGV, SIGABRT}) {
    const pid_t child = fork();
    if (child == 0) {
      RecordCrashes(path);
      const JobOnThisThread mark("01JOB");
      raise(signal);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal);
  }
  EXPECT_THAT(TakeCrashes(path), ElementsAre("01JOB", "01JOB"));
  EXPECT_THAT(TakeCrashes(path), IsEmpty());
}

class CrashTest : public ::testing::Test {
 protected:
  // A job as a process leaves it that was killed while it ran it.
  std::string LeaveRunning(std::int64_t step) {
    JobRecord job = BoxJob({});
    job.id = "01A";
    job.state = JobState::kRunning;
    job.step = step;
    JobRecord existing;
    store_->CreateJob(job, &existing);
    return job.id;
  }
  // Starts a server that only takes up jobs, and is killed after it reached `step`.
  JobState StartAndKill(const std::string& id, bool is_cause, std::int64_t step) {
    JobManagerOptions options = Workers(0);
    if (is_cause) options.crashes = {id};
    { JobManager manager(*store_, BoxCodec(), options); }
    JobRecord record = *store_->GetJob(id);
    const JobState state = record.state;
    record.state = JobState::kRunning;
    record.step = step;
    if (!IsFinal(state)) store_->UpdateJob(record);
    return state;
  }

  const std::unique_ptr<Store> store_ = MakeMemoryStore();
};

TEST_F(CrashTest, TheCauseOfTwoCrashesAtOnePlaceIsNotTakenUpAgain) {
  const std::string id = LeaveRunning(40);
  EXPECT_EQ(StartAndKill(id, true, 40), JobState::kQueued);
  EXPECT_EQ(StartAndKill(id, true, 40), JobState::kFailed);
  EXPECT_THAT(store_->GetJob(id)->failure, HasSubstr("CRASHED"));
}

TEST_F(CrashTest, ProgressInBetweenForgives) {
  const std::string id = LeaveRunning(40);
  for (std::int64_t step = 50; step < 100; step += 10) EXPECT_EQ(StartAndKill(id, true, step), JobState::kQueued);
}

TEST_F(CrashTest, KillsAreNotHeldAgainstAJobForLong) {
  const std::string id = LeaveRunning(0);
  for (int i = 0; i < 19; ++i) EXPECT_EQ(StartAndKill(id, false, 0), JobState::kQueued) << i;
  EXPECT_EQ(StartAndKill(id, false, 0), JobState::kFailed);
}

}  // namespace
}  // namespace fascicle::server
